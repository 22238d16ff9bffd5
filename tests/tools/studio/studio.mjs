// Foxglove Studio in Chromium shows a live run: all channels, the map, the path, the robot and an image.
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { chromium } from "playwright-core";
import { Observer } from "../observer.mjs";

const [gateway, port, program, picture] = process.argv.slice(2);
const LONG = 240_000; // [ms] Studio is 56 MB of script, and the renderer is software
const FOLDER = new URL(".", import.meta.url).pathname;
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json", ".wasm": "application/wasm", ".png": "image/png" };

/** Serves this folder, and below it the installed packages, to this machine. */
const server = createServer(async ({ url }, response) => {
  const path = normalize(new URL(url, "http://localhost").pathname);
  const own = ["/index.html", "/layout.json"].includes(path);
  try {
    const content = await readFile(join(FOLDER, own ? "." : "node_modules", path));
    response.writeHead(200, { "Content-Type": TYPES[extname(path)] ?? "application/octet-stream" }).end(content);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((resolve) => server.listen(Number(port), "127.0.0.1", resolve));

const browser = await chromium.launch({
  executablePath: program,
  args: ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader-webgl", "--enable-unsafe-swiftshader",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"],
});

/** Pixels of a screenshot, counted by what they show. */
async function count(page, png) {
  return page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height), context = canvas.getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const found = { pixels: data.length / 4, path: 0, robot: 0, low: 0, high: 0 }, grays = new Set();
    for (let n = 0; n < data.length; n += 4) {
      const [r, g, b] = [data[n], data[n + 1], data[n + 2]];
      if (r > 120 && b > 120 && g < 60 && Math.abs(r - b) < 40) ++found.path; // magenta
      else if (g > 150 && r < 150 && b < 60 && r > 60) ++found.robot; // the y axis of its frame, in Studio's green
      else if (b > 90 && r < 70 && g < 90) ++found.low; // the floor's blue
      else if (r > 140 && g > 90 && b < 120) ++found.high; // the yellow and orange of what is high
      if (Math.abs(r - g) < 6 && Math.abs(g - b) < 6) grays.add(r);
    }
    return { ...found, grays: grays.size };
  }, png.toString("base64"));
}

/** Repeats until all conditions hold of the counts of an element's screenshot. */
async function until(page, element, wanted) {
  for (const end = Date.now() + LONG; ; ) {
    const seen = await count(page, await element.screenshot());
    const missing = Object.entries(wanted).filter(([what, holds]) => !holds(seen)).map(([what]) => what);
    if (missing.length === 0) return seen;
    if (Date.now() > end) {
      await page.screenshot({ path: picture });
      throw new Error(`not drawn: ${missing.join(", ")}; counted ${JSON.stringify(seen)}`);
    }
  }
}

/** What stands in Studio's tab of problems: with schemas, with messages that it cannot read, with the protocol. */
async function problemsOf(page) {
  const tab = page.getByRole("tab", { name: /^Problems/ });
  await tab.click();
  return tab.evaluate((button) => {
    // Without the names of the tabs and the count of problems.
    const below = ({ innerText }) => innerText.split("\n").filter((line) => !/^(Topics|Problems|\d+)$/.test(line)).join("; ");
    let element = button;
    while (below(element) === "") element = element.parentElement;
    return below(element);
  });
}

// Studio takes its time to start: the robot waits, so that there is something left to explore.
const observer = await Observer.connect(gateway, ["/explorer/status"]);
await observer.untilLast("a plan", "/explorer/status", ({ plans }) => plans > 0);
if (!(await observer.call("pause")).accepted) throw new Error("the run cannot be paused");

try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 1400 } });
  page.setDefaultTimeout(LONG);
  page.on("pageerror", (error) => console.error(`studio reports ${error.message}`));
  await page.goto(`http://localhost:${port}/index.html?ds=foxglove-websocket&ds.url=${encodeURIComponent(gateway)}`);

  // Every channel that the gateway offers stands in Studio's list.
  const offered = await page.evaluate((address) => new Promise((resolve, reject) => {
    const socket = new WebSocket(address, ["foxglove.websocket.v1"]);
    socket.onerror = () => reject(new Error("the gateway does not answer"));
    socket.onmessage = ({ data }) => {
      const message = typeof data === "string" ? JSON.parse(data) : {};
      if (message.op !== "advertise") return;
      socket.close();
      resolve(message.channels.map(({ topic }) => topic));
    };
  }), gateway);
  await page.waitForFunction((topics) => topics.every((topic) => document.body.innerText.includes(topic)), offered, { timeout: LONG });
  const listed = await page.evaluate((topics) => {
    const words = new Set(document.body.innerText.split(/\s+/));
    return topics.filter((topic) => words.has(topic)).length;
  }, offered);
  if (listed !== offered.length) throw new Error(`${listed} of ${offered.length} channels are listed`);

  const [map, image] = [page.locator("canvas").first(), page.locator("canvas").nth(1)];
  await until(page, map, {
    "the floor": ({ low, pixels }) => low > pixels / 100,
    "what is high": ({ high, pixels }) => high > pixels / 1000,
  });
  const left = await until(page, image, { "an image of many grays": ({ grays }) => grays > 60 });
  if (!(await observer.call("resume")).accepted) throw new Error("the run cannot be resumed");
  const flight = await until(page, map, { "the path": ({ path }) => path > 30 });
  const drawn = await until(page, map, { "the robot": ({ robot }) => robot > 30 });
  await page.screenshot({ path: picture });
  const problems = await problemsOf(page);
  if (problems !== "No problems found") throw new Error(`Studio has problems with the gateway: ${problems}`);
  console.log(`studio: ${listed} channels listed; drawn: ${drawn.low + drawn.high} pixels of map, ${flight.path} of path, ` +
    `${drawn.robot} of robot, an image of ${left.grays} grays`);
} finally {
  await browser.close();
  observer.close();
  server.close();
  server.closeAllConnections();
}
