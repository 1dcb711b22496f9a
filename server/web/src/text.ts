// Numbers as text, as the report writes them.

export const NONE = "\u2013";
export const isNumber = (value: unknown): value is number => typeof value === "number" && Number.isFinite(value);

export function significant(value: unknown, digits: number): string {
  if (!isNumber(value)) return NONE;
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e9)) return value.toExponential(digits - 1).replace(/\.?0*e/, "e");
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value) || 1)));
  return value.toLocaleString("en", { maximumFractionDigits: Math.min(decimals, 6) });
}

export const milliseconds = (value: unknown) => (isNumber(value) ? `${significant(value, 3)} ms` : NONE);
export const count = (value: unknown) => (isNumber(value) ? Math.round(value).toLocaleString("en") : NONE);
export const percent = (share: unknown) => (isNumber(share) ? `${significant(100 * share, 3)} %` : NONE);

export function bytes(value: unknown): string {
  if (!isNumber(value)) return NONE;
  const units = ["B", "kB", "MB", "GB"];
  let scaled = value,
    unit = 0;
  while (scaled >= 1000 && unit < units.length - 1) {
    scaled /= 1000;
    ++unit;
  }
  return `${significant(scaled, 3)} ${units[unit]}`;
}

const UNITS = [
  ["day", 86400],
  ["h", 3600],
  ["min", 60],
  ["s", 1],
] as const;

/// In the two largest units that it has: "2 min 20 s".
export function duration(seconds: number): string {
  let rest = Math.round(seconds);
  const parts = UNITS.map(([unit, length]): [string, number] => {
    const whole = Math.floor(rest / length);
    rest -= whole * length;
    return [unit === "day" && whole > 1 ? "days" : unit, whole];
  });
  const first = parts.findIndex(([, whole]) => whole > 0);
  if (first < 0) return "0 s";
  return parts
    .slice(first, first + 2)
    .filter(([, whole]) => whole > 0)
    .map(([unit, whole]) => `${whole} ${unit}`)
    .join(" ");
}

/// "3 min ago" of an ISO time, in the largest unit alone.
export function ago(time: string, now = Date.now()): string {
  const seconds = Math.max(0, (now - Date.parse(time)) / 1000);
  const [, length] = UNITS.find(([, unit]) => seconds >= unit) ?? ["s", 1];
  return `${duration(Math.floor(seconds / length) * length)} ago`;
}

/// Items of a list, the rest counted: "tree_1, tree_2 and 5 more".
export function listed(items: readonly string[], most: number): string {
  if (items.length <= most) return items.join(", ");
  return `${items.slice(0, most).join(", ")} and ${count(items.length - most)} more`;
}
