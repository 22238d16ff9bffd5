import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import * as enums from "../../../../../services/gateway/page/src/enums.js";

const idl = readFileSync(new URL("../../../../../idl/thalweg_msgs.idl", import.meta.url), "utf8");

/** The enumerators of an enum, in their order. */
function enumerators(name) {
  const body = new RegExp(`enum ${name} \\{([^}]*)\\}`).exec(idl)[1];
  return body.replace(/\/\/.*/g, "").split(",").map((word) => word.trim());
}

test("The page has a word for each value of the enums that it shows", () => {
  for (const [name, words] of [["ExplorationState", enums.STATES], ["ExplorationOutcome", enums.OUTCOMES],
    ["FrontierFate", enums.FATES], ["AsideReason", enums.REASONS]]) {
    assert.equal(words.length, enumerators(name).length, name);
  }
});

test("The values that the page compares with are those of the messages", () => {
  assert.equal(enumerators("ExplorationState")[enums.DONE], "EXPLORATION_DONE");
  assert.equal(enumerators("ExplorationState")[enums.PAUSED], "EXPLORATION_PAUSED");
  assert.equal(enumerators("FrontierFate")[enums.CHOSEN], "FRONTIER_CHOSEN");
  assert.equal(enumerators("FrontierFate")[enums.SET_ASIDE], "FRONTIER_SET_ASIDE");
});
