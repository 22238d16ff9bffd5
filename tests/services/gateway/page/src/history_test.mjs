import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../../../../../services/gateway/page/src/history.js";

/** A message of rows at these times, null where time is missing; what is known at t is 10 t, and the robot is at x = t. */
const message = (times, reset = false) => ({
  reset,
  time_s: times.map((t) => t ?? 0),
  position_m: times.flatMap((t) => (t === null ? [NaN, NaN, NaN] : [t, 0, 0])),
  known_m3: times.map((t) => 10 * t),
  distance_m: times.map((t) => t),
  planning_ms: times.map(() => NaN),
});
const range = (from, to, step = 1) => Array.from({ length: Math.floor((to - from) / step + 1e-9) + 1 }, (_, n) => from + n * step);
/** [first, last] time of each piece of what is known. */
const piecesOf = (history) => {
  const curve = history.curve("known");
  return curve.pieces().map((piece) => piece.map((n) => curve.times[n]));
};
const nowOf = (history) => {
  const curve = history.curve("known");
  return curve.times[curve.now];
};

test("What comes in rows is one piece, and its end is now", () => {
  const history = new History();
  history.add(message(range(0, 5), true), false);
  history.add(message([6, 7]), false);
  assert.deepEqual(piecesOf(history), [[0, 7]]);
  assert.equal(nowOf(history), 7);
  assert.deepEqual(history.curve("known").values, range(0, 7).map((t) => 10 * t));
});

test("A gap stays one, for curves and for the path", () => {
  const history = new History();
  history.add(message([0, 1, 2, null, 20, 21], true), false);
  assert.deepEqual(piecesOf(history), [[0, 2], [20, 21]]);
  const { points, breaks } = history.path();
  assert.deepEqual(points.filter((_, n) => n % 3 === 0), [0, 1, 2, 20, 21]);
  assert.deepEqual([...breaks], [3]);
});

test("After a replay has gone back what comes later is still known, and the path ends now", () => {
  const history = new History();
  history.add(message(range(0, 10), true), false);
  history.add(message(range(0, 4), true), true);
  assert.deepEqual(piecesOf(history), [[0, 10]]);
  assert.equal(nowOf(history), 4);
  assert.equal(history.path().points.at(-3), 4);
});

test("What is not a replay that has gone back begins from the start", () => {
  const history = new History();
  history.add(message(range(0, 10), true), false);
  history.add(message(range(0, 4), true), false);
  assert.deepEqual(piecesOf(history), [[0, 4]]);
});

test("A replay sent beyond what is known, and back into the gap, fills it without a line across the rest", () => {
  const history = new History();
  history.add(message(range(0, 5), true), false);
  history.add(message([null, 20, 21, 22]), true);
  // Back to 10: the gateway forgets what is later.
  history.add(message([...range(0, 5), null, 10, 11], true), true);
  assert.deepEqual(piecesOf(history), [[0, 5], [10, 11], [20, 22]]);
  assert.equal(nowOf(history), 11);
  history.add(message(range(12, 20)), true);
  assert.deepEqual(piecesOf(history), [[0, 5], [10, 22]]);
  assert.deepEqual(history.curve("known").times, [...range(0, 5), ...range(10, 22)]);
});

test("Where it is played again the new rows take the place of the old ones, also at another pace", () => {
  const history = new History();
  history.add(message(range(0, 10, 0.5), true), false);
  history.add(message([0], true), true);
  history.add(message([3, 6]), true);
  assert.deepEqual(history.curve("known").times, [0, 3, ...range(6, 10, 0.5)]);
  assert.deepEqual(piecesOf(history), [[0, 10]]);
  // Sent ahead into what is known: nothing is missing there.
  history.add(message([null, 8.25]), true);
  assert.deepEqual(piecesOf(history), [[0, 10]]);
  assert.equal(nowOf(history), 8.25);
});

test("A jump that the gateway takes for the pace of a fast replay is no line, if this page has asked for it", () => {
  const [asked, other] = [new History(), new History()];
  for (const history of [asked, other]) history.add(message(range(0, 10, 2.5), true), false);
  asked.jump();
  // A row that was on its way is none from elsewhere.
  for (const history of [asked, other]) history.add(message([12.5, 19.5, 22]), true);
  assert.deepEqual(piecesOf(asked), [[0, 12.5], [19.5, 22]]);
  assert.deepEqual(piecesOf(other), [[0, 22]]);
});
