// A refusal as the service words it (RFC 9457).
export const problem = (status, title, detail, more = {}) => ({ status, body: { type: "about:blank", title, status, detail, ...more } });
