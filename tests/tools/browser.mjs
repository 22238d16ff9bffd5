// Chromium without a GPU, as the tests of the page use it.
import { chromium } from "playwright-core";

/** Starts Chromium, which draws 3D with a software renderer. */
export const launchBrowser = (program) => chromium.launch({
  executablePath: program,
  args: ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader-webgl", "--enable-unsafe-swiftshader",
    "--disable-gpu-rasterization", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"],
});

/** A screenshot, for which the page stops drawing: a software renderer might otherwise never come to it. */
export async function takePicture(page, path) {
  await page.evaluate(() => {
    window.nextFrame = window.requestAnimationFrame;
    window.requestAnimationFrame = (frame) => ((window.waiting = frame), 0);
  });
  await page.screenshot({ path });
  await page.evaluate(() => {
    window.requestAnimationFrame = window.nextFrame;
    window.requestAnimationFrame(window.waiting);
  });
}
