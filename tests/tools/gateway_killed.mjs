// Chromium shows a live run whose gateway is killed and started again.
import { launchBrowser } from "./browser.mjs";
import { PAUSED, WAIT, errors, hasState, isNotPaused, kill, openPage, shown, until } from "./live_page.mjs";
import { LONG, Observer, check } from "./observer.mjs";

const [url, program] = process.argv.slice(2);
const say = (line) => console.log(`gateway_killed: ${line}`);
const connect = () => Observer.connect(url.replace("http:", "ws:"), ["/explorer/status", "/health"]);

/** A page that is open while its gateway is killed shows all that the next one knows, and steers as before. */
async function killedGatewayComesBack(page, observer) {
  await until(page, (state) => window.thalweg.state === state && window.thalweg.waiting === 0, PAUSED);
  const before = await shown(page);
  await kill(observer, "gateway");
  // The mark of a lost link is gone again within a second, which a busy page may not draw.
  await until(page, (session) => window.thalweg.session !== session, before.session);
  const another = await connect();
  await page.waitForSelector("#link.live");
  const isWhole = (its) => its.known >= before.known && its.occupied > 0.95 * before.occupied && its.frontiers > 0 &&
    its.state === before.state && its.noGo === before.noGo && its.waiting === 0 && its.steers;
  for (const end = Date.now() + LONG; ; ) {
    const now = await shown(page);
    if (isWhole(now)) break;
    check(Date.now() < end, `the page shows ${JSON.stringify(now)}, not ${JSON.stringify(before)}`);
    await page.waitForFunction((bytes) => window.thalweg.bytes > bytes, now.bytes, WAIT);
  }
  await hasState(page, "paused");
  await page.keyboard.press(" ");
  await another.untilLast("the run to go on", "/explorer/status", ({ state }) => state !== PAUSED);
  await isNotPaused(page);
  await page.keyboard.press(" ");
  await hasState(page, "paused");
  say("a page whose gateway was killed comes back whole, and steers");
  another.close();
}

const browser = await launchBrowser(program);
const observer = await connect();
try {
  const page = await openPage(browser, url, { width: 1280, height: 720 });
  await until(page, () => window.thalweg?.known > 60000 && window.thalweg.frontiers > 0);
  await page.keyboard.press(" ");
  await hasState(page, "paused");
  await killedGatewayComesBack(page, observer);
  check(errors.length === 0, `the page reports ${errors.join("; ")}`);
} finally {
  await browser.close();
  observer.close();
}
