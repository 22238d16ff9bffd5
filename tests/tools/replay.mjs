// Chromium steers a replay from the gateway's page: the time line is dragged, and map, robot, path and log follow.
import { launchBrowser, takePicture } from "./browser.mjs";
import { join } from "node:path";
import { LONG, Observer, check, distance, seconds } from "./observer.mjs";

const [url, program, pictures] = process.argv.slice(2);
const WAIT = { timeout: 2 * LONG, polling: 200 };
const say = (line) => console.log(`replay: ${line}`);
const SLACK = 0.5; // [s] by which the page's last look at the replay may be old

const errors = [];
const browser = await launchBrowser(program);
const observer = await Observer.connect(url.replace("http:", "ws:"), ["/replay/status", "/odometry", "/map/updates"]);
const page = await browser.newPage({ viewport: { width: 1440, height: 810 } });
page.setDefaultTimeout(WAIT.timeout);
page.on("pageerror", (error) => errors.push(error.message));
page.on("console", (message) => message.type() === "error" && errors.push(message.text()));

const until = (condition, argument = null) => page.waitForFunction(condition, argument, WAIT);
/** What the page shows, by its second account of itself from now on: one may be half old. */
async function look() {
  for (let n = 0; n < 2; ++n) {
    await page.evaluate(() => (window.thalweg = null));
    await until(() => window.thalweg !== null);
  }
  return page.evaluate(() => window.thalweg);
}

/** Drags the time line to a share of its length. Returns the time there [s], as the page says it before the release. */
async function dragTo(share) {
  const box = await page.locator("#replay-seek").boundingBox();
  const y = box.y + box.height / 2, x = (at) => box.x + 7 + at * (box.width - 14);
  const { replay } = await page.evaluate(() => window.thalweg);
  await page.mouse.move(x(replay.now / replay.length), y);
  await page.mouse.down();
  await page.mouse.move(x((share + 0.5) / 2), y);
  await page.mouse.move(x(share), y);
  const wanted = Number(await page.inputValue("#replay-seek"));
  check(await page.isVisible("#replay-hint"), "no time is shown while the line is dragged");
  await page.mouse.up();
  await observer.untilLast(`the replay at ${wanted} s`, "/replay/status", ({ now, begin, paused }) =>
    paused && Math.abs(seconds(now) - seconds(begin) - wanted) < 1e-3);
  check(Math.abs(wanted / replay.length - share) < 0.02, `dragging to ${share} meets ${wanted} of ${replay.length} s`);
  await page.mouse.move(10, 300);
  return wanted;
}

try {
  // The replay waits; it plays once while an observer notes where the robot is when, and pauses at its end.
  const track = []; // [log time since the beginning, position]
  let now = null, begin = null;
  observer.watch("/replay/status", (message) => {
    begin = seconds(message.begin);
    now = seconds(message.now) - begin;
  });
  const unwatch = observer.watch("/odometry", ({ pose }) => now !== null && track.push([now, Object.values(pose.pose.position)]));
  await page.goto(url, { waitUntil: "commit" });
  await page.waitForSelector("#timeline:not([hidden])");
  check(await page.isHidden("#dock"), "a robot that is only replayed can be steered");
  check(await page.isVisible("#replayed"), "the page does not say that this is a replay");
  const playing = observer.until("that it plays", (topic, message) => topic === "/replay/status" && !message.paused);
  await page.keyboard.press(" ");
  await playing;
  await observer.untilLast("the replay's end", "/replay/status", ({ paused }) => paused);
  unwatch();
  await until(() => window.thalweg?.known > 1000 && window.thalweg.replay?.paused);
  let last;
  do {
    last = (await look()).known;
  } while ((await look()).known !== last);
  const end = await look();
  const { length } = end.replay;
  check(Math.abs(end.replay.now - length) < 1e-6, `it stands at ${end.replay.now} of ${length} s`);
  check(end.flown > 3 && end.frontiers >= 0, `the path flown has ${end.flown} points`);
  await takePicture(page, join(pictures, "replay-end.png"));
  say(`at the end, after ${length.toFixed(1)} s, ${end.known} voxels are known`);

  const near = (at, position) => Math.min(...track.filter(([time]) => Math.abs(time - at) < SLACK + 0.3).map(([, place]) => distance(place, position)));
  let before = end;
  for (const share of [0.3, 0.7, 0.5]) {
    const at = await dragTo(share);
    const grows = share > before.replay.now / length;
    await until(([known, more]) => window.thalweg && (more ? window.thalweg.known > known : window.thalweg.known < known), [before.known, grows]);
    const shown = await look();
    check(shown.replay.paused && Math.abs(shown.replay.now - at) < 1e-3, `the page shows ${JSON.stringify(shown.replay)}, not ${at} s`);
    check(near(at, shown.robot) < 0.05, `at ${at} s the robot is shown at ${shown.robot}`);
    const later = await page.evaluate(() => document.querySelectorAll("#log .line").length);
    check(later > 0, "no log line is left");
    say(`at ${at.toFixed(1)} s: ${shown.known} voxels, the robot where it was`);
    before = shown;
  }
  await takePicture(page, join(pictures, "replay.png"));
  // The curves still have what was seen before, and no more: the robot's way was watched from the beginning to the end.
  const seen = ({ pieces }) => pieces.reduce((sum, [first, last]) => sum + last - first, 0);
  check(Math.abs(seen(before.curves) - seen(end.curves)) < 1, `of ${seen(end.curves)} s that were seen the curves have ${seen(before.curves)}`);
  check(before.curves.now < end.curves.now - 1, `now is ${before.curves.now} for the curves, at the end it was ${end.curves.now}`);

  // Keys and the menu.
  await page.keyboard.press("Home");
  await observer.untilLast("the beginning", "/replay/status", (status) => seconds(status.now) === seconds(status.begin));
  await until(() => window.thalweg?.known === 0);
  await page.selectOption("#replay-rate", "5");
  await observer.untilLast("rate 5", "/replay/status", ({ rate }) => rate === 5);
  await until(() => window.thalweg?.replay?.rate === 5);
  await page.keyboard.press("-");
  await observer.untilLast("rate 2", "/replay/status", ({ rate }) => rate === 2);
  await page.keyboard.press("k");
  // The recording may be shorter, on a fast machine.
  await observer.untilLast("a place 5 s later", "/replay/status",
    ({ begin, end, now }) => Math.abs(seconds(now) - Math.min(seconds(begin) + 5, seconds(end))) < 1e-3);
  await page.keyboard.press("t");
  // From the beginning and slowly, so that it does not come to its end, and pause there, before it is paused here.
  await page.keyboard.press("Home");
  await observer.untilLast("the beginning", "/replay/status", (status) => seconds(status.now) === seconds(status.begin));
  await page.selectOption("#replay-rate", "0.25");
  await observer.untilLast("rate 0.25", "/replay/status", ({ rate }) => rate === 0.25);
  await page.locator("#replay-rate").blur();
  await page.keyboard.press(" ");
  await observer.untilLast("that it goes on", "/replay/status", ({ paused }) => !paused);
  await until(() => window.thalweg?.known > 0);
  await page.keyboard.press(" ");
  await observer.untilLast("the pause", "/replay/status", ({ paused }) => paused);
  await takePicture(page, join(pictures, "replay-light.png"));
  await page.keyboard.press("t");
  say("keys seek, pause and change the rate");

  // A program does the same, and the reply says why not.
  const accepted = await observer.call("/replay/seek", { time_s: 0.25 * length });
  check(accepted.accepted && accepted.service === "replay" && accepted.reason.includes("paused at"), JSON.stringify(accepted));
  for (const [service, request, word] of [["/replay/seek", { time_s: length + 1 }, "must be 0 to"], ["/replay/rate", { rate: 0 }, "must be 0.001 to 1000"],
    ["/replay/seek", {}, "time_s"]]) {
    const refused = await observer.call(service, request);
    check(!refused.accepted && refused.reason.includes(word), `${service} ${JSON.stringify(request)}: ${JSON.stringify(refused)}`);
  }
  // A page that is opened now shows what is true now.
  const here = await look();
  await page.reload({ waitUntil: "commit" });
  await until((known) => window.thalweg?.known === known && window.thalweg.robot !== null, here.known);
  const again = await look();
  check(again.robot && distance(again.robot, here.robot) < 1e-6, `after a reload the robot is at ${again.robot}, not ${here.robot}`);
  say("services answer; a reload keeps the picture");
  // It has not seen what is skipped now: the curves have a gap there, and what was known stays.
  await dragTo(0.8);
  await until((known) => window.thalweg?.known > known, again.known);
  const { curves } = await look(), gaps = curves.pieces.slice(1).map(([first], n) => first - curves.pieces[n][1]);
  check(gaps.length > 0 && Math.max(...gaps) > 0.4 * again.replay.length, `after a jump from a quarter to 0.8 of ${again.replay.length} s, the gaps of the curves are ${gaps} s`);
  check(curves.pieces.at(-1)[1] === curves.now && seen(curves) <= seen(again.curves) + 1, `the curves are ${JSON.stringify(curves)}, before ${JSON.stringify(again.curves)}`);
  await takePicture(page, join(pictures, "replay-gap.png"));
  say(`a jump ahead leaves a gap of ${Math.max(...gaps).toFixed(1)} s in the curves`);
  check(errors.length === 0, `the page reports ${errors.join("; ")}`);
} finally {
  await browser.close();
  observer.close();
}
