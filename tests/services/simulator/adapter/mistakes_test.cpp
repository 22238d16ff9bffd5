#include "services/simulator/adapter/mistakes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "common/scenario/scenario.h"

namespace thalweg::simulator {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string ErrorOf(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("thalweg_mistakes_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "world.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(folder / "place.txtpb") << text;
  std::string error = "no error";
  try {
    LoadScenario((folder / "place.txtpb").string(), overrides, {.mistakes = MistakesIn});
  } catch (const std::runtime_error& thrown) {
    error = thrown.what();
  }
  std::filesystem::remove_all(folder);
  return error;
}

constexpr auto kWorld = "world { file: 'world.obj' }\n";

TEST(MistakesWithTheSimulator, TheMachinesClockContradictsItAndBothFieldsAreNamedWithTheirPlace) {
  EXPECT_THAT(ErrorOf(std::string(kWorld) + "network {\n  wall_clock: true\n}\n"),
              AllOf(HasSubstr("place.txtpb:3:3: network.wall_clock: is true"), HasSubstr("world.file")));
  EXPECT_THAT(ErrorOf(kWorld, {"network.wall_clock=true"}),
              AllOf(HasSubstr("--set network.wall_clock=true"), HasSubstr("world.file")));
}

TEST(MistakesWithTheSimulator, ItsOwnClockIsNoMistake) {
  EXPECT_EQ(ErrorOf(kWorld), "no error");
  EXPECT_EQ(ErrorOf(std::string(kWorld) + "network { wall_clock: false }\n"), "no error");
}

}  // namespace
}  // namespace thalweg::simulator
