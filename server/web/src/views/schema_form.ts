// Inputs for a job's settings, made from the server's JSON Schema: a group per table, a field per key, its default filled in. What is left as
// it is is not sent.

import { element, folded } from "../elements";

interface Schema {
  readonly type?: string;
  readonly description?: string;
  readonly default?: unknown;
  readonly enum?: readonly string[];
  readonly pattern?: string;
  readonly properties?: Record<string, Schema>;
  readonly items?: Schema;
  readonly minimum?: number;
  readonly maximum?: number;
  readonly exclusiveMinimum?: number;
  readonly exclusiveMaximum?: number;
}

type Input = HTMLInputElement | HTMLSelectElement;
interface Field {
  readonly path: readonly string[];
  readonly schema: Schema;
  readonly input: Input;
  readonly standard: string;
}

const isNumeric = (schema: Schema | undefined) => schema?.type === "number" || schema?.type === "integer";
const asText = (value: unknown) =>
  Array.isArray(value) ? (value.some((item) => typeof item === "object") ? JSON.stringify(value) : value.join(",")) : String(value ?? "");

function rangeText({ minimum, maximum, exclusiveMinimum, exclusiveMaximum }: Schema): string {
  const low = minimum !== undefined ? `at least ${minimum}` : exclusiveMinimum !== undefined ? `more than ${exclusiveMinimum}` : "";
  const high = maximum !== undefined ? `at most ${maximum}` : exclusiveMaximum !== undefined ? `less than ${exclusiveMaximum}` : "";
  return [low, high].filter((part) => part !== "").join(", ");
}

function inputOf(id: string, schema: Schema): Input {
  if (schema.enum !== undefined)
    return element(
      "select",
      { id },
      ...schema.enum.map((value) => element("option", { value, selected: value === schema.default }, value)),
    );
  if (schema.type === "boolean") return element("input", { id, type: "checkbox", checked: schema.default === true });
  if (isNumeric(schema))
    return element("input", {
      id,
      type: "number",
      step: schema.type === "integer" ? 1 : "any",
      min: schema.minimum,
      max: schema.maximum,
      value: asText(schema.default),
    });
  return element("input", { id, type: "text", value: asText(schema.default), pattern: schema.pattern });
}

const textOf = (input: Input) =>
  input instanceof HTMLInputElement && input.type === "checkbox" ? String(input.checked) : input.value.trim();

/// What a field's text means; a list whose text is no list goes as text, and the server says what is wrong with it.
function parsed(schema: Schema, text: string): unknown {
  if (schema.type === "boolean") return text === "true";
  if (isNumeric(schema)) return Number(text);
  if (schema.type !== "array") return text;
  if (text === "") return [];
  if (schema.items?.type === "object") {
    try {
      return JSON.parse(text) as unknown;
    } catch {
      return text;
    }
  }
  const items = text.split(",").map((item) => item.trim());
  return isNumeric(schema.items) ? items.map(Number) : items;
}

export class SchemaForm {
  private readonly fields: Field[] = [];
  readonly element: HTMLElement;

  constructor(
    schema: object,
    private readonly shownElsewhere: ReadonlySet<string>,
  ) {
    const entries = Object.entries((schema as Schema).properties ?? {});
    const single = entries.filter(([, value]) => value.type !== "object").map(([key, value]) => this.field([key], value));
    const groups = entries
      .filter(([, value]) => value.type === "object")
      .map(([key, value]) =>
        folded(key.replaceAll("_", " "), ...Object.entries(value.properties ?? {}).map(([name, inner]) => this.field([key, name], inner))),
      );
    this.element = element("div", {}, ...single, ...groups);
  }

  private field(path: readonly string[], schema: Schema): HTMLElement | null {
    if (this.shownElsewhere.has(path.join("."))) return null;
    const id = `set-${path.join("-")}`;
    const input = inputOf(id, schema);
    this.fields.push({ path, schema, input, standard: textOf(input) });
    const help = [schema.description, rangeText(schema)].filter((part) => part !== undefined && part !== "").join("; ");
    input.setAttribute("aria-describedby", `${id}-help`);
    return element(
      "div",
      { class: "field", "data-pointer": `/spec/${path.join("/")}` },
      element("label", { for: id }, path.at(-1)!.replaceAll("_", " ")),
      input,
      element("p", { class: "soft", id: `${id}-help` }, help),
    );
  }

  /// Fills in a preset; settings that it does not name go back to their defaults.
  apply(spec: Record<string, unknown>): void {
    for (const { path, input, standard } of this.fields) {
      const value = path.reduce<unknown>((inner, key) => (inner as Record<string, unknown> | undefined)?.[key], spec);
      const text = value === undefined ? standard : asText(value);
      if (input instanceof HTMLInputElement && input.type === "checkbox") input.checked = text === "true";
      else input.value = text;
    }
  }

  /// Settings that differ from their defaults, nested as in a configuration file.
  spec(): Record<string, unknown> {
    const spec: Record<string, unknown> = {};
    for (const { path, schema, input, standard } of this.fields) {
      if (textOf(input) === standard) continue;
      let inner = spec;
      for (const key of path.slice(0, -1)) inner = (inner[key] ??= {}) as Record<string, unknown>;
      inner[path.at(-1)!] = parsed(schema, textOf(input));
    }
    return spec;
  }
}
