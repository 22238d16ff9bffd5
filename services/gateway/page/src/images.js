// Camera images and disparities as pictures.
import { RAMP } from "./blocks.js";

const rampRgb = RAMP.map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)));

function paintImage(image, pixels) {
  const { width, height, step, encoding, data } = image;
  const channels = { mono8: 1, rgb8: 3, bgr8: 3 }[encoding] ?? (encoding.startsWith("bayer_") ? 1 : 0);
  if (channels === 0) return `cannot show ${encoding}`;
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
  return `${width} × ${height} ${encoding}`;
}

function paintDisparity(message, pixels) {
  const { width, height, step, data } = message.image;
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const span = message.max_disparity - message.min_disparity || 1;
  let to = 0;
  for (let v = 0; v < height; ++v) {
    for (let u = 0; u < width; ++u) {
      const value = view.getFloat32(v * step + 4 * u, true);
      const valid = value >= message.min_disparity;
      const t = Math.min(Math.max((value - message.min_disparity) / span, 0), 0.999) * (rampRgb.length - 1);
      const low = valid ? rampRgb[Math.floor(t)] : [0, 0, 0], high = valid ? rampRgb[Math.floor(t) + 1] : [0, 0, 0];
      for (let k = 0; k < 3; ++k) pixels[to++] = low[k] + (high[k] - low[k]) * (t % 1);
      pixels[to++] = valid ? 255 : 40;
    }
  }
  return `${width} × ${height}, ${message.min_disparity.toFixed(0)} to ${message.max_disparity.toFixed(0)} px`;
}

/** Paints an Image or a DisparityImage. Returns a line about it. */
export function paintPicture(canvas, message) {
  const image = message.image ?? message;
  if (!(image.width > 0 && image.height > 0 && image.data.byteLength >= image.step * image.height)) return "no picture";
  if (canvas.width !== image.width || canvas.height !== image.height) {
    canvas.width = image.width;
    canvas.height = image.height;
  }
  const context = canvas.getContext("2d");
  const picture = context.createImageData(image.width, image.height);
  const text = message.image ? paintDisparity(message, picture.data) : paintImage(image, picture.data);
  context.putImageData(picture, 0, 0);
  return text;
}
