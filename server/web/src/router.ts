// Addresses of the page's views: all behind "#", so that the server needs to know none of them.

export interface Route {
  readonly view: "jobs" | "new" | "job" | "result" | "walk" | "unknown";
  readonly id: string;
  readonly query: URLSearchParams;
}

export function parseRoute(hash: string): Route {
  const [path = "", search = ""] = hash.replace(/^#/, "").split("?", 2);
  const query = new URLSearchParams(search);
  const [first = "", id = "", last = "", ...more] = path
    .split("/")
    .filter((part) => part !== "")
    .map(decodeURIComponent);
  if (more.length > 0) return { view: "unknown", id: "", query };
  if (first === "") return { view: "jobs", id: "", query };
  if (first === "new" && id === "") return { view: "new", id: "", query };
  if (first === "jobs" && id === "") return { view: "jobs", id: "", query };
  if (first === "jobs" && (last === "" || last === "result" || last === "walk")) return { view: last === "" ? "job" : last, id, query };
  return { view: "unknown", id: "", query };
}

export const jobAddress = (id: string, view: "" | "result" | "walk" = "") =>
  `#/jobs/${encodeURIComponent(id)}${view === "" ? "" : `/${view}`}`;

type Triple = readonly [number, number, number];
const shortened = (value: number) => String(Number(value.toPrecision(7)));

export function walkAddress(id: string, position: Triple, direction: Triple): string {
  return `${jobAddress(id, "walk")}?position=${position.map(shortened).join(",")}&direction=${direction.map(shortened).join(",")}`;
}

/// "x,y,z", or null for anything else.
export function parseTriple(text: string | null): [number, number, number] | null {
  const numbers = (text ?? "").split(",").map((part) => (part.trim() === "" ? NaN : Number(part)));
  return numbers.length === 3 && numbers.every(Number.isFinite) ? (numbers as [number, number, number]) : null;
}
