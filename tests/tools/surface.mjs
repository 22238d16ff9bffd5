// Chromium shows the mesh of a live run's surface; a page that is opened late has the whole of it.
import { launchBrowser, takePicture } from "./browser.mjs";
import { join } from "node:path";
import { LONG, Observer, check } from "./observer.mjs";

const [url, program, pictures] = process.argv.slice(2);
// [ms] A software renderer on a busy machine takes its time, so that conditions are not tested at each frame alone.
const WAIT = { timeout: 2 * LONG, polling: 200 };
const say = (line) => console.log(`surface: ${line}`);
const errors = [];
const until = (page, condition, argument = null) => page.waitForFunction(condition, argument, WAIT);

async function openPage(browser, viewport) {
  const page = await browser.newPage({ viewport });
  page.setDefaultTimeout(WAIT.timeout);
  page.on("pageerror", (error) => errors.push(error.message));
  await page.goto(url, { waitUntil: "commit" });
  return page;
}
/** Turns to the mesh, from the voxels. */
async function showMesh(page) {
  await until(page, () => window.thalweg?.known > 1000 && !document.getElementById("surface-card").hidden);
  await page.keyboard.press("y");
  await until(page, () => window.thalweg.layers.surface && !window.thalweg.layers.map);
}

const observer = await Observer.connect(url.replace("http:", "ws:"), ["/health"]);
let simulator = null;
const browser = await launchBrowser(program);
try {
  const page = await openPage(browser, { width: 1400, height: 860 });
  await until(page, () => window.thalweg?.known > 1000);
  check(await page.evaluate(() => window.thalweg.surface) === 0, "a mesh came that nobody asked for");
  await showMesh(page);
  await until(page, () => window.thalweg.surface > 50000 && window.thalweg.surfaceDrawn > 20);
  const seen = await page.textContent("#surface-card");
  check(/Seen\d+\.\d m²/.test(seen), `the card says "${seen}"`);
  const before = await page.evaluate(() => window.thalweg.surface);
  await until(page, (faces) => window.thalweg.surface > faces, before);
  say(`the mesh of ${before} faces grows`);

  // Each cloud moves vertices a little and may split or join a triangle, also where the robot stands: for two pages to
  // show the same, the simulator is stopped, too.
  await until(page, () => Number(/([\d.]+) m²/.exec(document.getElementById("surface-card").textContent)[1]) > 220);
  await page.keyboard.press(" ");
  await until(page, () => window.thalweg.state === 5);
  await observer.until("the simulator's health", (topic, { service, process_id: id }) => topic === "/health" && service === "simulator" && (simulator = id));
  process.kill(simulator, "SIGSTOP");
  const late = await openPage(browser, { width: 500, height: 400 });
  await showMesh(late);
  const faces = (its) => its.evaluate(() => window.thalweg.surface);
  const end = Date.now() + WAIT.timeout;
  for (let both = [0, 1]; both[0] !== both[1] || both[0] < before; both = [await faces(page), await faces(late)]) {
    check(Date.now() < end, `the late page does not get the same mesh: ${both.join(" and ")} faces`);
    await page.waitForTimeout(WAIT.polling);
  }
  process.kill(simulator, "SIGCONT");
  await late.close();
  say("a page that is opened late has it whole");

  await page.keyboard.press("f");
  await takePicture(page, join(pictures, "surface_mesh.png"));
  await page.keyboard.press("v");
  await takePicture(page, join(pictures, "surface_inspected.png"));
  await page.keyboard.press("y");
  await until(page, () => window.thalweg.layers.map && !window.thalweg.layers.surface);
  check(errors.length === 0, `the page reports errors: ${errors.join("; ")}`);
} finally {
  if (simulator) process.kill(simulator, "SIGCONT");
  await browser.close();
  observer.close();
}
