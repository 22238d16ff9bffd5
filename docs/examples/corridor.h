/* A corridor with a crate, in which the example robots stand: what takes the place of a depth camera's scene. */
#ifndef THALWEG_EXAMPLES_CORRIDOR_H
#define THALWEG_EXAMPLES_CORRIDOR_H

#include <math.h>

typedef struct {
  double min[3], max[3]; /* [m] in map */
} CorridorBox;

/* A ray from p in direction d is inside the box between t[0] and t[1], if t[0] < t[1]. */
static inline void CrossBox(const CorridorBox* box, const double p[3], const double d[3], double t[2]) {
  t[0] = -INFINITY;
  t[1] = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const double a = (box->min[k] - p[k]) / d[k], b = (box->max[k] - p[k]) / d[k];
    t[0] = fmax(t[0], fmin(a, b));
    t[1] = fmin(t[1], fmax(a, b));
  }
}

/* The depth [m] along (right, down, 1), in camera_optical_frame, that a camera at p measures which looks along
 * the x axis of a body turned by the unit quaternion q = (x, y, z, w). */
static inline double CorridorDepth(const double p[3], const double q[4], double right, double down) {
  static const CorridorBox kWalls = {{-1.0, -0.8, -0.9}, {4.0, 0.8, 0.9}};
  static const CorridorBox kCrate = {{1.5, -0.8, -0.9}, {2.0, -0.1, 0.2}};
  const double b[3] = {1.0, -right, -down}; /* in base_link */
  const double t[3] = {2 * (q[1] * b[2] - q[2] * b[1]), 2 * (q[2] * b[0] - q[0] * b[2]),
                       2 * (q[0] * b[1] - q[1] * b[0])};
  const double d[3] = {b[0] + q[3] * t[0] + q[1] * t[2] - q[2] * t[1],
                       b[1] + q[3] * t[1] + q[2] * t[0] - q[0] * t[2],
                       b[2] + q[3] * t[2] + q[0] * t[1] - q[1] * t[0]}; /* in map */
  double walls[2], crate[2];
  CrossBox(&kWalls, p, d, walls);
  CrossBox(&kCrate, p, d, crate);
  return crate[0] < crate[1] && crate[0] > 0 ? crate[0] : walls[1];
}

#endif
