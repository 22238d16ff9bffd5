import assert from "node:assert/strict";
import { test } from "node:test";
import { robotFrom } from "../../../../../services/gateway/page/src/robot.js";

const PARAMETERS = new Map([["robot.radius_m", 0.1], ["robot.height_m", 0], ["depth_sensor.horizontal_fov_deg", 75],
  ["depth_sensor.width_px", 200], ["depth_sensor.height_px", 100], ["robot.name", ""], ["frames.base_link", "base_link"],
  ["frames.camera", "lens"]]);

test("The robot has the size and the view of the parameters", () => {
  assert.deepEqual(robotFrom(PARAMETERS), { radius: 0.1, height: 0, fovDeg: 75, aspect: 2, bodyFrame: "base_link", cameraFrame: "lens" });
});

test("A robot with a name has it before its frames", () => {
  const { bodyFrame, cameraFrame } = robotFrom(new Map([...PARAMETERS, ["robot.name", "scout"]]));
  assert.deepEqual([bodyFrame, cameraFrame], ["scout/base_link", "scout/lens"]);
});

test("What the gateway does not give is named instead of assumed", () => {
  for (const name of PARAMETERS.keys()) {
    const others = new Map(PARAMETERS);
    others.delete(name);
    assert.throws(() => robotFrom(others), { message: `the gateway gives no parameter ${name}` });
  }
});
