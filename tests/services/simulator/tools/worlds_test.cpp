#include "services/simulator/tools/worlds.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/support/places.h"

namespace thalweg::simulator {
namespace {

std::string ShippedText(const std::string& name) {
  std::ifstream file(test::SourceFolder() + "/deploy/worlds/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Worlds, TheShippedFilesAreWhatTheGeneratorMakes) {
  for (const BoxWorld& world : MakeAllWorlds()) {
    EXPECT_TRUE(world.Obj() == ShippedText(world.name() + ".obj"))
        << world.name() << ".obj differs: run build/bin/thalweg-make-worlds deploy/worlds";
    EXPECT_EQ(world.Mtl(), ShippedText(world.name() + ".mtl"));
  }
}

TEST(Worlds, ABoxOfAnUnknownMaterialOrWithoutVolumeIsRefused) {
  BoxWorld world("a", {0, 0, 0});
  world.Material("wood", {0.5, 0.4, 0.3});
  EXPECT_THROW(world.Box("gold", {0, 0, 0}, {1, 1, 1}), std::invalid_argument);
  EXPECT_THROW(world.Box("wood", {0, 0, 0}, {1, 0, 1}), std::invalid_argument);
}

TEST(Worlds, ATurnedBoxKeepsItsMiddle) {
  BoxWorld world("a", {10, 0, 0});
  world.Material("wood", {0.5, 0.4, 0.3});
  world.TurnedBox("wood", {0, 0, 0}, {4, 2, 1}, 90.0);
  // Its first corner, (0, 0, 0), rotates about (2, 1) to (3, -1); the room's corner lies at x = 10.
  EXPECT_NE(world.Obj().find("\nv 13.0000 -1.0000 0.0000\n"), std::string::npos) << world.Obj();
}

}  // namespace
}  // namespace thalweg::simulator
