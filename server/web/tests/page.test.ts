// Modules of the page that need no browser.
import assert from "node:assert/strict";
import { test } from "node:test";

import * as THREE from "three";

import { splitEvents } from "../src/api";
import { parseRoute, parseTriple, walkAddress } from "../src/router";
import { listed, significant } from "../src/text";
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
