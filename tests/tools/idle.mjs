// The page of a gateway that asks for a token: without the right one it says why it is not let in. With it, while no
// explorer is heard: it says so, and offers nothing to steer; on a phone nothing overflows, and the panels are in a drawer.
import { launchBrowser, takePicture } from "./browser.mjs";
import { join } from "node:path";
import { conflicts } from "./layout.mjs";
import { LONG, check } from "./observer.mjs";

const [url, program, pictures, token] = process.argv.slice(2);
const errors = [];
const browser = await launchBrowser(program);
try {
  const page = await browser.newPage({ viewport: { width: 400, height: 800 } });
  page.setDefaultTimeout(2 * LONG);
  page.on("pageerror", (error) => errors.push(error.message));
  for (const [given, reason] of [["", "a token is needed"], [`?token=${token}x`, "the token is wrong"]]) {
    await page.goto(url + given, { waitUntil: "commit" });
    await page.waitForSelector("#link.refused", { state: "attached" });
    const said = await page.textContent("#empty");
    check(said.includes("refuses this page") && said.includes(reason), `the page says ${said}`);
  }
  await takePicture(page, join(pictures, "refused.png"));
  console.log("idle: a page without the gateway's token says why it is not let in");
  await page.goto(`${url}?token=${token}`, { waitUntil: "commit" });
  await page.waitForSelector("#link.live", { state: "attached" });
  check((await page.textContent("#empty")).includes("Waiting for a map"), `the page says ${await page.textContent("#empty")}`);
  await page.waitForFunction(() => document.documentElement.dataset.state === "absent");
  check((await page.textContent("#state")) === "No explorer", `the page says ${await page.textContent("#state")}`);
  check((await page.textContent("#activity")).includes("No explorer is heard"), "the page does not say that no explorer is heard");
  for (const control of ["#dock", "#timeline"]) check(!(await page.isVisible(control)), `${control} can be seen`);
  const { bar, side, view } = await page.evaluate(() => {
    const box = (name) => document.querySelector(name).getBoundingClientRect().toJSON();
    return { bar: document.querySelector(".bar").scrollWidth, side: box(".side"), view: { width: innerWidth, height: innerHeight } };
  });
  check(bar <= view.width, `the bar is ${bar} pixels wide on a screen of ${view.width}`);
  check(side.left >= 0 && side.right <= view.width && side.top > 0.9 * view.height, `the closed drawer is at ${JSON.stringify(side)}`);
  const fixed = [".bar", ".tools > .segments", ".side"];
  for (const isOpen of [false, true]) {
    if (isOpen) await page.click("#drawer-handle");
    check((await conflicts(page, fixed)).length === 0, (await conflicts(page, fixed)).join(", "));
    check((await page.isVisible("#layers")) === isOpen, `the layers can${isOpen ? "not" : ""} be seen in the drawer`);
  }
  await page.click("#drawer-handle");
  await takePicture(page, join(pictures, "idle.png"));
  check(errors.length === 0, `the page reports ${errors.join("; ")}`);
  console.log("idle: the page says that no explorer is heard, and hides what would steer it");
} finally {
  await browser.close();
}
