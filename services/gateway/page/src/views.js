// Where a camera stands and what it turns about: { eye, target }, points { x, y, z } in map [m]. Angles are in radians.

const DEG = Math.PI / 180;
const ELEVATIONS = [35, 50, 65, 80].map((deg) => deg * DEG); // from which a place is looked at, the first that sees it
const LEAST_ELEVATION = 30 * DEG, MOST_ELEVATION = 80 * DEG; // of a camera that orbits
const NEAREST = 3; // [m] from a robot, to see what is around it

const minus = (a, b) => ({ x: a.x - b.x, y: a.y - b.y, z: a.z - b.z });
const lengthOf = ({ x, y, z }) => Math.hypot(x, y, z);
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** { azimuth, elevation, distance } of an offset, and back. */
const anglesOf = (offset) => ({ azimuth: Math.atan2(offset.y, offset.x),
  elevation: Math.asin(clamp(offset.z / (lengthOf(offset) || 1), -1, 1)), distance: lengthOf(offset) });
const from = (center, { azimuth, elevation, distance }) => ({
  x: center.x + distance * Math.cos(elevation) * Math.cos(azimuth),
  y: center.y + distance * Math.cos(elevation) * Math.sin(azimuth),
  z: center.z + distance * Math.sin(elevation),
});

/** Where a body's x axis points to, about the vertical. */
export const headingOf = ({ x, y, z, w }) => Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));

/**
 * Behind a robot and above it: as low as it is seen from there, since a wall at its back may hide it.
 * @param sees whether nothing stands between an eye and what is looked at
 */
export function behind(robot, heading, radius, sees) {
  const eyes = ELEVATIONS.map((elevation) => from(robot, { azimuth: heading + Math.PI, elevation, distance: NEAREST + 4 * radius }));
  return { eye: eyes.find(sees) ?? eyes.at(-1), target: robot };
}

/** A place from as far and from the same side as before; from higher up, if it is hidden but seen from there. */
export function shifted({ eye, target }, place, sees) {
  const at = anglesOf(minus(eye, target));
  const eyes = [at.elevation, ...ELEVATIONS.filter((each) => each > at.elevation)].map((elevation) => from(place, { ...at, elevation }));
  return { eye: eyes.find(sees) ?? eyes[0], target: place };
}

/** From so far that a robot and a place beyond it are both in view. @param half angle from the middle of the view to its edge */
export function bothInView(robot, place, half) {
  const to = minus(place, robot);
  for (const deg of [50, 40, 30, 20]) {
    for (const distance of [4, 6, 8, 12, 16, 24, 32]) {
      const eye = from(robot, { azimuth: Math.atan2(-to.y, -to.x), elevation: deg * DEG, distance });
      const [a, b] = [minus(robot, eye), minus(place, eye)];
      const cosine = (a.x * b.x + a.y * b.y + a.z * b.z) / (lengthOf(a) * lengthOf(b));
      if (Math.acos(clamp(cosine, -1, 1)) < half && distance < 3 * lengthOf(to) + NEAREST) return { eye, target: robot };
    }
  }
  return { eye: from(robot, { azimuth: Math.atan2(-to.y, -to.x), elevation: LEAST_ELEVATION, distance: 3 * lengthOf(to) + NEAREST }), target: robot };
}

/**
 * What an orbit turns about after the camera was elsewhere: a robot in view, from where the eye is, but not too near; or else
 * the middle of the map, all of which comes into view, from the side on which the eye is.
 * @param robot null where it is not in view
 * @param far   [m] from which the whole map is seen
 */
export function orbitFrom(eye, robot, center, far) {
  const { azimuth, elevation, distance } = anglesOf(minus(eye, robot ?? center));
  const at = { azimuth, elevation: clamp(elevation, LEAST_ELEVATION, MOST_ELEVATION), distance: robot ? clamp(distance, NEAREST, Math.max(far, NEAREST)) : far };
  return { eye: from(robot ?? center, at), target: robot ?? center };
}

/** Between two angles, the shorter way around. */
const turnBetween = (a, b, share) => a + share * (((((b - a) % (2 * Math.PI)) + 3 * Math.PI) % (2 * Math.PI)) - Math.PI);

/** On the way from a view to another one, which turns about what it looks at, or in place where the eye stays. */
export function between(a, b, share) {
  const [center, other] = lengthOf(minus(a.eye, b.eye)) < 1e-6 ? ["eye", "target"] : ["target", "eye"];
  const mix = (p, q) => p + share * (q - p);
  const at = { x: mix(a[center].x, b[center].x), y: mix(a[center].y, b[center].y), z: mix(a[center].z, b[center].z) };
  const [p, q] = [a, b].map((view) => anglesOf(minus(view[other], view[center])));
  return { [center]: at, [other]: from(at, { azimuth: turnBetween(p.azimuth, q.azimuth, share), elevation: mix(p.elevation, q.elevation),
    distance: mix(p.distance, q.distance) }) };
}
