#pragma once

#include "services/explorer/core/gaps/polygon.h"

/// Small polygons whose gaps and events can be found by hand.
namespace thalweg::explorer::test {

/// A corner at (3, 2) hides the upper room from the left one.
///
///          .--.
///          |  |
///     .----'  |
///     |       |
///     '-------'
inline Polygon BentCorridor() {
  return Polygon({{0, 0}, {5, 0}, {5, 5}, {3, 5}, {3, 2}, {0, 2}});
}

/// A corridor with two dead ends above it, behind vertex 10 at (4, 1.9) and vertex 6 at (8, 2.4). The line
/// through both is y = 1.9 + (x - 4) / 8. Vertices 3 and 7 are the other corners of the dead ends.
///
///         .-. .-.
///         | | | |
///     .---' '-' '--.
///     |            |
///     '------------'
inline Polygon TwoDeadEnds() {
  return Polygon({{0, 0},
                  {12, 0},
                  {12, 2.5},
                  {10, 2.7},
                  {10, 5},
                  {8, 5.2},
                  {8, 2.4},
                  {6, 2.2},
                  {6, 5},
                  {4.1, 5.1},
                  {4, 1.9},
                  {0, 2}});
}

/// A corridor with a tooth that hangs down to vertex 7 at (4, 1.2), and farther on one that stands up to
/// vertex 2 at (7, 1). The line through both is y = 1.2 - (x - 4) / 15.
///
///     .---. .-----.
///     |    V      |
///     |       A   |
///     '------' '--'
inline Polygon TwoTeeth() {
  return Polygon(
      {{0, 0}, {6.5, 0.03}, {7, 1}, {7.5, 0}, {12, 0.1}, {12, 2}, {4.5, 2.1}, {4, 1.2}, {3.5, 2.05}, {0, 2}});
}

}  // namespace thalweg::explorer::test
