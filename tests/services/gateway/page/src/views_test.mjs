import assert from "node:assert/strict";
import { test } from "node:test";
import { behind, between, bothInView, headingOf, orbitFrom, shifted } from "../../../../../services/gateway/page/src/views.js";

const DEG = Math.PI / 180;
const at = (x, y, z) => ({ x, y, z });
const minus = (a, b) => at(a.x - b.x, a.y - b.y, a.z - b.z);
const lengthOf = ({ x, y, z }) => Math.hypot(x, y, z);
const distance = (a, b) => lengthOf(minus(a, b));
const elevationOf = ({ eye, target }) => Math.asin((eye.z - target.z) / distance(eye, target));
function areNear(a, b, what) {
  assert.ok(distance(a, b) < 1e-9, `${what ?? ""} ${JSON.stringify(a)} is not ${JSON.stringify(b)}`);
}
/** [rad] between two directions as an eye sees them. */
function angleAt(eye, a, b) {
  const [p, q] = [minus(a, eye), minus(b, eye)];
  return Math.acos((p.x * q.x + p.y * q.y + p.z * q.z) / (lengthOf(p) * lengthOf(q)));
}
const yes = () => true, no = () => false;

test("The heading is that of the body's x axis, whatever its pitch", () => {
  const [half, pitch] = [35 * DEG, 10 * DEG];
  assert.ok(Math.abs(headingOf({ x: 0, y: 0, z: Math.sin(half), w: Math.cos(half) }) - 70 * DEG) < 1e-9);
  // First the pitch about y, then the yaw about z.
  const turned = { x: -Math.sin(half) * Math.sin(pitch), y: Math.cos(half) * Math.sin(pitch), z: Math.sin(half) * Math.cos(pitch), w: Math.cos(half) * Math.cos(pitch) };
  assert.ok(Math.abs(headingOf(turned) - 70 * DEG) < 1e-9);
});

test("A robot is followed from behind and above", () => {
  const robot = at(1, 2, 0.5), { eye, target } = behind(robot, 90 * DEG, 0.1, yes);
  assert.equal(target, robot);
  assert.ok(Math.abs(eye.x - 1) < 1e-9 && eye.y < 0 && eye.z > 2, JSON.stringify(eye));
});

test("Where a wall hides the robot it is followed from higher up, and from the highest place where nothing helps", () => {
  const robot = at(0, 0, 0), low = elevationOf(behind(robot, 0, 0.1, yes));
  const over = behind(robot, 0, 0.1, (eye) => eye.z > 3); // the higher, the nearer to the vertical
  assert.ok(elevationOf(over) > low && over.eye.z > 3);
  assert.ok(elevationOf(behind(robot, 0, 0.1, no)) > 75 * DEG);
});

test("A place is looked at from the same side and as far away as the last one, higher up only if it is hidden", () => {
  const before = { eye: at(4, 0, 3), target: at(0, 0, 0) }, place = at(10, 5, 1);
  areNear(shifted(before, place, yes).eye, at(14, 5, 4));
  areNear(shifted(before, place, no).eye, at(14, 5, 4), "hidden from everywhere");
  const seen = shifted(before, place, (eye) => eye.z > 5);
  assert.ok(seen.eye.z > 5 && Math.abs(distance(seen.eye, place) - 5) < 1e-9 && Math.abs(seen.eye.y - 5) < 1e-9, JSON.stringify(seen));
});

test("A robot and a place beyond it are in view together, with the robot in the middle", () => {
  const robot = at(1, 1, 1), half = 20 * DEG;
  for (const place of [at(1.5, 1, 1), at(8, 1, 1), at(1, -12, 0.3), at(-2, 4, 2.5), at(1, 1, 3)]) {
    const { eye, target } = bothInView(robot, place, half);
    assert.equal(target, robot);
    assert.ok(angleAt(eye, robot, place) < half, `${JSON.stringify(place)} is ${angleAt(eye, robot, place) / DEG} degrees off`);
    assert.ok(distance(eye, robot) < 3 * distance(robot, place) + 3.01, `${JSON.stringify(place)} is seen from ${distance(eye, robot)} m`);
  }
});

test("An orbit begins about the robot where the eye is, if it is in view and neither too near nor too flat", () => {
  const robot = at(2, 0, 1);
  areNear(orbitFrom(at(7, 0, 6), robot, at(0, 0, 0), 20).eye, at(7, 0, 6));
  const near = orbitFrom(at(2.2, 0, 1.2), robot, at(0, 0, 0), 20);
  assert.equal(near.target, robot);
  assert.ok(distance(near.eye, robot) >= 3 - 1e-9);
  assert.ok(elevationOf(orbitFrom(at(9, 0, 0), robot, at(0, 0, 0), 20)) > 25 * DEG);
  assert.ok(elevationOf(orbitFrom(at(2, 0, 9), robot, at(0, 0, 0), 20)) < 85 * DEG);
});

test("Without the robot in view an orbit shows the whole map from the side where the eye is", () => {
  const center = at(3, 4, 1), { eye, target } = orbitFrom(at(3, 4.5, 1.5), null, center, 18);
  assert.equal(target, center);
  assert.ok(Math.abs(distance(eye, center) - 18) < 1e-9 && eye.y > center.y && Math.abs(eye.x - center.x) < 1e-9);
});

test("The way to a view begins and ends where it should, and turns about what is looked at", () => {
  const a = { eye: at(5, 0, 0), target: at(0, 0, 0) }, b = { eye: at(0, 5, 0), target: at(0, 0, 0) };
  for (const [share, view] of [[0, a], [1, b]]) for (const name of ["eye", "target"]) areNear(between(a, b, share)[name], view[name], name);
  areNear(between(a, b, 0.5).eye, at(5 * Math.SQRT1_2, 5 * Math.SQRT1_2, 0));
});

test("A camera that stays turns in place, the shorter way around", () => {
  const direction = (deg) => at(1 + 4 * Math.cos(deg * DEG), 2 + 4 * Math.sin(deg * DEG), 3);
  const eye = at(1, 2, 3);
  for (const [from, to, middle] of [[170, -170, 180], [-80, 80, 0], [0, 179, 89.5]]) {
    const half = between({ eye, target: direction(from) }, { eye, target: direction(to) }, 0.5);
    areNear(half.eye, eye);
    areNear(half.target, direction(middle), `from ${from} to ${to}`);
  }
});
