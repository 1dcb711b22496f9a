// Help, parser and schema agree: each setting in the schema is offered by the commands that take it, and no command takes what it does not
// offer.
import assert from "node:assert/strict";
import test from "node:test";
import { expectExit } from "./standin.mjs";

const kCommands = ["make-city", "info", "calibrate", "survey", "place", "sweep", "bake", "check", "verify", "report"];
const help = Object.fromEntries(kCommands.map((command) => [command, expectExit(0, command, "--help").out]));

/** Keys that a command's help names, each with its flag: "  --leaf-m TEXT   side of ... [view_space.leaf_m, default 23.0]". */
function settingsOf(command) {
  const options = help[command].replace(/\n\s{10,}/g, " ");
  return new Map([...options.matchAll(/^\s+(--[a-z-]+)\b.*\[([a-z_.]+), default/gm)].map((match) => [match[2], match[1]]));
}

function schemaKeys() {
  const schema = JSON.parse(expectExit(0, "place", "--print-schema").out);
  const keys = new Map();
  for (const [name, entry] of Object.entries(schema.properties)) {
    if (!entry.properties) keys.set(name, entry);
    for (const [inner, setting] of Object.entries(entry.properties ?? {})) keys.set(`${name}.${inner}`, setting);
  }
  return keys;
}

/** A value other than the default that the schema allows, as a flag's text. */
function otherValue(setting) {
  if (setting.enum) return setting.enum.find((word) => word !== setting.default) ?? setting.default;
  if (setting.type === "boolean") return String(!setting.default);
  if (setting.type === "string") return setting.examples?.[0] ?? (setting.pattern ? "orbit" : "cm");
  if (setting.type === "array") return setting.items.type === "number" ? "33,44" : (setting.items.enum?.[0] ?? "word");
  const least = setting.exclusiveMinimum ?? setting.minimum ?? 0;
  const value = setting.default + 1;
  return String(value <= (setting.maximum ?? Infinity) ? value : (setting.default + least) / 2);
}

test("standin --help names every command, and --version answers", () => {
  const { out } = expectExit(0, "--help");
  for (const command of kCommands) assert.match(out, new RegExp(`^  ${command} `, "m"));
  assert.match(expectExit(0, "--version").out, /^standin \d+\.\d+\.\d+$/m);
});

test("survey, place and sweep offer every setting of the schema but the boxes and what is another's", () => {
  const keys = [...schemaKeys().keys()].filter((key) => key !== "view_space.boxes").sort();
  const others = { survey: /^sweep\./, place: /^sweep\./, sweep: /^(budget_ms|device|verify\..*)$/ };
  for (const [command, other] of Object.entries(others))
    assert.deepEqual([...settingsOf(command).keys()].sort(), keys.filter((key) => !other.test(key)), command);
});

test("every offered flag sets its key", () => {
  const keys = schemaKeys();
  for (const command of kCommands)
    for (const [key, flag] of settingsOf(command)) {
      const setting = keys.get(key);
      const value = otherValue(setting);
      const config = JSON.parse(expectExit(0, command, ...(setting.type === "boolean" ? [`${flag}=${value}`] : [flag, value]), "--print-config").out);
      const now = key.split(".").reduce((section, name) => section[name], config);
      const wanted = setting.type === "string" ? value : setting.type === "boolean" ? value === "true" : setting.type !== "array" ? Number(value) : setting.items.type === "number" ? [33, 44] : [value];
      assert.deepEqual(now, wanted, `standin ${command} ${flag} ${value}`);
    }
});

test("flags that a command does not offer are refused", () => {
  const flags = [...settingsOf("place").values()];
  for (const command of kCommands.filter((name) => name !== "survey" && name !== "place"))
    for (const flag of flags.filter((name) => !help[command].includes(name)))
      assert.match(expectExit(2, command, flag, "1").err, new RegExp(`not understood:.*${flag}.*\\[bad_usage\\]`), `${command} ${flag}`);
});
