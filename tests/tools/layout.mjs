// How the panels of the gateway's page lie on windows of several sizes.
import { takePicture } from "./browser.mjs";
import { join } from "node:path";
import { WAIT } from "./live_page.mjs";
import { check } from "./observer.mjs";

const say = (line) => console.log(`controls: ${line}`);

/** The rectangles of what can be seen of these: selector -> { left, top, right, bottom } */
const boxesOf = (page, selectors) => page.evaluate((all) => Object.fromEntries(all.map((its) => [its, document.querySelector(its)])
  .filter(([, element]) => element?.checkVisibility()).map(([its, element]) => [its, element.getBoundingClientRect().toJSON()])), selectors);

/** Pairs of these that lie on each other, and those that reach out of the window. */
export async function conflicts(page, selectors) {
  const { width, height } = page.viewportSize();
  const boxes = Object.entries(await boxesOf(page, selectors));
  const outside = boxes.filter(([, { left, top, right, bottom }]) => left < 0 || top < 0 || right > width || bottom > height).map(([its]) => `${its} reaches out of the window`);
  const pairs = boxes.flatMap(([one, a], n) => boxes.slice(n + 1)
    .filter(([, b]) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom).map(([other]) => `${one} lies on ${other}`));
  return [...outside, ...pairs];
}

const PANELS = [".bar", ".tools > .segments", "#layers", "#cut-card", "#slice", "#dock", "#pictures", "#legend", ".side"];

/** With all panels open none lies on another one; that of images takes one line as long as there are none. */
export async function panelsAreApart(page, pictures) {
  const before = page.viewportSize();
  await page.keyboard.press("c");
  await page.waitForFunction(() => document.getElementById("picture-info").textContent === "no images in this run", null, WAIT);
  for (const viewport of [{ width: 1280, height: 720 }, { width: 1920, height: 1080 }]) {
    await page.setViewportSize(viewport);
    const size = `${viewport.width} x ${viewport.height}`, boxes = await boxesOf(page, PANELS);
    check(Object.keys(boxes).length === PANELS.length, `at ${size} only ${Object.keys(boxes)} can be seen`);
    check(boxes["#pictures"].height < 45, `without images their panel is ${boxes["#pictures"].height} pixels high`);
    const found = await conflicts(page, PANELS);
    // As high as it is with a square image, which is more than those of our cameras need.
    await page.evaluate(() => {
      const canvas = document.getElementById("picture");
      canvas.width = canvas.height = 300;
      document.getElementById("pictures").classList.remove("waits");
    });
    found.push(...(await conflicts(page, PANELS)).map((each) => `with an image ${each}`));
    await takePicture(page, join(pictures, `page-panels-${viewport.width}.png`));
    await page.evaluate(() => document.getElementById("pictures").classList.add("waits"));
    check(found.length === 0, `at ${size}: ${found.join(", ")}`);
  }
  await page.setViewportSize(before);
  await page.keyboard.press("c");
  say("the panels lie beside each other at 1280 x 720 and 1920 x 1080; without images theirs is one line");
}

/** On a phone the map and the commands are in view, and all panels in one drawer that scrolls. @param command sends one by its button */
export async function drawerFitsAPhone(page, pictures, command) {
  const before = page.viewportSize();
  await page.setViewportSize({ width: 390, height: 844 });
  const fixed = [".bar", ".tools > .segments", "#dock", ".side"];
  const height = (box) => box.bottom - box.top;
  for (const isOpen of [false, true]) {
    if (isOpen) await page.click("#drawer-handle");
    check((await page.getAttribute("#drawer-handle", "aria-expanded")) === String(isOpen), `the drawer says it is open: ${!isOpen}`);
    const boxes = await boxesOf(page, fixed), found = await conflicts(page, fixed);
    check(Object.keys(boxes).length === fixed.length && found.length === 0, `on a phone: ${found.join(", ")}; seen: ${Object.keys(boxes)}`);
    const free = (boxes["#dock"].top - boxes[".tools > .segments"].bottom) / 844;
    check(free > (isOpen ? 0.2 : 0.65), `${(100 * free).toFixed(0)} % of the height is left to the map`);
    check(isOpen || height(boxes[".side"]) < 60, `the closed drawer is ${height(boxes[".side"])} pixels high`);
    const buttons = ["#do-pause", "#do-step", "#do-home", "#do-stop", "#do-box", "#do-save", "#strategy"];
    const seen = await boxesOf(page, buttons), cramped = await conflicts(page, buttons);
    check(Object.keys(seen).length === buttons.length && cramped.length === 0, `of the commands ${Object.keys(seen)} can be seen; ${cramped.join(", ")}`);
    await takePicture(page, join(pictures, `page-phone-${isOpen ? "open" : "closed"}.png`));
  }
  for (const part of ["#layers", "#cut-card", "#legend", "#plots", "#frontiers", "#services", "#log"]) {
    await page.locator(part).scrollIntoViewIfNeeded();
    const [side, box] = Object.values(await boxesOf(page, [".side", part]));
    check(box && box.top < side.bottom && box.bottom > side.top && box.left >= 0 && box.right <= 390, `${part} cannot be scrolled into the drawer`);
  }
  await command();
  await page.click("#drawer-handle");
  await page.setViewportSize(before);
  check(await page.isHidden("#drawer-handle"), "the handle of the drawer is seen on a large window");
  check((await conflicts(page, PANELS)).length === 0, "the panels are not where they were before");
  say("on a phone the map and the commands are in view, and the panels in a drawer");
}
