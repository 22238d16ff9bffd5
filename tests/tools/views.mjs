// Where the cameras of the gateway's page stand, and what is in the middle of their pictures, while the robot rests.
import { WAIT, until } from "./live_page.mjs";
import { check, distance, truth } from "./observer.mjs";

const say = (line) => console.log(`controls: ${line}`);
const VIEW = { left: 200, right: 940, top: 70, bottom: 610 }; // [px] of a window of 1280 x 720, which no large panel covers
const MIDDLE = [475, 360];

/** What the page says of its camera once it stands: { mode, eye, target }, and where places are on the screen. */
async function look(page, places = []) {
  await page.evaluate(() => (window.thalweg = null));
  await until(page, () => window.thalweg && !window.thalweg.camera.moves);
  return page.evaluate((all) => {
    const { camera, robot, screenOf } = window.thalweg;
    return { ...camera, robot, robotAt: screenOf(robot), targetAt: screenOf(camera.target), at: all.map(screenOf) };
  }, places);
}
const isInView = ([x, y]) => x > VIEW.left && x < VIEW.right && y > VIEW.top && y < VIEW.bottom;
const isInTheMiddle = ([x, y]) => Math.hypot(x - MIDDLE[0], y - MIDDLE[1]) < 3;

/** A robot that rests is followed from behind, in the middle of the picture, as soon as it is chosen. */
export async function followsFromBehind(page, observer) {
  await page.keyboard.press("r");
  const before = await look(page);
  await page.keyboard.press("2");
  const { eye, robot, robotAt } = await look(page);
  const { orientation: { x, y, z, w } } = observer.last.get("/simulator/status").map_from_body_true;
  const forward = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z)];
  const ahead = forward.reduce((sum, c, k) => sum + c * (robot[k] - eye[k]), 0);
  check(isInTheMiddle(robotAt), `the robot that is followed is at ${robotAt} in the window`);
  check(ahead > 0.4 && eye[2] > robot[2] + 1, `it heads for ${forward}, and is followed from ${eye.map((c, k) => c - robot[k])} of it`);
  check(distance(eye, robot) < 5 && distance(eye, before.eye) > 1, `the camera is ${distance(eye, robot)} m from it`);
  check(distance(robot, truth(observer.last.get("/simulator/status"))) < 0.3, `the robot is shown at ${robot}`);
  say(`a robot that rests is followed from behind, ${distance(eye, robot).toFixed(1)} m away`);
}

/** After flying an orbit is about the robot, if it was in view; or else all of the map comes into view. */
export async function orbitsAfterFlying(page) {
  const fly = async (turn) => {
    await page.keyboard.press("r");
    await page.keyboard.press("4");
    await page.mouse.move(500, 300);
    await page.mouse.down();
    await page.mouse.move(500 + turn, 300, { steps: 4 });
    await page.mouse.up();
    const flown = await look(page);
    await page.keyboard.press("1");
    return [flown, await look(page)];
  };
  const [with_, about] = await fly(20);
  check(isInView(with_.robotAt), `the robot is at ${with_.robotAt} before the camera orbits`);
  check(distance(about.target, about.robot) < 0.01 && isInTheMiddle(about.robotAt), `the orbit is about ${about.target}, not the robot at ${about.robot}`);
  check(distance(about.eye, about.target) > 2.9 && about.eye[2] > about.target[2] + 1, `it is from ${about.eye}`);
  const [without, whole] = await fly(500);
  check(!isInView(without.robotAt), "the camera that was turned away has the robot in view");
  check(isInTheMiddle(whole.targetAt) && isInView(whole.robotAt), `the orbit about ${whole.target} has the robot at ${whole.robotAt} in the window`);
  check(distance(whole.eye, whole.target) > 5, `it is from ${whole.eye}`);
  say("an orbit after flying is about the robot in view, or shows the whole map");
}

/** A click on a row of the list brings its frontier into view, in each camera but the robot's own. */
export async function showsFrontiersOfRows(page) {
  /** Where the frontier of a row is. */
  const click = async (row) => {
    await page.evaluate((n) => document.querySelectorAll("#frontiers button")[n].click(), row);
    await page.waitForSelector("#why-card:not([hidden])", WAIT);
    const center = await page.evaluate(() => [...document.querySelectorAll("#why dt")].find(({ textContent }) => textContent === "Center").nextElementSibling.textContent);
    return center.split(",").map(Number);
  };
  const rows = [1, 4, 7];
  await page.keyboard.press("r");
  for (const row of rows) {
    const before = await look(page), place = await click(row), after = await look(page, [place]);
    check(distance(after.target, place) < 0.02 && isInTheMiddle(after.at[0]), `the orbit is about ${after.target}, not the frontier at ${place}`);
    const [was, is] = [before, after].map(({ eye, target }) => distance(eye, target));
    check(Math.abs(was - is) < 0.05, `the camera was ${was} m from what it turns about, and is ${is} m`);
  }
  await page.keyboard.press("4");
  for (const row of rows) {
    const before = await look(page), place = await click(row), after = await look(page, [place]);
    check(distance(before.eye, after.eye) < 1e-6 && isInTheMiddle(after.at[0]), `the camera that flies shows the frontier at ${after.at[0]} in the window`);
  }
  for (const row of [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]) {
    // For every other row the camera is still on its way to behind the robot.
    if (row % 2 === 0) await page.keyboard.press("2");
    const place = await click(row), { mode, robotAt, at: [on] } = await look(page, [place]);
    check(mode === "follow" && isInTheMiddle(robotAt), `the robot that is followed is at ${robotAt} in the window`);
    check(isInView(on), `beside the robot the frontier is at ${on} in the window`);
  }
  await page.keyboard.press("3");
  const own = await look(page);
  await click(rows[0]);
  check(distance((await look(page)).eye, own.eye) < 0.01, "a click on a frontier moves the robot's own camera");
  await page.keyboard.press("Escape");
  await page.keyboard.press("1");
  say("a click on a frontier's row brings it into view; the robot is still followed, and its own view stays");
}
