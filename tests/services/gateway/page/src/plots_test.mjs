import assert from "node:assert/strict";
import { test } from "node:test";
import { Curve } from "../../../../../services/gateway/page/src/plots.js";

test("A curve is one piece until time is missing", () => {
  const curve = new Curve();
  assert.deepEqual(curve.pieces(), []);
  curve.interrupt();
  for (let t = 0; t < 4; ++t) curve.add(t, 2 * t);
  assert.deepEqual(curve.pieces(), [[0, 3]]);
  curve.interrupt();
  curve.interrupt();
  assert.deepEqual(curve.pieces(), [[0, 3]]);
  for (let t = 100; t < 103; ++t) curve.add(t, 500 + t);
  assert.deepEqual(curve.pieces(), [[0, 3], [4, 6]]);
});

test("A slope is that of its own piece, over the last seconds, never below 0, and not known where the piece begins", () => {
  const curve = new Curve();
  for (let t = 0; t <= 20; ++t) curve.add(t, t < 10 ? 3 * t : 27);
  const slopes = curve.slopes(5);
  assert.deepEqual([slopes[0], slopes[1], slopes[9], slopes[20]], [NaN, 3, 3, 0]);
  curve.interrupt();
  curve.add(300, 1000);
  curve.add(302, 1008);
  curve.add(303, 900);
  assert.deepEqual(curve.slopes(5).slice(-3), [NaN, 4, 0]);
});

test("What is later than now is drawn apart, joined to it where no time is missing", () => {
  const curve = new Curve();
  for (let t = 0; t < 6; ++t) {
    curve.add(t, t);
    if (t === 3) curve.isNow();
  }
  curve.interrupt();
  for (let t = 20; t < 23; ++t) curve.add(t, t);
  assert.deepEqual(curve.parts(false), [[0, 3]]);
  assert.deepEqual(curve.parts(true), [[3, 5], [6, 8]]);
  curve.isNow();
  assert.deepEqual(curve.parts(false), [[0, 5], [6, 8]]);
  assert.deepEqual(curve.parts(true), []);
});

test("What is not known is no point of a curve", () => {
  const curve = new Curve();
  curve.add(0, NaN);
  curve.add(1, 7);
  assert.deepEqual(curve.values, [7]);
});
