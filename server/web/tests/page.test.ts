// Modules of the page that need no browser.
import assert from "node:assert/strict";
import { test } from "node:test";

import * as THREE from "three";

import { splitEvents } from "../src/api";
import { bestEntries } from "../src/best_so_far";
import { causeText } from "../src/result/cause";
import { parseRoute, parseTriple, walkAddress } from "../src/router";
import { ago, duration, listed, significant } from "../src/text";
import { splitIntoPieces } from "../src/walk/pieces";

test("addresses name views, and what is none of them says so", () => {
  assert.equal(parseRoute("").view, "jobs");
  assert.equal(parseRoute("#/new").view, "new");
  assert.deepEqual([parseRoute("#/jobs/a%2Fb/walk").view, parseRoute("#/jobs/a%2Fb/walk").id], ["walk", "a/b"]);
  for (const hash of ["#/jobs/a/other", "#/jobs/a/walk/more", "#/somewhere", "#/new/a"])
    assert.equal(parseRoute(hash).view, "unknown", hash);
});

test("a link into the walk leads to the same view", () => {
  const { view, id, query } = parseRoute(walkAddress("7", [-129.125, 1.75, 43.6], [0.5, 0, -0.25]));
  assert.deepEqual([view, id], ["walk", "7"]);
  assert.deepEqual(
    [parseTriple(query.get("position")), parseTriple(query.get("direction"))],
    [
      [-129.125, 1.75, 43.6],
      [0.5, 0, -0.25],
    ],
  );
  for (const text of [null, "", "1,2", "1,2,3,4", "1,,3", "1,x,3", "1,2,Infinity"]) assert.equal(parseTriple(text), null, String(text));
});

test("events come out whole, however the stream is cut", () => {
  const stream = ': hello\n\nid: 1\nevent: state\ndata: {"a":1}\n\nid: 2\r\ndata: {"b":\r\ndata: 2}\r\n\r\nid: 3\nda';
  for (let cut = 0; cut <= stream.length; ++cut) {
    const first = splitEvents(stream.slice(0, cut));
    const second = splitEvents(first.rest + stream.slice(cut));
    assert.deepEqual(
      [...first.events, ...second.events],
      [
        { id: "1", data: '{"a":1}' },
        { id: "2", data: '{"b":\n2}' },
      ],
      `cut at ${cut}`,
    );
  }
});

test("numbers keep their digits, and lists their length", () => {
  assert.deepEqual(
    [1234.5, 0.00012345, 0, undefined].map((value) => significant(value, 3)),
    ["1,235", "1.23e-4", "0", "\u2013"],
  );
  assert.equal(listed(["a", "b", "c"], 2), "a, b and 1 more");
});

test("times are told in their two largest units, ages in one", () => {
  assert.deepEqual([0, 59.4, 60, 140, 3600, 7384, 90000, 172800].map(duration), [
    "0 s",
    "59 s",
    "1 min",
    "2 min 20 s",
    "1 h",
    "2 h 3 min",
    "1 day 1 h",
    "2 days",
  ]);
  const now = Date.parse("2026-01-02T00:00:00Z");
  assert.deepEqual(
    [0.2, 59, 119, 7199, 200000].map((seconds) => ago(new Date(now - 1000 * seconds).toISOString(), now)),
    ["0 s ago", "59 s ago", "1 min ago", "1 h ago", "2 days ago"],
  );
});

test("a cause names the work that counts, and the heaviest objects", () => {
  const shares = { draws_share: 0.05, triangles_share: 0.3, pixels_share: 0.65 };
  const objects = [
    { object: 3, name: "tree_03", ms: 12.34 },
    { object: 17, name: "", ms: 1 },
  ];
  assert.equal(causeText({ ...shares, objects }), "65 % pixels, 30 % triangles; most by tree_03 (12.3 ms), object 17 (1 ms)");
  assert.equal(causeText({ ...shares, objects: [] }), "65 % pixels, 30 % triangles");
  assert.deepEqual([causeText(null), causeText(undefined)], ["", ""]);
});

test("what a job has in hand is told in words and units, and what is not known as it is named", () => {
  assert.deepEqual(bestEntries({ other_ms: 3, unsolved_cpvs: 12, impostors: 37, texture_bytes: 812345, left_to_do: "much" }), [
    ["textures", "812 kB"],
    ["impostors", "37"],
    ["slow regions not solved", "12"],
    ["left to do", '"much"'],
    ["other", "3 ms"],
  ]);
  assert.deepEqual(bestEntries({ median_error: 0.0512 }), [["median error of the time model", "5.12 %"]]);
});

/// `count` triangles in a row along x, 1 m apart, in a shuffled order.
function row(count: number): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  const places = Array.from({ length: count }, (_, i) => (i * 7919) % count);
  geometry.setAttribute(
    "position",
    new THREE.BufferAttribute(Float32Array.from(places.flatMap((x) => [x, 0, 0, x + 0.5, 0, 0, x, 0.5, 0])), 3),
  );
  return geometry.setIndex(Array.from({ length: 3 * count }, (_, i) => i));
}

test("a split object falls into halves of halves, along its longest axis", () => {
  const pieces = splitIntoPieces([row(1000)], [1, 1, 1], { triangles: 300, extent: 0 });
  assert.deepEqual(
    pieces.map((piece) => piece[0]!.corners.length / 3),
    [250, 250, 250, 250],
  );
  const position = row(1000).getAttribute("position");
  pieces.forEach((piece, k) => piece[0]!.corners.forEach((corner) => assert.equal(Math.floor(position.getX(corner) / 250), k)));
});

test("an object is not split for its length into pieces too light to draw", () => {
  assert.equal(splitIntoPieces([row(999)], [1, 1, 1], { triangles: 0, extent: 10 }).length, 1);
  assert.equal(splitIntoPieces([row(1000)], [1, 1, 1], { triangles: 0, extent: 10 }).length, 2);
  assert.equal(splitIntoPieces([row(1000)], [0.001, 1, 1], { triangles: 0, extent: 10 }).length, 1);
});
