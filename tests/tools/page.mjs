// Chromium steers a live run from the gateway's page. A second client, which sees the truth, watches what comes of it.
import { differentPixels, launchBrowser, takePicture } from "./browser.mjs";
import { stat } from "node:fs/promises";
import { join } from "node:path";
import { LONG, Observer, check, distance, seconds, truth } from "./observer.mjs";

const [url, program, pictures, folder] = process.argv.slice(2);
// folder: of the run's files
// [ms] A software renderer on a busy machine takes its time, so that conditions are not tested at each frame alone.
const WAIT = { timeout: 2 * LONG, polling: 200 };
const PAUSED = 5, DONE = 4, SET_ASIDE = 2, IGNORED = 6; // of thalweg_msgs
const RADIUS = 0.1, FOV = 75; // [m], [deg] of the kitchen's robot, whose scenario leaves both to the defaults
const START = [1.5, 4.7, 1.2]; // where it sets out
const say = (line) => console.log(`page: ${line}`);

const errors = [], outside = [];
async function openPage(browser, viewport) {
  const page = await browser.newPage({ viewport });
  page.setDefaultTimeout(WAIT.timeout);
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("request", (request) => {
    if (!request.url().startsWith(url) && !request.url().startsWith("data:")) outside.push(request.url());
  });
  await page.goto(url, { waitUntil: "commit" });
  return page;
}
/** Waits for a condition on window.thalweg, the page's account of what it shows. */
const until = (page, condition, argument = null) => page.waitForFunction(condition, argument, WAIT);
const shown = (page) => page.evaluate(() => window.thalweg);
const hasState = (page, state) => page.waitForFunction((its) => document.documentElement.dataset.state === its, state, WAIT);

/** Does something that sends a command, and waits until the page shows that a service has accepted it. */
async function accepted(page, act, service) {
  await page.evaluate(() => document.getElementById("toasts").replaceChildren());
  await act();
  const toast = await page.waitForSelector(".toast");
  const [tone, text] = [await toast.getAttribute("class"), await toast.textContent()];
  check(tone.includes("good") && text.startsWith(service), `not accepted by ${service}: ${text}`);
  return text.slice(service.length);
}

/** What the page shows grows: the map, the frontiers, the services; a frontier says why; keys work. */
async function looks(page) {
  await until(page, () => window.thalweg?.known > 1000 && window.thalweg.faces > 100 && window.thalweg.flown > 1);
  const { known, shape } = await shown(page);
  check(shape.radius === RADIUS && shape.fovDeg === FOV && shape.aspect === 1, `the robot is drawn as ${JSON.stringify(shape)}`);
  await until(page, (before) => window.thalweg.known > before, known);
  await until(page, () => window.thalweg.ahead > 0);
  await page.waitForFunction(() => document.querySelectorAll("#services .row").length >= 4, null, WAIT);
  await page.waitForFunction(() => document.querySelectorAll("#frontiers button").length > 0, null, WAIT);
  // In one step, since the next plan may forget the frontier.
  const why = await page.evaluate(() => {
    document.querySelector("#frontiers button").click();
    return document.getElementById("why-card").hidden ? "" : document.getElementById("why").textContent;
  });
  check(why.includes("Unknown voxels"), "a click on a frontier does not say why");
  await page.keyboard.press("Escape");
  // The first lines of all services, which were written before the page was opened.
  await page.waitForFunction(() => {
    const lines = [...document.querySelectorAll("#log .line")].map(({ textContent }) => textContent);
    return ["mapper", "explorer", "controller"].every((name) => lines.some((line) => line.includes(name) && line.includes("DDS domain")));
  }, null, WAIT);
  say("map and frontiers grow, a frontier says why, all services' log lines are there");
}

/** Each service has a whole row, in windows that are as low as a laptop's. */
async function rowsAreWhole(page) {
  const before = page.viewportSize();
  for (const viewport of [{ width: 1280, height: 810 }, { width: 1024, height: 768 }]) {
    await page.setViewportSize(viewport);
    const { rows, whole } = await page.evaluate(() => {
      const bottom = Math.min(...[".side", ".services", "#services"].map((its) => document.querySelector(its).getBoundingClientRect().bottom));
      const all = [...document.querySelectorAll("#services .row")];
      return { rows: all.length, whole: all.filter((row) => row.getBoundingClientRect().bottom <= bottom + 0.5).length };
    });
    check(rows >= 4 && whole === rows, `${whole} of ${rows} services are whole at ${viewport.width} x ${viewport.height}`);
    await takePicture(page, join(pictures, `page-${viewport.width}x${viewport.height}.png`));
  }
  await page.setViewportSize(before);
  say("each service has a whole row at 1280 x 810 and 1024 x 768");
}

/** After the pause the robot stands within a second of the run's time, by the truth. */
async function pauseStops(page, observer) {
  await observer.untilLast("the robot on its way", "/simulator/status", ({ distance_m }) => distance_m > 0.3);
  await hasState(page, "moving");
  await page.keyboard.press(" ");
  let paused = null, stood = null, moved = 0;
  await observer.until("two seconds of the run after the pause", (topic, message) => {
    if (topic === "/explorer/status" && message.state === PAUSED) paused ??= seconds(message.header.stamp);
    if (topic !== "/simulator/status" || paused === null) return false;
    const since = seconds(message.header.stamp) - paused;
    if (since < 1) return false;
    stood ??= truth(message);
    moved = Math.max(moved, distance(stood, truth(message)));
    return since > 3;
  });
  check(moved < 0.01, `the robot moved ${moved} m from a second after the pause on`);
  await hasState(page, "paused");
  await page.waitForSelector(".toast.good");
  say(`the robot stands a second after the pause (it moved ${(1000 * moved).toFixed(1)} mm later)`);
}

async function themeAndHelp(page) {
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  const before = await theme();
  await page.keyboard.press("t");
  check((await theme()) !== before, "T does not change the theme");
  await page.keyboard.press("?");
  check(await page.isVisible("#help"), "? shows no help");
  const lines = await page.locator("#keys dd").count();
  check(lines > 20, `the help has ${lines} lines`);
  await page.keyboard.press("?");
  check(!(await page.isVisible("#help")), "? does not end the help");
}

/** In the dialog that asks before the end, the keys are the dialog's: the run is neither paused, resumed nor ended. */
async function asksBeforeTheEnd(page, observer) {
  const open = () => page.evaluate(() => document.getElementById("stop-dialog").open);
  for (const [key, focus] of [["Escape", "danger"], ["Enter", "plain:not(.danger)"], [" ", "plain:not(.danger)"]]) {
    await page.keyboard.press("x");
    check(await open(), "X does not ask");
    await page.focus(`#stop-dialog button.${focus}`);
    await page.keyboard.press(key);
    check(!(await open()), `"${key}" does not close the dialog`);
  }
  await heardSeconds(observer, 2); // in which a command would have taken effect
  check(observer.last.get("/explorer/status").state === PAUSED, "keys in the dialog change the state of the run");
  say("the dialog before the end has its keys for itself");
}

/** The picture after a reload is that of before; a second page shows the same, and steers as well. */
async function reloadAndSecondPage(page, browser, observer) {
  const before = await shown(page);
  await page.reload({ waitUntil: "commit" });
  const same = (its) => window.thalweg?.flown >= its.flown && window.thalweg.known >= its.known && window.thalweg.state === its.state;
  await until(page, same, before);
  const second = await openPage(browser, { width: 900, height: 620 });
  await until(second, same, before);
  await second.click("#do-pause"); // which resumes
  await observer.untilLast("the run to go on", "/explorer/status", ({ state }) => state !== PAUSED);
  await page.waitForFunction(() => document.documentElement.dataset.state !== "paused", null, WAIT);
  await page.keyboard.press(" ");
  for (const each of [page, second]) await hasState(each, "paused");
  say("a reload keeps the picture; two pages show and steer one run");
  return second;
}

/** The robot, which is paused, is to choose by another strategy: the explorer does, and both pages say so. */
async function choosesStrategy(page, second, observer, name) {
  await accepted(page, () => page.selectOption("#strategy", name), "explorer");
  await observer.untilLast(`the strategy ${name}`, "/explorer/status", ({ strategy }) => strategy === name);
  await page.evaluate(() => document.activeElement.blur()); // or it would keep the keys
  for (const each of [page, second]) await each.waitForFunction((its) => document.getElementById("strategy").value === its, name, WAIT);
  say(`the explorer chooses by ${name}`);
}

/** Step: one decision is made and carried out, then the robot waits; meanwhile the field that led to it is drawn. */
async function stepsByTheField(page, observer) {
  await page.click("#layers button:has-text('Field')");
  await page.waitForSelector("#slice:not([hidden])");
  await heardSeconds(observer, 4); // until the explorer knows that somebody reads the field
  const { plans, replans } = observer.last.get("/explorer/status"), stood = observer.last.get("/simulator/status");
  await accepted(page, () => page.click("#do-step"), "explorer");
  await observer.until("the step carried out", (topic, { state, plans: its }) => topic === "/explorer/status" && its > plans && state === PAUSED);
  await heardSeconds(observer, 3); // in which a second decision would show
  const after = observer.last.get("/explorer/status"), stands = observer.last.get("/simulator/status");
  check(after.state === PAUSED, "the robot goes on after the step");
  check(after.plans - plans <= 1 + after.replans - replans, `a step made ${after.plans - plans} plans`);
  const turned = turnBetween(stood, stands), moved = distance(truth(stood), truth(stands));
  check(moved > 0.05 || turned > 0.05, `the step moved the robot ${moved} m and turned it ${turned} rad`);
  await until(page, () => window.thalweg.field?.cells > 100 && window.thalweg.field.lines > 10 && window.thalweg.streamline > 0);

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

/** Each layer, when it is turned on or off, changes the picture. */
async function layersAreDrawn(page) {
  await page.keyboard.press("r");
  const view = { x: 270, y: 80, width: 660, height: 560 }; // of the map alone
  const frame = async () => {
    await page.evaluate(() => (window.thalweg = null));
    await until(page, () => window.thalweg?.waiting === 0);
    return takePicture(page);
  };
  await page.evaluate(() => document.getElementById("toasts").replaceChildren());
  const changed = [], unchanged = await frame();
  let before = await frame();
  const noise = await differentPixels(page, unchanged, before, view);
  check(noise < 20, `${noise} pixels change by themselves`);
  for (const [key, name] of [["p", "flown"], ["f", "frontiers"], ["u", "unknown"], ["d", "field"], ["n", "noGo"], ["m", "map"]]) {
    const wasOn = (await shown(page)).layers[name];
    await page.keyboard.press(key);
    await until(page, ([its, was]) => window.thalweg?.layers[its] !== was, [name, wasOn]);
    if (name === "unknown" && !wasOn) await until(page, () => window.thalweg?.borders > 0);
    const after = await frame();
    const different = await differentPixels(page, before, after, view);
    check(different > 20, `${wasOn ? "without" : "with"} the layer ${name} only ${different} pixels differ`);
    changed.push(`${name} ${different}`);
    await page.keyboard.press(key);
    await until(page, ([its, was]) => window.thalweg?.layers[its] === was, [name, wasOn]);
    before = await frame();
  }
  say(`pixels that layers change: ${changed.join(", ")}`);
}

/** A frontier that is ignored is set aside, and the page's list says why. */
async function ignoresAFrontier(page, observer) {
  const center = await page.evaluate(() => {
    document.querySelector("#frontiers button").click();
    const terms = [...document.querySelectorAll("#why dt")], place = terms.find(({ textContent }) => textContent === "Center");
    return place.nextSibling.textContent.split(",").map(Number);
  });
  const isIgnored = ({ frontiers }) => frontiers.some(({ center: { x, y, z }, fate, reason }) =>
    fate === SET_ASIDE && reason === IGNORED && distance([x, y, z], center) < 0.5);
  check(!isIgnored(observer.last.get("/explorer/frontiers")), "the frontier is ignored already");
  await accepted(page, () => page.click("#why-ignore"), "explorer");
  await page.waitForSelector("#why-card", { state: "hidden" });
  await accepted(page, () => page.keyboard.press("."), "explorer"); // the next decision is made without it
  await observer.untilLast("the frontier set aside", "/explorer/frontiers", isIgnored);
  await page.waitForFunction(() => document.getElementById("frontiers").textContent.includes("ignored by the operator"), null, WAIT);
  await hasState(page, "paused");
  say("an ignored frontier is set aside, and listed as such");
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

/** A click on the floor behind the robot, and Look there: the robot turns until its camera has the place in view. */
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
  await page.mouse.click(...(await page.evaluate((point) => window.thalweg.screenOf(point), behind)));
  await page.waitForSelector("#goal-card:not([hidden])");
  await accepted(page, () => page.click("#goal-look"), "explorer");
  await observer.until("the look", (topic) => topic === "/simulator/status" && off(behind) < corner);
  await observer.untilLast("the pause after it", "/explorer/status", ({ state }) => state === PAUSED);
  await hasState(page, "paused");
  say(`the robot looks at a place behind it: ${off(behind).toFixed(0)} degrees from the middle of its image`);
}

/** The drawn box is removed, and the place in it may be gone to again. */
async function clearsTheBox(page, observer) {
  await accepted(page, () => page.click("#clear-boxes"), "explorer");
  await observer.untilLast("no box in force", "/explorer/status", ({ no_go }) => no_go.length === 0);
  await page.waitForSelector("#boxes-card", { state: "hidden" });
  say("the box is cleared");
}

/** Draws a box by dragging on the floor in front of the camera. Returns it as the explorer has it. */
async function drawBox(page, observer) {
  await page.keyboard.press("r");
  await page.keyboard.press("b");
  const spot = (at) => page.evaluate((point) => window.thalweg.screenOf(point), at);
  const [from, to] = [await spot([5.6, 4.6, 0]), await spot([6.6, 5.6, 0])];
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
  await page.mouse.move(...to);
  await page.mouse.up();
  await page.fill("#box-high", "2.5");
  await takePicture(page, join(pictures, "page-box.png"));
  await page.click("#box-send");
  await observer.untilLast("the box in force", "/explorer/status", ({ no_go }) => no_go.length === 1);
  await until(page, () => window.thalweg.noGo === 1);
  check(await page.isVisible("#boxes-card"), "the box is not listed");
  const { min, max } = observer.last.get("/explorer/status").no_go[0];
  const box = [min, max].map(({ x, y, z }) => [x, y, z]);
  check(distance(box[0], [5.6, 4.6, 0]) < 0.15 && distance(box[1], [6.6, 5.6, 2.5]) < 0.15, `the box is ${JSON.stringify(box)}`);
  const refused = await observer.call("goto", { point: { x: 6.1, y: 5.1, z: 1.2 } });
  check(!refused.accepted, "a goal within the box is accepted");
  say(`a box is drawn; a goal in it is refused: ${refused.reason}`);
  return box;
}
const outsideOf = ([min, max], p) => Math.hypot(...p.map((c, k) => Math.max(min[k] - c, 0, c - max[k])));

/** So many health messages of the simulator, which sends one a second. */
async function heardSeconds(observer, count) {
  let heard = 0;
  await observer.until(`${count} s`, (topic, { service }) => topic === "/health" && service === "simulator" && ++heard === count);
}

/** A page whose script stands still for a minute, 20 s of which the robot explores, shows the whole map afterwards. */
async function sleepsAndWakes(second, page, observer) {
  const session = await second.context().newCDPSession(second);
  await session.send("Debugger.enable");
  const asleep = new Promise((resolve) => session.once("Debugger.paused", resolve));
  await session.send("Debugger.pause");
  await asleep;
  await page.keyboard.press(" ");
  await heardSeconds(observer, 20);
  await page.keyboard.press(" ");
  await hasState(page, "paused");
  await heardSeconds(observer, 40);
  await session.send("Debugger.resume");
  await hasState(second, "paused");
  // The robot stands, so that both come to the same picture.
  for (const end = Date.now() + LONG; ; ) {
    const [awake, woken] = [await shown(page), await shown(second)];
    const whole = [awake, woken].every(({ waiting }) => waiting === 0);
    if (whole && awake.known === woken.known && awake.occupied === woken.occupied && Math.abs(awake.flown - woken.flown) <= 1) break;
    check(Date.now() < end, `the page that slept shows ${JSON.stringify(woken)}, not ${JSON.stringify(awake)}`);
    await page.waitForFunction((bytes) => window.thalweg.bytes > bytes, awake.bytes, WAIT);
  }
  await session.detach();
  say("a page that slept for a minute shows the whole map");
}

/** A click on the floor under the start, and G: the robot arrives above it. */
async function goesWhereClicked(page, observer) {
  await page.keyboard.press("1");
  await page.keyboard.press("r");
  if ((await shown(page)).layers.frontiers) await page.keyboard.press("f");
  await page.mouse.click(...(await page.evaluate((point) => window.thalweg.screenOf(point), [START[0], START[1], 0])));
  await page.waitForSelector("#goal-card:not([hidden])");
  const [x, y] = (await page.textContent("#goal-place")).split(",").map(Number);
  check(Math.hypot(x - START[0], y - START[1]) < 0.3, `the click meets ${x}, ${y}`);
  await page.fill("#goal-height", String(START[2]));
  await takePicture(page, join(pictures, "page-goal.png"));
  await page.click("#goal-go");
  const goal = [x, y, START[2]];
  await observer.untilLast("the robot at its goal", "/simulator/status", (message) => distance(truth(message), goal) < 0.25);
  await observer.untilLast("the pause there", "/explorer/status", ({ state }) => state === PAUSED);
  say(`the robot is at the goal, ${distance(truth(observer.last.get("/simulator/status")), goal).toFixed(2)} m from it`);
}

async function killedExplorerShows(page, observer) {
  let explorer;
  await observer.until("the explorer's health", (topic, { service, process_id: id }) => topic === "/health" && service === "explorer" && (explorer = id));
  process.kill(explorer, "SIGKILL");
  await page.waitForSelector("#services [data-service=explorer].restarted", { timeout: WAIT.timeout });
  await page.waitForSelector(".toast.warn");
  await takePicture(page, join(pictures, "page-restarted.png"));
  await observer.until("the new explorer", (topic, { service, process_id: id }) => topic === "/health" && service === "explorer" && id !== explorer);
  say("an explorer that was killed shows as restarted");
  return truth(observer.last.get("/simulator/status"));
}

const browser = await launchBrowser(program);
const observer = await Observer.connect(url.replace("http:", "ws:"), ["/explorer/status", "/explorer/frontiers", "/simulator/status", "/health"]);
try {
  const page = await openPage(browser, { width: 1280, height: 720 });
  await looks(page);
  await rowsAreWhole(page);
  await pauseStops(page, observer);
  await themeAndHelp(page);
  await asksBeforeTheEnd(page, observer);
  const second = await reloadAndSecondPage(page, browser, observer);
  await savesTheMap(page);
  const { strategy } = observer.last.get("/explorer/status");
  await choosesStrategy(page, second, observer, "potential");
  await stepsByTheField(page, observer);
  await ignoresAFrontier(page, observer);
  await choosesStrategy(page, second, observer, strategy);
  const box = await drawBox(page, observer);
  await layersAreDrawn(page);
  await page.keyboard.press("d");
  await page.waitForSelector("#slice", { state: "hidden" });
  let nearest = Infinity;
  observer.watch("/simulator/status", (message) => (nearest = Math.min(nearest, outsideOf(box, truth(message)))));
  const flownBefore = observer.last.get("/simulator/status").distance_m;
  await sleepsAndWakes(second, page, observer);
  await second.close();
  await goesWhereClicked(page, observer);
  const flown = observer.last.get("/simulator/status").distance_m - flownBefore;
  check(flown > 2, `the robot went only ${flown} m since the box was drawn`);
  check(nearest > 0.8 * RADIUS, `the robot's center came within ${nearest} m of the box`);
  say(`the box is obeyed over ${flown.toFixed(1)} m; the robot's center stayed ${nearest.toFixed(2)} m from it`);
  await looksWhereClicked(page, observer);
  await clearsTheBox(page, observer);
  // A restarted explorer knows the path home to where it started again.
  const home = await killedExplorerShows(page, observer);
  await page.keyboard.press("h");
  await observer.untilLast("the end at home", "/explorer/status", ({ state }) => state === DONE);
  await hasState(page, "done");
  const stands = truth(observer.last.get("/simulator/status"));
  check(Math.min(distance(stands, home), distance(stands, START)) < 0.5, `the robot ended at ${stands}`);
  check((await page.textContent("#state")) === "Ended by the operator", `the page says ${await page.textContent("#state")}`);
  say("home: ended by the operator");
  check(errors.length === 0, `the page reports ${errors.join("; ")}`);
  check(outside.length === 0, `the page asks for ${outside.join(", ")}`);
} finally {
  await browser.close();
  observer.close();
}
