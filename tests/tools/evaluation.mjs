// Chromium opens the page of an evaluation from its file: verdict first, definitions last, curves with bands, the path
// from any start by a click, and nothing wider than the window.
import { chromium } from "playwright-core";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [file, program, pictures] = process.argv.slice(2);
const check = (condition, what) => {
  if (!condition) throw new Error(what);
};

const browser = await chromium.launch({ executablePath: program, args: ["--headless=new", "--no-sandbox"] });
try {
  for (const { width, height, scheme } of [{ width: 1280, height: 900, scheme: "light" }, { width: 400, height: 800, scheme: "dark" }]) {
    const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
    page.setDefaultTimeout(60_000);
    const errors = [], outside = [];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || outside.push(request.url()));
    await page.goto(pathToFileURL(file).href, { waitUntil: "load" });
    await page.waitForSelector(".paths polyline.path");
    const order = await page.evaluate(() => {
      const y = (selector) => document.querySelector(selector).getBoundingClientRect().top;
      return { verdict: y(".verdict"), curves: y(".chart"), last: [...document.querySelectorAll("main h2")].at(-1).textContent };
    });
    check(order.verdict < order.curves, "the verdict does not come first");
    check(order.last === "What the words mean", "definitions do not come last");
    check((await page.$$(".chart polygon.band")).length >= 2, "the curves have no bands");
    const styles = await page.evaluate(() => ({ band: Number(getComputedStyle(document.querySelector(".chart polygon.band")).opacity),
      left: document.querySelector(".verdict").getBoundingClientRect().left }));
    check(styles.band < 0.5 && styles.left >= 8, `the page is not styled: ${JSON.stringify(styles)}`);
    await page.screenshot({ path: join(pictures, `evaluation-${width}.png`) });

    const pathOf = () => page.getAttribute(".paths polyline.path", "points");
    const first = await pathOf();
    const starts = await page.$$(".start");
    check(starts.length > 1, `only ${starts.length} starts are listed`);
    await starts[1].click();
    await page.waitForFunction((before) => {
      const line = document.querySelector(".paths polyline.path");
      return line && line.getAttribute("points") !== before;
    }, first);
    const curve = () => page.getAttribute(".chart polyline.curve", "points");
    const label = () => page.textContent(".chart .label");
    const before = [await curve(), await label()];
    await page.click(".scenario-head button:nth-child(2)");
    check((await label()) !== before[1], "the curves do not change from distance to time");
    await page.screenshot({ path: join(pictures, `evaluation-${width}-full.png`), fullPage: true });
    await page.evaluate(() => document.querySelectorAll("details").forEach((each) => (each.open = true)));
    const wider = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    check(wider <= 0, `the page is ${wider} px wider than a window of ${width} px`);
    check(errors.length === 0, `the page reports ${errors.join("; ")}`);
    check(outside.length === 0, `the page asks for ${outside.join(", ")}`);
    console.log(`evaluation at ${width} px, ${scheme}: ${starts.length} starts, nothing wider than the window`);
    await page.close();
  }
} finally {
  await browser.close();
}
