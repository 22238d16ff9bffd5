#include <array>

#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr int kTeeth = 9;
constexpr double kPitch = 1.67;
constexpr double kTop = 2.0;
constexpr double kLength = 6.5;
constexpr double kCorridor = 1.5;

}  // namespace

BoxWorld MakeComb() {
  BoxWorld world("comb", {0.026, 0.044, 0.033});
  AddMaterials(world);
  const double width = kTeeth * kPitch;
  world.Shell({width, kLength, kTop}, "floor", "wall", "ceiling");
  for (int k = 1; k < kTeeth; ++k) {
    const double x = kPitch * k;
    const double skew = 0.09 * (k % 3 - 1);
    AddWall(world, {x + skew, kCorridor + 0.08 * (k % 2)}, {x - skew, kLength + 0.05}, 0, kTop);
  }
  const std::array colors{"red", "green", "blue", "yellow"};
  for (int k = 0; k < kTeeth; ++k) {
    const double x = kPitch * k;
    const char* const color = colors[static_cast<std::size_t>(k) % colors.size()];
    if (k % 3 == 0) {  // half the width is walled off, with a niche behind
      AddWall(world, {x - 0.06, 5.2}, {x + 0.62, 5.27}, 0, kTop);
      world.TurnedBox(color, {x + 0.25, 5.8, 0}, {x + 0.65, 6.2, 0.5}, 20);
    } else if (k % 3 == 1) {  // a cupboard on legs
      world.Box(color, {x + 0.45, 5.95, 0.4}, {x + 1.25, 6.5, 1.5});
      world.Box("dark", {x + 0.5, 6.0, 0}, {x + 0.56, 6.45, 0.41});
      world.Box("dark", {x + 1.14, 6.0, 0}, {x + 1.2, 6.45, 0.41});
    } else {
      world.Column(color, {x + 0.95, 5.4, 0}, {x + 0.95, 5.4, 0.8 + 0.1 * k}, 0.22, 10);
    }
  }
  world.TurnedBox("wood", {4.1, 0.15, 0}, {4.6, 0.6, 0.6}, 30);
  world.Box("wood", {10.2, 0, 0.5}, {11.8, 0.35, 0.56});
  return world;
}

}  // namespace thalweg::simulator
