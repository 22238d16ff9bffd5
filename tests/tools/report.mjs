// Chromium opens the report of a run from its file: the map draws, the slider and a click on a decision move the robot,
// play plays, nothing is wider than the window, and nothing is asked for over a network.
import { chromium } from "playwright-core";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [file, program, pictures] = process.argv.slice(2);
const WAIT = { timeout: 120_000 }; // [ms] a software renderer on a busy machine takes its time
const check = (condition, what) => {
  if (!condition) throw new Error(what);
};

const browser = await chromium.launch({
  executablePath: program,
  args: ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader-webgl", "--enable-unsafe-swiftshader",
    "--disable-gpu-rasterization"],
});

const state = (page) => page.evaluate(() => window.thalweg);
const stateWhere = (page, condition, argument) => page.waitForFunction(condition, argument, WAIT);
const widerThanWindow = (page) => page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
const apart = (a, b) => Math.hypot(...a.map((c, k) => c - b[k]));

/** How many different colors the 3D view shows; one means that nothing is drawn. */
const colors = (page) => page.evaluate(() => new Promise((resolve) => {
  requestAnimationFrame(() => {
    const view = document.getElementById("view"), copy = document.createElement("canvas");
    copy.width = copy.height = 64;
    window.dispatchEvent(new Event("resize")); // draws in the next frame
    requestAnimationFrame(() => {
      const context = copy.getContext("2d");
      context.drawImage(view, 0, 0, 64, 64);
      const pixels = new Uint32Array(context.getImageData(0, 0, 64, 64).data.buffer);
      resolve(new Set(pixels).size);
    });
  });
}));

const setSlider = (page, share) => page.evaluate((value) => {
  const slider = document.getElementById("slider");
  slider.value = value;
  slider.dispatchEvent(new Event("input"));
}, Math.round(10000 * share));

try {
  for (const { width, height, scheme } of [{ width: 1280, height: 900, scheme: "dark" }, { width: 400, height: 800, scheme: "light" }]) {
    const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
    page.setDefaultTimeout(WAIT.timeout);
    const errors = [], outside = [];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || outside.push(request.url()));
    const broken = new Promise((_, reject) => page.once("pageerror", ({ message }) => reject(new Error(`the page reports ${message}`))));
    broken.catch(() => {}); // what is reported later is checked at the end
    await page.goto(pathToFileURL(file).href, { waitUntil: "load" });
    await Promise.race([broken, stateWhere(page, () => window.thalweg?.faces > 100 && window.thalweg.charts >= 4)]);
    const atEnd = await state(page);
    check((await page.evaluate(() => document.documentElement.dataset.theme)) === scheme, "the page does not follow the system's scheme");
    check((await colors(page)) > 20, "the 3D view is empty");
    await page.screenshot({ path: join(pictures, `report-${width}.png`) });
    const layout = await page.evaluate(() => ({
      overflow: getComputedStyle(document.body).overflowY, view: document.getElementById("view").getBoundingClientRect().height,
      page: document.documentElement.scrollHeight, window: window.innerHeight }));
    check(layout.overflow !== "hidden" && layout.page > layout.window, `the page cannot be scrolled: ${JSON.stringify(layout)}`);
    check(layout.view < 0.9 * layout.window, `the 3D view covers the window: ${JSON.stringify(layout)}`);
    await page.screenshot({ path: join(pictures, `report-${width}-full.png`), fullPage: true });

    await setSlider(page, 0.3);
    await stateWhere(page, (end) => window.thalweg.time < 0.4 * end, atEnd.time);
    const earlier = await state(page);
    check(apart(earlier.robot, atEnd.robot) > 0.01, "the slider does not move the robot");
    check(earlier.now < 255, "the slider does not take the map back");
    await page.screenshot({ path: join(pictures, `report-${width}-earlier.png`) });

    const decisions = await page.$$eval("tr.pick", (rows) => rows.length);
    check(decisions > 3, `only ${decisions} decisions are listed`);
    await page.evaluate(() => document.querySelectorAll("tr.pick")[1].click());
    await stateWhere(page, (before) => window.thalweg.time !== before, earlier.time);
    check((await page.textContent("#decision")).startsWith("Plan "), "a click on a decision does not show it");

    const { time: before } = await state(page);
    await page.evaluate(() => document.getElementById("play").click());
    await stateWhere(page, (start) => window.thalweg.time > start, before);
    await page.evaluate(() => document.getElementById("play").click());

    const wider = await widerThanWindow(page);
    check(wider <= 0, `the page is ${wider} px wider than a window of ${width} px`);
    check(errors.length === 0, `the page reports ${errors.join("; ")}`);
    check(outside.length === 0, `the page asks for ${outside.join(", ")}`);
    console.log(`report at ${width} px, ${scheme}: ${atEnd.faces} faces, ${decisions} decisions, ${atEnd.charts} charts`);
    await page.close();
  }
} finally {
  await browser.close();
}
