// Where an image can be read from: its address; with a token, which no image sends, a copy that the page fetches and keeps while the view is
// shown.

import { getBlob, hasToken, type Artifact } from "./api";

async function copyOf(artifact: Artifact, signal: AbortSignal): Promise<string> {
  const blob = await getBlob(artifact.href, signal);
  signal.throwIfAborted(); // nobody would revoke the address
  const url = URL.createObjectURL(blob);
  signal.addEventListener("abort", () => URL.revokeObjectURL(url), { once: true });
  return url;
}

/// `use` hears the address, at once where it can; `fail`, that there is none.
export function withSource(artifact: Artifact, signal: AbortSignal, use: (address: string) => void, fail: () => void): void {
  if (hasToken()) copyOf(artifact, signal).then(use, fail);
  else use(artifact.href);
}
