// The runtime module against the queries that the C++ header answers too.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { PlacementContent } from "../src/runtime/content";
import { PlacementLookup } from "../src/runtime/lookup";
import { parsePlacement, type Vector } from "../src/runtime/placement";

interface Query {
  why: string;
  position: Vector;
  direction: Vector;
  cell: number | null;
  cpv: number | null;
  objects?: number[];
  levels?: number[];
  impostors?: number[];
}

const file = JSON.parse(readFileSync(`${process.env["STANDIN_GOLDEN_DIR"]}/placement_lookup.json`, "utf8")) as {
  placement: object;
  cases: Query[];
};
const placement = parsePlacement(JSON.stringify(file.placement));

test("answers as worked out by hand", () => {
  const lookup = new PlacementLookup(placement),
    content = new PlacementContent(placement);
  assert.ok(file.cases.length > 0);
  for (const query of file.cases) {
    const found = lookup.find(query.position, query.direction);
    assert.deepEqual(found, { cell: query.cell, cpv: query.cpv }, query.why);
    if (query.objects === undefined) continue;
    const { objects, levels, impostors } = content.of(found);
    assert.deepEqual(
      { objects, levels, impostors },
      { objects: query.objects, levels: query.levels, impostors: query.impostors },
      query.why,
    );
  }
  console.log(`${file.cases.length} cases of placement_lookup.json`);
});

test("without impostors a view draws what its cell sees", () => {
  const lookup = new PlacementLookup(placement),
    content = new PlacementContent(placement);
  assert.deepEqual(content.of(lookup.find([5, 0.2, 1], [1, 0.1, -0.1]), false).objects, [0, 1, 3, 5]);
});

test("a position that is no number lies outside", () => {
  assert.deepEqual(new PlacementLookup(placement).find([NaN, 0, 0], [1, 0, 0]), { cell: null, cpv: null });
});

test("refuses another format, another version and references to nothing", () => {
  const broken = (change: object) => () => parsePlacement(JSON.stringify({ ...file.placement, ...change }));
  assert.throws(broken({ format: "other" }), /format "other" version 1/);
  assert.throws(broken({ version: 2 }), /version 2/);
  assert.throws(broken({ cpvs: [{ ...placement.cpvs[0], cell: 9 }] }), /cpvs\[0\]\.cell/);
  assert.throws(
    broken({ impostors: [{ ...placement.impostors[0], objects: [6] }, ...placement.impostors.slice(1)] }),
    /impostors\[0\]\.objects/,
  );
});

test("an empty placement holds nothing", () => {
  assert.deepEqual(new PlacementLookup({ ...placement, cells: [], intervals: [], cpvs: [] }).find([0, 0, 0], [1, 0, 0]), {
    cell: null,
    cpv: null,
  });
});
