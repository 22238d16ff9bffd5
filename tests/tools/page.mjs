// Chromium shows the page of a live run: the map and the frontiers grow, keys work, a reload keeps the picture.
import { chromium } from "playwright-core";
import { join } from "node:path";

const [url, program, pictures] = process.argv.slice(2);
const WAIT = { timeout: 200_000 }; // [ms] a software renderer on a busy machine takes its time
const check = (condition, what) => {
  if (!condition) throw new Error(what);
};

const browser = await chromium.launch({
  executablePath: program,
  args: ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader-webgl", "--enable-unsafe-swiftshader",
    "--disable-gpu-rasterization"],
});
/** A screenshot, for which the page stops drawing: a software renderer might otherwise never come to it. */
async function takePicture(page, name) {
  await page.evaluate(() => {
    window.nextFrame = window.requestAnimationFrame;
    window.requestAnimationFrame = (frame) => ((window.waiting = frame), 0);
  });
  await page.screenshot({ path: join(pictures, name) });
  await page.evaluate(() => {
    window.requestAnimationFrame = window.nextFrame;
    window.requestAnimationFrame(window.waiting);
  });
}

try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 780 } });
  page.setDefaultTimeout(WAIT.timeout);
  const errors = [];
  page.on("pageerror", (error) => errors.push(error.message));
  const outside = [];
  page.on("request", (request) => {
    if (!request.url().startsWith(url) && !request.url().startsWith("data:")) outside.push(request.url());
  });
  await page.goto(url, { waitUntil: "commit" });
  await page.waitForFunction(() => window.thalweg?.known > 1000 && window.thalweg.faces > 100 && window.thalweg.flown > 1, null, WAIT);
  const first = await page.evaluate(() => window.thalweg);
  await page.waitForFunction((known) => window.thalweg.known > known, first.known, WAIT);
  await page.waitForFunction(() => document.querySelectorAll("#services .row").length >= 4, null, WAIT);
  await page.waitForFunction(() => document.querySelectorAll("#frontiers button").length > 0, null, WAIT);
  // In one step, since the next plan may forget the frontier.
  const why = await page.evaluate(() => {
    document.querySelector("#frontiers button").click();
    return document.getElementById("why-card").hidden ? "" : document.getElementById("why").textContent;
  });
  check(why.includes("Unknown voxels"), "a click on a frontier does not say why");
  await takePicture(page, "page-1.png");
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  const before = await theme();
  await page.keyboard.press("t");
  check((await theme()) !== before, "T does not change the theme");
  await takePicture(page, "page-2.png");
  await page.keyboard.press("?");
  check(await page.isVisible("#help"), "? shows no help");
  await page.keyboard.press("?");
  const flown = (await page.evaluate(() => window.thalweg)).flown;
  await page.reload({ waitUntil: "commit" });
  await page.waitForFunction((before) => window.thalweg?.flown >= before && window.thalweg.faces > 100, flown, WAIT);
  check(errors.length === 0, `the page reports ${errors.join("; ")}`);
  check(outside.length === 0, `the page asks for ${outside.join(", ")}`);
  const { known, occupied, faces } = await page.evaluate(() => window.thalweg);
  console.log(`page: ${known} voxels known, ${occupied} occupied, ${faces} faces; reload keeps the path flown`);
} finally {
  await browser.close();
}
