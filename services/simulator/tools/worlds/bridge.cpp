#include <array>
#include <utility>

#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr double kDeck = 2.6;  // [m] underside of the deck

void AddBanks(BoxWorld& world) {
  world.TurnedBox("green", {-0.5, -1.5, -1.2}, {10.5, 2.2, 1.1}, 2);
  world.TurnedBox("green", {-0.5, 17.9, -1.2}, {10.5, 21.5, 0.9}, -3);
  for (const auto& [x, y, size] : {std::array{1.2, 4.6, 0.7},
                                   {8.3, 6.1, 0.5},
                                   {2.1, 9.4, 0.9},
                                   {7.6, 13.3, 0.8},
                                   {1.4, 15.4, 0.55},
                                   {5.1, 11.6, 0.4}}) {
    world.TurnedBox("metal", {x - size / 2, y - size / 2, -0.1}, {x + size / 2, y + size / 2, 0.7 * size},
                    40.0 * y, 12);  // rocks
  }
}

void AddPillars(BoxWorld& world) {
  for (const auto& [y, lean] : {std::pair{4.1, 0.05}, {8.0, 0.0}, {12.05, -0.04}, {16.0, 0.0}}) {
    for (const double x : {3.55, 6.4}) {
      world.Column("white", {x, y, -0.1}, {x + lean, y + lean, kDeck + 0.05}, 0.28, 12);
      world.TurnedBox("white", {x - 0.45, y - 0.45, -0.1}, {x + 0.45, y + 0.45, 0.3}, 45 * lean * 20);
    }
    world.Box("white", {3.0, y - 0.22, kDeck - 0.35}, {6.95, y + 0.22, kDeck + 0.02});
    world.Column("metal", {3.6, y, 0.4}, {6.4, y, kDeck - 0.4}, 0.06, 8);  // braces
    world.Column("metal", {6.4, y + 0.05, 0.4}, {3.6, y + 0.05, kDeck - 0.4}, 0.06, 8);
  }
}

void AddDeck(BoxWorld& world) {
  world.TurnedBox("dark", {2.6, -0.3, kDeck}, {7.4, 20.3, kDeck + 0.25}, 0.7);
  for (const double x : {2.95, 4.95, 6.9}) {  // girders under the deck
    world.TurnedBox("metal", {x, -0.3, kDeck - 0.3}, {x + 0.1, 20.3, kDeck + 0.02}, 0.7);
  }
  const double top = kDeck + 0.25;
  AddRailing(world, {2.78, 0, top}, {2.60, 20, top}, 14);
  AddRailing(world, {7.38, 0, top}, {7.20, 20, top}, 14);
  for (const double y : {3.0, 10.0, 17.0}) {
    world.Column("metal", {2.78, y, top - 0.05}, {2.78, y, top + 1.9}, 0.06, 8);
    world.Column("metal", {2.78, y, top + 1.85}, {3.7, y, top + 1.95}, 0.04, 6);
    world.Box("yellow", {3.5, y - 0.12, top + 1.84}, {3.95, y + 0.12, top + 1.96});
  }
  world.TurnedBox("red", {4.2, 5.2, top}, {5.9, 8.6, top + 1.3}, 4);  // a truck without wheels
  world.TurnedBox("white", {4.25, 8.7, top + 0.1}, {5.8, 9.7, top + 1.0}, 4);
  world.TurnedBox("yellow", {3.3, 13.6, top}, {4.1, 13.68, top + 0.9}, 21);
  world.TurnedBox("yellow", {5.6, 14.4, top}, {6.4, 14.48, top + 0.9}, -15);
}

}  // namespace

BoxWorld MakeBridge() {
  BoxWorld world("bridge", {0.045, 0.051, 0.038});
  AddMaterials(world);
  world.Shell({10, 20, 5}, "wood", "ceiling", "blue");
  AddBanks(world);
  AddPillars(world);
  AddDeck(world);
  return world;
}

}  // namespace thalweg::simulator
