import assert from "node:assert/strict";
import { test } from "node:test";
import { pictureOf } from "../../../../../services/gateway/page/src/images.js";
import { RAMP, paintShare } from "../../../../../services/gateway/page/src/ramp.js";

const UNMEASURED = [0, 0, 0, 40];
const rgbOf = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
const pixel = ({ pixels }, n) => [...pixels.subarray(4 * n, 4 * n + 4)];
/** The color of a share of the scale, as a pixel. */
function colorOf(share) {
  const color = new Uint8ClampedArray([0, 0, 0, 255]);
  paintShare(share, color, 0);
  return [...color];
}
/** A row of values, each written by `write` of a DataView, with `padding` bytes behind each row. */
function imageOf(encoding, write, bytes, rows, { bigEndian = false, padding = 0 } = {}) {
  const width = rows[0].length, step = width * bytes + padding;
  const buffer = new ArrayBuffer(1 + step * rows.length); // a message's data need not be aligned
  const view = new DataView(buffer, 1);
  rows.forEach((row, v) => row.forEach((value, u) => view[write](v * step + u * bytes, value, !bigEndian)));
  return { width, height: rows.length, step, encoding, is_bigendian: bigEndian ? 1 : 0, data: new Uint8Array(buffer, 1) };
}
const millimeters = (rows, options) => imageOf("16UC1", "setUint16", 2, rows, options);
const meters = (rows, options) => imageOf("32FC1", "setFloat32", 4, rows, options);

test("The scale begins and ends with the colors of the ramp, and passes through all of them", () => {
  RAMP.forEach((hex, n) => assert.deepEqual(colorOf(n / (RAMP.length - 1)).slice(0, 3), rgbOf(hex)));
  assert.deepEqual(colorOf(-1), colorOf(0));
  assert.deepEqual(colorOf(2), colorOf(1));
});

test("Depths in millimeters are colored from the camera to the next whole meter, what was not measured hardly at all", () => {
  const picture = pictureOf(millimeters([[0, 1000, 2000], [3500, 4000, 1]]));
  assert.deepEqual(picture.scale, { low: 0, high: 4, unit: "m" });
  assert.equal(picture.text, "3 × 2 16UC1");
  assert.deepEqual([0, 1, 2, 3, 4].map((n) => pixel(picture, n)), [UNMEASURED, colorOf(0.25), colorOf(0.5), colorOf(0.875), colorOf(1)]);
  assert.equal(pixel(picture, 5)[3], 255, "a millimeter is a measurement");
});

test("Depths in meters without a finite positive value were not measured", () => {
  const picture = pictureOf(meters([[NaN, 0, -1, Infinity, -Infinity, 1.5, 3]]));
  assert.deepEqual(picture.scale, { low: 0, high: 3, unit: "m" });
  for (const n of [0, 1, 2, 3, 4]) assert.deepEqual(pixel(picture, n), UNMEASURED);
  assert.deepEqual([pixel(picture, 5), pixel(picture, 6)], [colorOf(0.5), colorOf(1)]);
});

test("Rows may be padded, and values big-endian", () => {
  const rows = [[1000, 2000], [500, 0]];
  const plain = pictureOf(millimeters(rows));
  for (const options of [{ padding: 5 }, { bigEndian: true }, { bigEndian: true, padding: 2 }])
    assert.deepEqual(pictureOf(millimeters(rows, options)), plain);
  assert.deepEqual(pixel(plain, 1), colorOf(1));
});

test("An image without any depth has no scale", () => {
  for (const image of [millimeters([[0, 0]]), meters([[NaN, Infinity]])]) {
    const picture = pictureOf(image);
    assert.equal(picture.scale, null);
    assert.deepEqual([pixel(picture, 0), pixel(picture, 1)], [UNMEASURED, UNMEASURED]);
  }
});

test("Disparities are colored between the message's limits, those below the least were not matched", () => {
  const picture = pictureOf({ image: meters([[-1, 2, 6, 10, NaN]]), min_disparity: 2, max_disparity: 10 });
  assert.deepEqual(picture.scale, { low: 2, high: 10, unit: "px" });
  assert.deepEqual([0, 1, 2, 3, 4].map((n) => pixel(picture, n)), [UNMEASURED, colorOf(0), colorOf(0.5), colorOf(1), UNMEASURED]);
});

test("Colors are the camera's, in whatever order they come", () => {
  const of = (encoding, data) => pictureOf({ width: 1, height: 1, step: data.length, encoding, is_bigendian: 0, data: Uint8Array.from(data) });
  assert.deepEqual(pixel(of("rgb8", [1, 2, 3]), 0), [1, 2, 3, 255]);
  assert.deepEqual(pixel(of("bgr8", [1, 2, 3]), 0), [3, 2, 1, 255]);
  assert.deepEqual(pixel(of("mono8", [7]), 0), [7, 7, 7, 255]);
  assert.equal(of("rgb8", [1, 2, 3]).scale, null);
});

test("What cannot be shown is named, and an image that is not whole is none", () => {
  const image = millimeters([[1000, 2000]]);
  assert.deepEqual(pictureOf({ ...image, encoding: "yuv422" }), { text: "cannot show yuv422" });
  assert.deepEqual(pictureOf({ ...image, encoding: "toString" }), { text: "cannot show toString" });
  assert.deepEqual(pictureOf({ image, min_disparity: 0, max_disparity: 1 }), { text: "cannot show 16UC1" });
  for (const change of [{ width: 0 }, { height: 2 }, { step: 3 }, { data: image.data.subarray(1) }])
    assert.deepEqual(pictureOf({ ...image, ...change }), { text: "no picture" });
});
