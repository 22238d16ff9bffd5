import assert from "node:assert/strict";
import { test } from "node:test";
import { RATES, clockText, nextRate } from "../../../../../services/gateway/page/src/timeline.js";

test("A time is written as its recording's length needs", () => {
  assert.equal(clockText(7.46, 30), "0:07.4");
  assert.equal(clockText(0, 30), "0:00.0");
  assert.equal(clockText(65.9, 90), "1:05");
  assert.equal(clockText(3599, 3599), "59:59");
  assert.equal(clockText(3725, 7200), "1:02:05");
});

test("The next rate is the nearest one of the menu, also from a rate that is not in it", () => {
  assert.equal(nextRate(1, true), 2);
  assert.equal(nextRate(1, false), 0.5);
  assert.equal(nextRate(3, true), 5);
  assert.equal(nextRate(3, false), 2);
  assert.equal(nextRate(RATES.at(-1), true), RATES.at(-1));
  assert.equal(nextRate(RATES[0], false), RATES[0]);
});
