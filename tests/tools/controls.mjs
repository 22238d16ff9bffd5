// Chromium presses each button and layer of the gateway's page. A second client, which sees the truth, watches what comes
// of it.
import { differentPixels, launchBrowser, takePicture } from "./browser.mjs";
import { stat } from "node:fs/promises";
import { join } from "node:path";
import { FOV, IGNORED, PAUSED, SET_ASIDE, START, WAIT, errors, hasState, heardSeconds, openPage, outside, shown, until } from "./live_page.mjs";
import { drawerFitsAPhone, panelsAreApart } from "./layout.mjs";
import { Observer, check, distance, placeIn, truth } from "./observer.mjs";
import { followsFromBehind, orbitsAfterFlying, showsFrontiersOfRows } from "./views.mjs";

const [url, program, pictures, folder] = process.argv.slice(2);
// folder: of the run's files
const say = (line) => console.log(`controls: ${line}`);

/** Does something that sends a command, and waits for the answer. @returns { isAccepted, text }; the text begins with the service */
async function answerTo(page, act) {
  await page.evaluate(() => document.getElementById("toasts").replaceChildren());
  await act();
  // A service that was silent on a busy machine is reported by another one.
  const toast = await page.waitForSelector(".toast:not(:has-text('no sign of life'), :has-text('is heard again'))");
  return { isAccepted: (await toast.getAttribute("class")).includes("good"), text: await toast.textContent() };
}

/** Does something that sends a command, and waits until the page shows that a service has accepted it. */
async function accepted(page, act, service) {
  const { isAccepted, text } = await answerTo(page, act);
  check(isAccepted && text.startsWith(service), `not accepted by ${service}: ${text}`);
  return text.slice(service.length);
}

/** The map's files are written when the button is pressed. */
async function savesTheMap(page) {
  const file = join(folder, "map.bt"), written = () => stat(file).then(({ mtimeMs, size }) => ({ mtimeMs, size }), () => ({ mtimeMs: 0, size: 0 }));
  const before = await written();
  const text = await accepted(page, () => page.click("#do-save"), "mapper");
  const after = await written();
  check(after.mtimeMs > before.mtimeMs && after.size > 1000, `${file} is of ${after.mtimeMs}, before of ${before.mtimeMs}, with ${after.size} bytes`);
  say(`save: ${text}`);
}

/** The robot, which is paused, is to choose by another strategy: the explorer does, and the page says so. */
async function choosesStrategy(page, observer, name) {
  await accepted(page, () => page.selectOption("#strategy", name), "explorer");
  await observer.untilLast(`the strategy ${name}`, "/explorer/status", ({ strategy }) => strategy === name);
  await page.evaluate(() => document.activeElement.blur()); // or it would keep the keys
  await page.waitForFunction((its) => document.getElementById("strategy").value === its, name, WAIT);
  say(`the explorer chooses by ${name}`);
}

/** The switch of the field, which only some strategies have: with a word why, where it is off and there is none. */
async function fieldIsExcused(page, strategy) {
  const { disabled, word, title } = await page.evaluate(() => {
    const button = [...document.querySelectorAll("#layers button")].find(({ textContent }) => textContent.startsWith("Field"));
    return { disabled: button.disabled, word: button.querySelector("small").textContent, title: button.title };
  });
  check(disabled && word !== "" && title.includes(strategy), `the switch of the field says "${word}" of ${strategy}, and "${title}"; disabled: ${disabled}`);
}

/** What the page says of itself from now on. */
async function look(page) {
  await page.evaluate(() => (window.thalweg = null));
  await until(page, () => window.thalweg);
  return shown(page);
}

/** One decision, and what comes of it. @returns 1 if the robot turned to a narrow passage first, which is a plan of its own */
async function step(page, observer) {
  const { plans } = observer.last.get("/explorer/status");
  await accepted(page, () => page.click("#do-step"), "explorer");
  let turns = 0;
  await observer.until("the step carried out", (topic, { state, plans: its, activity }) => {
    if (topic === "/explorer/status" && activity.startsWith("turning to")) turns = 1;
    return topic === "/explorer/status" && its > plans && state === PAUSED;
  });
  return turns;
}

/** Step: one decision is made and carried out, then the robot waits; the field that led to it is drawn. */
async function stepsByTheField(page, observer) {
  await fieldIsExcused(page, "potential");
  const interruptions = ({ interruptions: all }) => all.reduce((sum, { plans: its }) => sum + its, 0);
  const before = observer.last.get("/explorer/status"), { plans } = before, stood = observer.last.get("/simulator/status");
  const turns = await step(page, observer);
  await heardSeconds(observer, 3); // in which a second decision would show
  const after = observer.last.get("/explorer/status"), stands = observer.last.get("/simulator/status");
  check(after.state === PAUSED, "the robot goes on after the step");
  // A plan that is interrupted is made again, and not carried out.
  check(after.plans - plans <= 1 + turns + interruptions(after) - interruptions(before), `a step made ${after.plans - plans} plans`);
  const turned = turnBetween(stood, stands), moved = distance(truth(stood), truth(stands));
  check(moved > 0.05 || turned > 0.05, `the step moved the robot ${moved} m and turned it ${turned} rad`);
  // A robot that only looks around where it is has no need of a field.
  const button = page.locator("#layers button:has-text('Field')");
  for (let n = 0; n < 12 && (await button.isDisabled()); ++n) await step(page, observer);
  await button.click();
  await page.waitForSelector("#slice:not([hidden])");
  for (let n = 0; n < 12 && !((await look(page)).field?.cells > 100); ++n) await step(page, observer);
  await until(page, () => window.thalweg?.field?.cells > 100 && window.thalweg.field.lines > 10 && window.thalweg.streamline > 0);

  // The slice is where its slider says.
  const heights = [];
  let slices = 0;
  for (const key of ["Home", "PageUp", "End", "PageDown"]) {
    await page.focus("#slice-height");
    await page.keyboard.press(key);
    const said = parseFloat(await page.textContent("#slice-value"));
    await page.evaluate(() => (window.thalweg = null));
    await until(page, () => window.thalweg !== null);
    const { field } = await shown(page);
    // By half a cell, and what the text rounds off.
    check(field === null || Math.abs(field.z - said) <= 0.056, `the slice is at ${field?.z} m, the slider at ${said} m`);
    if (field !== null) ++slices;
    heights.push(said);
  }
  check(new Set(heights).size >= 3 && slices > 0, `the slice was at ${heights} m only, ${slices} times drawn`);
  say(`a step is one decision (${moved.toFixed(2)} m, ${turned.toFixed(2)} rad); its field and streamlines are drawn`);
}

/** [rad] */
function turnBetween(a, b) {
  const [p, q] = [a, b].map(({ map_from_body_true: { orientation } }) => orientation);
  return 2 * Math.acos(Math.min(1, Math.abs(p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w)));
}

const VIEW = { x: 270, y: 80, width: 660, height: 520 }; // [px] where the window shows the map alone
/** Waits until all of the map is built. */
async function isDrawn(page) {
  await page.evaluate(() => (window.thalweg = null));
  await until(page, () => window.thalweg?.waiting === 0);
}
/** A picture of the whole map, without the answers to commands, which come and go. @param path as takePicture's */
async function frame(page, path) {
  await isDrawn(page);
  await page.evaluate(() => document.getElementById("toasts").replaceChildren());
  return takePicture(page, path);
}

/** Each layer, when it is turned on or off, changes the picture. */
async function layersAreDrawn(page) {
  await page.keyboard.press("r");
  const changed = [];
  let before = await frame(page), noise = 0; // the pixels that change by themselves
  for (let n = 0; n < 4; ++n) {
    const after = await frame(page);
    noise = Math.max(noise, await differentPixels(page, before, after, VIEW));
    before = after;
  }
  check(noise < 200, `${noise} pixels change by themselves`);
  for (const [key, name] of [["p", "flown"], ["f", "frontiers"], ["u", "unknown"], ["d", "field"], ["n", "noGo"], ["m", "map"]]) {
    const wasOn = (await shown(page)).layers[name];
    await page.keyboard.press(key);
    await until(page, ([its, was]) => window.thalweg?.layers[its] !== was, [name, wasOn]);
    if (name === "unknown" && !wasOn) await until(page, () => window.thalweg?.borders > 0);
    const after = await frame(page);
    const different = await differentPixels(page, before, after, VIEW);
    check(different > 20 + noise, `${wasOn ? "without" : "with"} the layer ${name} only ${different} pixels differ, ${noise} by themselves`);
    changed.push(`${name} ${different}`);
    await page.keyboard.press(key);
    await until(page, ([its, was]) => window.thalweg?.layers[its] === was, [name, wasOn]);
    before = await frame(page);
  }
  say(`pixels that layers change: ${changed.join(", ")}; by themselves ${noise}`);
}

/** By key or button the map takes the colors that the sensor has measured, of the voxels that a second client hears of. */
async function paintsByColor(page, observer) {
  const heights = await frame(page);
  check((await shown(page)).colored === 0, "colors came that nobody asked for");
  await page.keyboard.press("o");
  await until(page, () => window.thalweg?.byColor && window.thalweg.colored > 1000);
  const colors = await frame(page);
  // A robot that is paused sees no more, so that both have the same voxels.
  observer.subscribe(["/map/colored"]);
  await observer.untilLast("the colors", "/map/colored", () => true);
  const { width } = observer.last.get("/map/colored");
  const { colored, occupied } = await shown(page);
  check(colored === width && colored > 0.9 * occupied && colored <= occupied, `the page has ${colored} colors for ${occupied} voxels, the mapper ${width}`);
  const different = await differentPixels(page, heights, colors, VIEW);
  check(different > 20000, `by color only ${different} pixels differ`);
  check(await page.isHidden("#no-colors"), "the page misses colors that it has");
  await takePicture(page, join(pictures, "page-colors.png"));
  await page.click("[data-paint=height]");
  await page.mouse.move(600, 700);
  await until(page, () => window.thalweg?.byColor === false && window.thalweg.colored === 0);
  const left = await differentPixels(page, heights, await frame(page), VIEW);
  check(left < 200, `by height again, ${left} pixels are others than before`);
  say(`${colored} of ${occupied} voxels are painted as they were measured; ${different} pixels change`);
}

/** The cut plane hides what is above it; at its top nothing is hidden. */
async function cuts(page) {
  const top = async () => (await page.textContent("#cut-value")).trim();
  const number = async () => parseFloat(await top());
  await page.focus("#cut");
  await page.keyboard.press("End");
  check((await top()) === "none", `at its top the cut says ${await top()}`);
  await page.evaluate(() => document.activeElement.blur());
  const whole = await takePicture(page);
  for (let n = 0; n < 12; ++n) await page.keyboard.press("[");
  const height = await number();
  const cut = await takePicture(page);
  const different = await differentPixels(page, whole, cut, VIEW);
  check(height > 0.5 && height < 2.5 && different > 5000, `a cut at ${height} m changes ${different} pixels`);
  await page.keyboard.press("]");
  check((await number()) > height, "] does not raise the cut");
  say(`a cut at ${height} m changes ${different} pixels`);
}

/** Holds a key until the camera has moved for some frames. */
async function flies(page) {
  await page.keyboard.down("ArrowUp");
  for (let n = 0; n < 2; ++n) {
    await page.evaluate(() => (window.thalweg = null));
    await until(page, () => window.thalweg?.frames > 1);
  }
  await page.keyboard.up("ArrowUp");
}

/** Each camera shows another picture; the robot's own is where the robot is. */
async function changesCamera(page) {
  await page.keyboard.press("r");
  let before = null, whole = null;
  const changed = [];
  for (const [key, name] of [["1", "orbit"], ["3", "robot"], ["2", "follow"], ["4", "fly"]]) {
    await page.keyboard.press(key);
    if (key === "4") await flies(page);
    await isDrawn(page);
    check(await page.evaluate((its) => document.querySelector(`[data-camera=${its}]`).classList.contains("on"), name), `${key} does not choose ${name}`);
    if (name === "follow") {
      const [x, y] = await page.evaluate(() => window.thalweg.screenOf(window.thalweg.robot));
      check(x > VIEW.x && x < VIEW.x + VIEW.width && y > VIEW.y && y < VIEW.y + VIEW.height, `the robot that is followed is at ${x}, ${y} in the window`);
    }
    await until(page, () => !window.thalweg.camera.moves);
    const picture = await takePicture(page, join(pictures, `page-${name}.png`));
    if (before) {
      const different = await differentPixels(page, before, picture, VIEW);
      check(different > 1000, `the camera ${name} shows what the one before showed: ${different} pixels differ`);
      changed.push(`${name} ${different}`);
    }
    whole ??= picture;
    before = picture;
  }
  await page.keyboard.press("r");
  const left = await differentPixels(page, whole, await frame(page), VIEW);
  check(left < 1000, `R does not bring back the whole map: ${left} pixels are others than before`);
  say(`pixels that cameras change: ${changed.join(", ")}`);
}

/** A click on a frontier's mark in the picture explains the one that is drawn there. */
async function picksInThePicture(page, observer) {
  await page.keyboard.press("r");
  await isDrawn(page);
  const { frontiers } = observer.last.get("/explorer/frontiers");
  const centers = frontiers.map(({ center: { x, y, z } }) => [x, y, z]);
  const places = await page.evaluate((all) => all.map((center) => window.thalweg.screenOf(center)), centers);
  // The one whose mark is farthest from all others, which may be drawn over it.
  const isMap = ([x, y]) => x > 270 && x < 930 && y > 80 && y < 600;
  const gaps = places.map((place, n) => (isMap(place) ? Math.min(...places.map((other, k) => (k === n ? Infinity : Math.hypot(other[0] - place[0], other[1] - place[1])))) : 0));
  const alone = gaps.indexOf(Math.max(...gaps));
  check(gaps[alone] > 12, `the mark that is most alone has another one ${gaps[alone]} pixels away`);
  await page.mouse.click(...places[alone]);
  await page.waitForSelector("#why-card:not([hidden])");
  const why = await page.textContent("#why");
  const center = centers[alone].map((c) => c.toFixed(2)).join(", ");
  check(why.includes(center), `a click on the frontier at ${center} says ${why}`);
  await page.keyboard.press("Escape");
  await page.waitForSelector("#why-card", { state: "hidden" });
  say(`a click on a mark explains the frontier at ${center}`);
}

/** A frontier that is ignored is set aside, and the page's list says why. */
async function ignoresAFrontier(page, observer) {
  // The list is that of the last decision, on whose way a frontier may have been seen, which is then refused, or have shrunk.
  let center = null;
  const rows = await page.evaluate(() => document.querySelectorAll("#frontiers button").length);
  for (let row = 0; !center; ++row) {
    check(row < rows, `none of ${rows} frontiers is there to be ignored`);
    await page.evaluate((its) => document.querySelectorAll("#frontiers button")[its].click(), row);
    const { isAccepted, text } = await answerTo(page, () => page.click("#why-ignore"));
    check(text.startsWith("explorer") && (isAccepted || text.includes("the frontier nearest to")), `ignoring a frontier: ${text}`);
    if (isAccepted) center = placeIn(text);
  }
  const isIgnored = ({ frontiers }) => frontiers.some(({ center: { x, y, z }, fate, reason }) =>
    fate === SET_ASIDE && reason === IGNORED && distance([x, y, z], center) < 0.5);
  await page.waitForSelector("#why-card", { state: "hidden" });
  await accepted(page, () => page.keyboard.press("."), "explorer"); // the next decision is made without it
  await observer.untilLast("the frontier set aside", "/explorer/frontiers", isIgnored);
  // The list itself ends after 60 that are left.
  await page.waitForFunction(() => /[1-9]\d* set aside/.test(document.getElementById("frontier-count").textContent), null, WAIT);
  await hasState(page, "paused");
  say("an ignored frontier is set aside, and counted as such");
}

/** A click on a place behind the robot, and Look there: the camera comes to have in view what the click met. */
async function looksWhereClicked(page, observer) {
  const status = () => observer.last.get("/simulator/status");
  const off = (place) => {
    const { orientation: { x, y, z, w } } = status().map_from_body_true, [px, py, pz] = truth(status());
    const forward = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], to = [place[0] - px, place[1] - py, place[2] - pz];
    return (Math.acos(forward.reduce((sum, c, k) => sum + c * to[k], 0) / Math.hypot(...to)) * 180) / Math.PI;
  };
  const places = [0, 90, 180, 270].map((deg) => [START[0] + Math.cos((deg * Math.PI) / 180), START[1] + Math.sin((deg * Math.PI) / 180), 0]);
  // From the middle to the corner of the image, which is as high as it is wide.
  const corner = (Math.atan(Math.SQRT2 * Math.tan((FOV * Math.PI) / 360)) * 180) / Math.PI;
  const behind = places.toSorted((a, b) => off(b) - off(a))[0];
  check(off(behind) > corner + 5, `the camera points ${off(behind)} degrees from each place around the robot`);
  await page.keyboard.press("f"); // or a frontier's mark might be what is clicked
  await until(page, () => !window.thalweg.layers.frontiers);
  await page.mouse.click(...(await page.evaluate((point) => window.thalweg.screenOf(point), behind)));
  await page.waitForSelector("#goal-card:not([hidden])");
  const met = placeIn(await accepted(page, () => page.click("#goal-look"), "explorer"));
  await observer.until("the look", (topic) => topic === "/simulator/status" && off(met) < corner);
  await observer.untilLast("the pause after it", "/explorer/status", ({ state }) => state === PAUSED);
  await hasState(page, "paused");
  say(`the robot looks at what was clicked: ${off(met).toFixed(0)} degrees from the middle of its image`);
}

/** A box that another client sends is shown. */
async function showsTheBox(page, observer) {
  check((await observer.call("no_go", { point: { x: 5.6, y: 4.6, z: 0 }, corner: { x: 6.6, y: 5.6, z: 2.5 } })).accepted, "no box is accepted");
  await until(page, () => window.thalweg.noGo === 1);
}

/** The box is removed by the button of its list. */
async function clearsTheBox(page, observer) {
  await accepted(page, () => page.click("#clear-boxes"), "explorer");
  await observer.untilLast("no box in force", "/explorer/status", ({ no_go }) => no_go.length === 0);
  await page.waitForSelector("#boxes-card", { state: "hidden" });
  say("the box is cleared");
}

const browser = await launchBrowser(program);
const observer = await Observer.connect(url.replace("http:", "ws:"), ["/explorer/status", "/explorer/frontiers", "/simulator/status", "/health"]);
try {
  const page = await openPage(browser, url, { width: 1280, height: 720 });
  await until(page, () => window.thalweg?.known > 1000 && window.thalweg.flown > 1 && window.thalweg.frontiers > 0);
  await accepted(page, () => page.keyboard.press(" "), "explorer");
  await hasState(page, "paused");
  await savesTheMap(page);
  const { strategy } = observer.last.get("/explorer/status");
  await choosesStrategy(page, observer, "potential");
  await stepsByTheField(page, observer);
  await ignoresAFrontier(page, observer);
  await showsTheBox(page, observer);
  await layersAreDrawn(page);
  await panelsAreApart(page, pictures);
  await choosesStrategy(page, observer, strategy);
  await page.keyboard.press("d"); // off
  await fieldIsExcused(page, strategy);
  await paintsByColor(page, observer);
  await cuts(page);
  await changesCamera(page);
  await followsFromBehind(page, observer);
  await orbitsAfterFlying(page);
  await showsFrontiersOfRows(page);
  await picksInThePicture(page, observer);
  await clearsTheBox(page, observer);
  await looksWhereClicked(page, observer);
  await drawerFitsAPhone(page, pictures, () => accepted(page, () => page.click("#do-save"), "mapper"));
  check(errors.length === 0, `the page reports ${errors.join("; ")}`);
  check(outside.length === 0, `the page asks for ${outside.join(", ")}`);
} finally {
  await browser.close();
  observer.close();
}
