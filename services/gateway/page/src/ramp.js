// The colors of what is measured, from low to high.
export const RAMP = ["#2b3a8f", "#2378b5", "#2fb3a3", "#a6cf5b", "#f3c14b", "#f0764a"];
export const RAMP_CSS = `linear-gradient(90deg, ${RAMP.join(",")})`;

const rgb = RAMP.map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)));

/** Writes the color at `share`, 0 = low to 1 = high, to three bytes from `at` on. */
export function paintShare(share, bytes, at) {
  const t = Math.min(Math.max(share, 0), 1) * (rgb.length - 1), k = Math.min(Math.floor(t), rgb.length - 2);
  for (let c = 0; c < 3; ++c) bytes[at + c] = rgb[k][c] + (rgb[k + 1][c] - rgb[k][c]) * (t - k);
}
