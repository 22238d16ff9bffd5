// The gateway's page shows images whose pixels are known: depths in both encodings, disparities, and a camera's colors.
import { launchBrowser, takePicture } from "./browser.mjs";
import { spawn } from "node:child_process";
import { join } from "node:path";
import { LONG, check } from "./observer.mjs";

const [url, program, pictures, thalweg] = process.argv.slice(2);
const RAMP = [[43, 58, 143], [35, 120, 181], [47, 179, 163], [166, 207, 91], [243, 193, 75], [240, 118, 74]];
const UNMEASURED = "nothing"; // hardly to be seen

const bytesOf = (values, write, size) => {
  const view = new DataView(new ArrayBuffer(size * values.length));
  values.forEach((value, n) => view[write](size * n, value, true));
  return [...new Uint8Array(view.buffer)].join(", ");
};
const floats = (values) => bytesOf(values, "setFloat32", 4);
const image = (encoding, width, step, data) => `{width: ${width}, height: 1, encoding: ${encoding}, step: ${step}, data: [${data}]}`;

// Each fifth of the scale has a color of its own: [button, topic, message, colors, ends of the scale or null, what is said].
const SHOWN = [
  ["depth", "depth/image", image("16UC1", 6, 12, bytesOf([0, 1000, 2000, 3000, 4000, 5000], "setUint16", 2)), [UNMEASURED, ...RAMP.slice(1)],
    ["0.0 m", "5.0 m"], "6 × 1 16UC1"],
  ["depth", "depth/image", image("32FC1", 6, 24, floats([NaN, Infinity, -1, 2, 6, 10])), [UNMEASURED, UNMEASURED, UNMEASURED, RAMP[1], RAMP[3], RAMP[5]],
    ["0.0 m", "10.0 m"], "6 × 1 32FC1"],
  ["disparity", "stereo/disparity", `{min_disparity: 10, max_disparity: 60, image: ${image("32FC1", 4, 16, floats([9, 10, 30, 60]))}}`,
    [UNMEASURED, RAMP[0], RAMP[2], RAMP[5]], ["10 px", "60 px"], "4 × 1 32FC1"],
  ["left", "stereo/left/image_raw", image("rgb8", 2, 6, "1, 2, 3, 250, 251, 252"), [[1, 2, 3], [250, 251, 252]], null, "2 × 1 rgb8"],
  ["right", "stereo/right/image_raw", image("bgr8", 2, 6, "1, 2, 3, 250, 251, 252"), [[3, 2, 1], [252, 251, 250]], null, "2 × 1 bgr8"],
];

const errors = [];
const browser = await launchBrowser(program);
let publisher;
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  page.setDefaultTimeout(LONG);
  page.on("pageerror", (error) => errors.push(error.message));
  await page.goto(url, { waitUntil: "commit" });
  await page.waitForSelector("#link.live", { state: "attached" });
  await page.keyboard.press("c");
  for (const [button, topic, message, colors, scale, said] of SHOWN) {
    await page.click(`[data-picture=${button}]`);
    check(await page.isHidden("#picture-scale"), "the scale of the picture before stays");
    publisher = spawn(thalweg, ["topic", "pub", topic, message, "--rate", "5", "--timeout", "60"], { stdio: ["ignore", "ignore", "inherit"] });
    await page.waitForFunction((text) => document.getElementById("picture-info").textContent === text, said);
    const pixels = await page.evaluate(() => {
      const canvas = document.getElementById("picture");
      return [...canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data];
    });
    colors.forEach((color, n) => {
      const [red, green, blue, alpha] = pixels.slice(4 * n, 4 * n + 4);
      const right = color === UNMEASURED ? alpha < 64 : alpha === 255 && [red, green, blue].every((value, k) => Math.abs(value - color[k]) <= 1);
      check(right, `${said}: pixel ${n} is ${[red, green, blue, alpha]}, not ${color}`);
    });
    check(pixels.length === 4 * colors.length, `${said}: ${pixels.length / 4} pixels are shown`);
    const ends = (await page.isVisible("#picture-scale")) ? [await page.textContent("#scale-low"), await page.textContent("#scale-high")] : null;
    check(JSON.stringify(ends) === JSON.stringify(scale), `${said}: the scale is ${ends}, not ${scale}`);
    if (button === "depth") await takePicture(page, join(pictures, `depth-${said.slice(-5)}.png`));
    const over = new Promise((resolve) => publisher.once("close", resolve));
    publisher.kill("SIGINT");
    await over;
    console.log(`pictures: ${said} on ${topic}${scale ? `, colored from ${scale.join(" to ")}` : ""}`);
  }
  check(errors.length === 0, `the page reports ${errors.join("; ")}`);
} finally {
  publisher?.kill("SIGKILL");
  await browser.close();
}
process.exit(0);
