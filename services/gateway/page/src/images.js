// Camera images, disparities and depths as pictures.
import { paintShare } from "./ramp.js";

const MEASURED = { "16UC1": { bytes: 2, read: "getUint16", meters: 0.001 }, "32FC1": { bytes: 4, read: "getFloat32", meters: 1 } };
const UNMEASURED = [0, 0, 0, 40]; // nearly transparent: the card shows through

function paintColors({ width, height, step, encoding, data }, channels, pixels) {
  const [red, blue] = encoding === "bgr8" ? [2, 0] : [0, channels - 1];
  const green = channels === 3 ? 1 : 0;
  let to = 0;
  for (let v = 0; v < height; ++v) {
    for (let at = v * step, end = at + width * channels; at < end; at += channels) {
      pixels[to++] = data[at + red];
      pixels[to++] = data[at + green];
      pixels[to++] = data[at + blue];
      pixels[to++] = 255;
    }
  }
}

/** The numbers of a one-channel image, row by row. */
function numbersOf({ width, height, step, encoding, data, is_bigendian: isBigEndian }) {
  const { bytes, read } = MEASURED[encoding];
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  return Float32Array.from({ length: width * height },
    (_, n) => view[read](Math.floor(n / width) * step + (n % width) * bytes, !isBigEndian));
}

/** Colors numbers from `low` to `high`; those that are not valid stay unmeasured. */
function paintNumbers(numbers, isValid, low, high, pixels) {
  numbers.forEach((value, n) => {
    if (!isValid(value)) return pixels.set(UNMEASURED, 4 * n);
    paintShare((value - low) / (high - low || 1), pixels, 4 * n);
    pixels[4 * n + 3] = 255;
  });
}

/** From the camera to the next whole meter beyond what is farthest, so that colors change little from image to image. */
function paintDepth(image, pixels) {
  const depths = numbersOf(image).map((value) => value * MEASURED[image.encoding].meters);
  const isValid = (depth) => depth > 0 && depth < Infinity; // as REP 118 has it
  const high = Math.ceil(depths.reduce((most, depth) => (isValid(depth) && depth > most ? depth : most), 0));
  paintNumbers(depths, isValid, 0, high, pixels);
  return high > 0 ? { low: 0, high, unit: "m" } : null;
}

/**
 * What a sensor_msgs/msg/Image or a stereo_msgs/msg/DisparityImage looks like.
 * @returns { text: a line about it; pixels: RGBA, absent if it cannot be shown; width, height; scale: { low, high, unit } of
 *            the colors, null where they are the camera's }
 */
export function pictureOf(message) {
  const image = message.image ?? message;
  const { width, height, step, encoding, data } = image;
  if (!(width > 0 && height > 0)) return { text: "no picture" };
  const channels = encoding === "rgb8" || encoding === "bgr8" ? 3 : encoding === "mono8" || encoding.startsWith("bayer_") ? 1 : 0;
  const isMeasured = Object.hasOwn(MEASURED, encoding);
  if (message.image ? encoding !== "32FC1" : channels === 0 && !isMeasured) return { text: `cannot show ${encoding}` };
  const rowBytes = width * (isMeasured ? MEASURED[encoding].bytes : channels);
  if (step < rowBytes || data.byteLength < step * height) return { text: "no picture" };
  const pixels = new Uint8ClampedArray(4 * width * height);
  let scale = null;
  if (message.image) {
    const { min_disparity: low, max_disparity: high } = message;
    paintNumbers(numbersOf(image), (disparity) => disparity >= low && disparity < Infinity, low, high, pixels);
    scale = { low, high, unit: "px" };
  } else if (isMeasured) {
    scale = paintDepth(image, pixels);
  } else {
    paintColors(image, channels, pixels);
  }
  return { text: `${width} × ${height} ${encoding}`, pixels, width, height, scale };
}

/** Paints a message on a canvas. Returns what pictureOf said of it. */
export function paintPicture(canvas, message) {
  const picture = pictureOf(message);
  if (!picture.pixels) return picture;
  if (canvas.width !== picture.width || canvas.height !== picture.height) {
    canvas.width = picture.width;
    canvas.height = picture.height;
  }
  canvas.getContext("2d").putImageData(new ImageData(picture.pixels, picture.width, picture.height), 0, 0);
  return picture;
}
