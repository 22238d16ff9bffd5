import assert from "node:assert/strict";
import { test } from "node:test";
import { Transforms } from "../../../../../services/gateway/page/src/transforms.js";

const H = Math.SQRT1_2;
/** A quarter turn about z, and x ahead. */
const link = (parent, child, [x, y, z], [qx, qy, qz, qw]) => ({ header: { frame_id: parent }, child_frame_id: child,
  transform: { translation: { x, y, z }, rotation: { x: qx, y: qy, z: qz, w: qw } } });
const round = (values) => Object.fromEntries(Object.entries(values).map(([key, value]) => [key, Math.round(1e9 * value) / 1e9 + 0]));

test("Links of several messages and publishers make a chain", () => {
  const transforms = new Transforms();
  transforms.add({ transforms: [link("base_link", "mount", [1, 0, 0], [0, 0, H, H])] }); // turned left
  transforms.add({ transforms: [link("mount", "camera", [1, 0, 0.5], [0, 0, H, H])] }); // and once more
  const pose = transforms.poseOf("camera", "base_link");
  assert.deepEqual(round(pose.translation), { x: 1, y: 1, z: 0.5 }); // ahead of the mount is left of the body
  assert.deepEqual(round(pose.rotation), { w: 0, x: 0, y: 0, z: 1 }); // a half turn
});

test("A turn about any axis moves what follows it by the matrix of its quaternion", () => {
  const [x, y, z, w] = [0.5, -0.1, 0.7, Math.sqrt(1 - 0.25 - 0.01 - 0.49)];
  const matrix = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]];
  const transforms = new Transforms();
  const p = [0.3, -2, 5];
  transforms.add({ transforms: [link("a", "b", [1, 2, 3], [x, y, z, w]), link("b", "c", p, [0, 0, 0, 1])] });
  const { translation } = transforms.poseOf("c", "a");
  ["x", "y", "z"].forEach((axis, k) => {
    const expected = [1, 2, 3][k] + matrix[k].reduce((sum, m, j) => sum + m * p[j], 0);
    assert.ok(Math.abs(translation[axis] - expected) < 1e-12, axis);
  });
});

test("Without a chain there is no pose, in a circle neither", () => {
  const transforms = new Transforms();
  transforms.add({ transforms: [link("map", "base_link", [0, 0, 0], [0, 0, 0, 1]), link("b", "a", [0, 0, 0], [0, 0, 0, 1]),
    link("a", "b", [0, 0, 0], [0, 0, 0, 1])] });
  assert.equal(transforms.poseOf("camera", "base_link"), null);
  assert.equal(transforms.poseOf("a", "base_link"), null);
});
