#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/evaluation.h"
#include "services/stereo/core/matcher.h"
#include "tests/services/stereo/support/real_images.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;

using test::DataFolder;
using test::kClassics;
using test::Scene;

Evaluation EvaluateOn(const fs::path& folder, const Scene& scene, const std::string& engine) {
  const ByteImage left = ReadImage(folder / "left.png");
  const DisparityMap truth = ReadScaledDisparity(folder / "gt.png", scene.scale);
  const auto mask = [&](const char* name) {
    ByteImage image = ToGray(ReadImage(folder / name));
    for (std::uint8_t& value : image.data()) value = value == 255 ? 255 : 0;
    return image;
  };
  const EvaluationMasks masks{mask("mask_nonocc.png"), mask("mask_disc.png"), mask("mask_all.png")};
  MatcherOptions options;
  options.max_disparity = scene.max_disparity;
  return Evaluate(MakeMatcher(engine, options)->Match(left, ReadImage(folder / "right.png")), truth, masks);
}

TEST(Matcher, Sad5IsNoWorseThanTheThesisInAnyCell) {
  const auto folder = DataFolder("stereo");
  if (!folder) GTEST_SKIP() << "no stereo under THALWEG_DATA";
  // Non-occluded, near discontinuities, all [%], for the four pairs.
  const std::map<std::string, std::array<std::array<double, 3>, 4>> thesis = {
      {"sad5-bilateral", {{{6.7, 24.9, 7.8}, {3.0, 25.0, 3.7}, {14.7, 33.2, 21.8}, {8.8, 23.7, 16.0}}}},
      {"sad5-dog", {{{6.9, 26.9, 8.36}, {6.0, 24.8, 6.82}, {20.7, 29.0, 27.6}, {19.8, 27.5, 28.5}}}}};
  for (const auto& [engine, cells] : thesis) {
    for (std::size_t i = 0; i < kClassics.size(); ++i) {
      const Evaluation e = EvaluateOn(*folder / kClassics[i].name, kClassics[i], engine);
      EXPECT_LE(100.0 * e.bad_non_occluded, cells[i][0]) << engine << ' ' << kClassics[i].name;
      EXPECT_LE(100.0 * e.bad_near_discontinuities, cells[i][1]) << engine << ' ' << kClassics[i].name;
      EXPECT_LE(100.0 * e.bad_all, cells[i][2]) << engine << ' ' << kClassics[i].name;
    }
  }
}

TEST(Matcher, BestBeatsSemiGlobalMatchingOfOpenCvOnTheFourClassics) {
  const auto folder = DataFolder("stereo");
  if (!folder) GTEST_SKIP() << "no stereo under THALWEG_DATA";
  double best = 0.0;
  double peer = 0.0;
  for (const Scene& scene : kClassics) {
    best += 25.0 * EvaluateOn(*folder / scene.name, scene, "best").bad_non_occluded;
    peer += 25.0 * EvaluateOn(*folder / scene.name, scene, "opencv-sgbm").bad_non_occluded;
  }
  EXPECT_LT(best, peer);
  EXPECT_LE(best, 4.5);
}

}  // namespace
}  // namespace thalweg::stereo
