// Chromium without a GPU, as the tests of the page use it.
import { chromium } from "playwright-core";

/** Starts Chromium, which draws 3D with a software renderer. */
export const launchBrowser = (program) => chromium.launch({
  executablePath: program,
  args: ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader-webgl", "--enable-unsafe-swiftshader",
    "--disable-gpu-rasterization", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"],
});

/**
 * A screenshot, for which the page stops drawing: a software renderer might otherwise never come to it.
 * @param path of the file, if one is wanted
 * @returns the picture as PNG
 */
export async function takePicture(page, path) {
  await page.evaluate(() => {
    window.nextFrame = window.requestAnimationFrame;
    window.requestAnimationFrame = (frame) => ((window.waiting = frame), 0);
  });
  const picture = await page.screenshot({ path });
  await page.evaluate(() => {
    window.requestAnimationFrame = window.nextFrame;
    window.requestAnimationFrame(window.waiting);
  });
  return picture;
}

/** How many pixels of two screenshots differ visibly within a rectangle { x, y, width, height }. */
export const differentPixels = (page, a, b, { x, y, width, height }) => page.evaluate(async ([first, second, rectangle]) => {
  const [one, other] = await Promise.all([first, second].map(async (base64) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))]));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return context.getImageData(...rectangle).data;
  }));
  let different = 0;
  for (let n = 0; n < one.length; n += 4) if ([0, 1, 2].some((k) => Math.abs(one[n + k] - other[n + k]) > 8)) ++different;
  return different;
}, [a.toString("base64"), b.toString("base64"), [x, y, width, height]]);
