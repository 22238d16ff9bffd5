// Chromium steers a live run from the gateway's page. A second client, which sees the truth, watches what comes of it.
import { launchBrowser, takePicture } from "./browser.mjs";
import { join } from "node:path";
import WebSocket from "ws";
import { DONE, FOV, PAUSED, RADIUS, START, WAIT, errors, hasState, heardSeconds, isNotPaused, kill, openPage, outside, shown, until } from "./live_page.mjs";
import { LONG, Observer, check, distance, seconds, truth } from "./observer.mjs";

const [url, program, pictures] = process.argv.slice(2);
const say = (line) => console.log(`page: ${line}`);

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
  // The last line stays in view, though the panels above it grow.
  await page.waitForFunction(() => {
    const log = document.getElementById("log");
    return log.scrollHeight > log.clientHeight + 100 && log.scrollHeight - log.scrollTop - log.clientHeight < 24;
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

/** What a service refuses stands in its row, with the reason. */
async function refusalsShow(page) {
  const socket = new WebSocket(url.replace("http:", "ws:"), ["foxglove.sdk.v1"]);
  await new Promise((resolve, reject) => socket.on("open", resolve).on("error", reject));
  for (let n = 0; n < 3; ++n) socket.send("{");
  await page.waitForSelector("#services [data-service=gateway] .tag.warn:has-text('3 rejected')");
  const note = await page.textContent("#services [data-service=gateway] .note");
  check(note.includes("the frame is not a JSON object"), `the gateway's row says ${note}`);
  socket.close();
  say("what a service refuses stands in its row, with the reason");
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
  check((await page.evaluate(() => document.getElementById("help").scrollTop)) === 0, "the help does not begin with its first line");
  const lines = await page.locator("#keys dd").count();
  check(lines > 20, `the help has ${lines} lines`);
  await page.keyboard.press("?");
  check(!(await page.isVisible("#help")), "? does not end the help");
}

/** In the dialogs that ask before an end, the keys are the dialog's: the run is neither paused, resumed nor ended. */
async function asksBeforeTheEnd(page, observer) {
  for (const [end, dialog] of [["x", "#stop-dialog"], ["h", "#home-dialog"]]) {
    const open = () => page.evaluate((its) => document.querySelector(its).open, dialog);
    for (const [key, focus] of [["Escape", "danger"], ["Enter", "plain:not(.danger)"], [" ", "plain:not(.danger)"]]) {
      await page.keyboard.press(end);
      check(await open(), `"${end}" does not ask`);
      await page.focus(`${dialog} button.${focus}`);
      await page.keyboard.press(key);
      check(!(await open()), `"${key}" does not close the dialog`);
    }
  }
  await heardSeconds(observer, 2); // in which a command would have taken effect
  check(observer.last.get("/explorer/status").state === PAUSED, "keys in the dialog change the state of the run");
  say("the dialogs before an end have their keys for themselves");
}

/** The picture after a reload is that of before; a second page shows the same, and steers as well. */
async function reloadAndSecondPage(page, browser, observer) {
  const before = await shown(page);
  await page.reload({ waitUntil: "commit" });
  const same = (its) => window.thalweg?.flown >= its.flown && window.thalweg.known >= its.known && window.thalweg.state === its.state;
  await until(page, same, before);
  const second = await openPage(browser, url, { width: 900, height: 620 });
  await until(second, same, before);
  await second.click("#do-pause"); // which resumes
  await observer.untilLast("the run to go on", "/explorer/status", ({ state }) => state !== PAUSED);
  await isNotPaused(page);
  await page.keyboard.press(" ");
  for (const each of [page, second]) await hasState(each, "paused");
  say("a reload keeps the picture; two pages show and steer one run");
  return second;
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
const CLEAR = 0.8 * RADIUS; // [m] of its center from the box
const outsideOf = ([min, max], p) => Math.hypot(...p.map((c, k) => Math.max(min[k] - c, 0, c - max[k])));

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
  const explorer = await kill(observer, "explorer");
  await page.waitForSelector("#services [data-service=explorer].restarted", { timeout: WAIT.timeout });
  await page.waitForSelector(".toast.warn");
  await takePicture(page, join(pictures, "page-restarted.png"));
  await observer.until("the new explorer", (topic, { service, process_id: id }) => topic === "/health" && service === "explorer" && id !== explorer);
  say("an explorer that was killed shows as restarted");
  return truth(observer.last.get("/simulator/status"));
}

const browser = await launchBrowser(program);
const observer = await Observer.connect(url.replace("http:", "ws:"), ["/explorer/status", "/simulator/status", "/health"]);
try {
  const page = await openPage(browser, url, { width: 1280, height: 720 });
  await looks(page);
  await rowsAreWhole(page);
  await refusalsShow(page);
  await pauseStops(page, observer);
  await themeAndHelp(page);
  await asksBeforeTheEnd(page, observer);
  const second = await reloadAndSecondPage(page, browser, observer);
  const box = await drawBox(page, observer);
  const drawn = observer.last.get("/simulator/status");
  let nearest = null; // since it was clear of the box: on a slow machine it may have flown to where the box is drawn
  observer.watch("/simulator/status", (message) => {
    const m = outsideOf(box, truth(message));
    if (nearest ? m < nearest.m : m > CLEAR) nearest = { m, at: truth(message), flown: message.distance_m - drawn.distance_m };
  });
  await sleepsAndWakes(second, page, observer);
  await second.close();
  await goesWhereClicked(page, observer);
  const flown = observer.last.get("/simulator/status").distance_m - drawn.distance_m;
  check(flown > 2, `the robot went only ${flown} m since the box was drawn`);
  check(nearest?.m > CLEAR, `the robot, which was at ${truth(drawn)}, came near the box: ${JSON.stringify(nearest)}`);
  say(`the box is obeyed over ${flown.toFixed(1)} m; the robot's center stayed ${nearest.m.toFixed(2)} m from it`);
  // A restarted explorer knows the path home to where it started again.
  const home = await killedExplorerShows(page, observer);
  await page.keyboard.press("h");
  await page.click("#home-dialog button.danger");
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
