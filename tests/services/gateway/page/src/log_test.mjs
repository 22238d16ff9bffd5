import assert from "node:assert/strict";
import { test } from "node:test";
import { LogLines } from "../../../../../services/gateway/page/src/log.js";

const INFO = 20, WARN = 30;
const line = (sec, msg, level = INFO, name = "mapper") => ({ stamp: { sec, nanosec: 0 }, level, name, msg });
const textsOf = (lines, least = 0) => lines.last(100, least).map(({ text }) => text);

test("Lines stand in the order of their stamps, each once", () => {
  const lines = new LogLines();
  assert.ok(lines.add(line(2, "second")));
  assert.ok(lines.add(line(1, "first", INFO, "explorer")));
  assert.ok(!lines.add(line(2, "second")));
  assert.ok(lines.add(line(2, "second", INFO, "explorer")));
  assert.deepEqual(textsOf(lines), ["first", "second", "second"]);
  assert.deepEqual(lines.last(1, 0).map(({ name }) => name), ["explorer"]);
});

test("A warning that is repeated with higher counts takes the place of the one before", () => {
  const lines = new LogLines();
  lines.add(line(1, "depth/points dropped: too old", WARN));
  lines.add(line(2, "going on"));
  lines.add(line(3, "depth/points dropped: too old (4 more, 5 in total)", WARN));
  lines.add(line(4, "depth/points dropped: too old (6 in total)", WARN));
  lines.add(line(4, "depth/points dropped: too old (9 in total)", WARN, "surface"));
  lines.add(line(5, "depth/points dropped: without a pose (7 in total)", WARN));
  assert.deepEqual(textsOf(lines), ["going on", "depth/points dropped: too old (6 in total)", "depth/points dropped: too old (9 in total)",
    "depth/points dropped: without a pose (7 in total)"]);
  lines.add(line(6, "going on"));
  assert.equal(textsOf(lines).filter((text) => text === "going on").length, 2);
  assert.equal(textsOf(lines, WARN).length, 3);
});

test("An older line that arrives late does not remove a newer one", () => {
  const lines = new LogLines();
  lines.add(line(5, "clock rejected: jumps (8 in total)", WARN));
  lines.add(line(3, "clock rejected: jumps", WARN));
  assert.deepEqual(textsOf(lines), ["clock rejected: jumps", "clock rejected: jumps (8 in total)"]);
});

test("Lines of a span of time are forgotten", () => {
  const lines = new LogLines();
  for (let sec = 1; sec <= 5; ++sec) lines.add(line(sec, `${sec}`));
  assert.ok(lines.forget(2, 4));
  assert.ok(!lines.forget(2, 4));
  assert.deepEqual(textsOf(lines), ["1", "2", "5"]);
});
