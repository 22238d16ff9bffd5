// A page that shows a live run, opened in Chromium, and what its tests wait for.
import { LONG } from "./observer.mjs";

// [ms] A software renderer on a busy machine takes its time, so that conditions are not tested at each frame alone.
export const WAIT = { timeout: 2 * LONG, polling: 200 };
export const PAUSED = 5, DONE = 4, SET_ASIDE = 2, IGNORED = 6; // of thalweg_msgs
export const RADIUS = 0.1, FOV = 75; // [m], [deg] of the kitchen's robot, whose scenario leaves both to the defaults
export const START = [1.5, 4.7, 1.2]; // where it sets out

export const errors = []; // that pages reported
export const outside = []; // what they asked for that is not the gateway's
export async function openPage(browser, url, viewport) {
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
export const until = (page, condition, argument = null) => page.waitForFunction(condition, argument, WAIT);
export const shown = (page) => page.evaluate(() => window.thalweg);
export const hasState = (page, state) => page.waitForFunction((its) => document.documentElement.dataset.state === its, state, WAIT);

/** So many health messages of the simulator, which sends one a second. */
export async function heardSeconds(observer, count) {
  let heard = 0;
  await observer.until(`${count} s`, (topic, { service }) => topic === "/health" && service === "simulator" && ++heard === count);
}

/** Not when the explorer is not heard either, as at first of a gateway that was just started. */
export const isNotPaused = (page) => page.waitForFunction(() => !["paused", "absent"].includes(document.documentElement.dataset.state), null, WAIT);

/** Kills a service, and returns the id that its process had. */
export async function kill(observer, name) {
  const id = await observer.until(`the ${name}'s health`, (topic, { service, process_id: id }) => topic === "/health" && service === name && id);
  process.kill(id, "SIGKILL");
  return id;
}
