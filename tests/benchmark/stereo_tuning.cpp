// How much of best's accuracy is due to tuning its parameters on the test pairs: each parameter is varied in
// turn; then, over random halves of the pairs, the setting that is best on one half is evaluated on the
// other.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <iostream>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "services/stereo/adapter/ground_truth.h"
#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {
namespace {

struct Choice {
  std::string name;
  std::function<void(SemiGlobalOptions&)> apply;
  std::vector<double> bad;  ///< [%] non-occluded, for each pair
};

std::vector<Choice> Choices() {
  return {{"as it is", [](auto&) {}, {}},
          {"census_weight 2", [](auto& o) { o.census_weight = 2; }, {}},
          {"max_difference 10", [](auto& o) { o.max_difference = 10; }, {}},
          {"max_difference 30", [](auto& o) { o.max_difference = 30; }, {}},
          {"slope_penalty 20", [](auto& o) { o.slope_penalty = 20; }, {}},
          {"slope_penalty 40", [](auto& o) { o.slope_penalty = 40; }, {}},
          {"jump_penalty 70", [](auto& o) { o.jump_penalty = 70; }, {}},
          {"jump_penalty_at_edge 30", [](auto& o) { o.jump_penalty_at_edge = 30; }, {}},
          {"jump_penalty_at_edge 60", [](auto& o) { o.jump_penalty_at_edge = 60; }, {}},
          {"edge 6", [](auto& o) { o.edge = 6; }, {}},
          {"edge 24", [](auto& o) { o.edge = 24; }, {}},
          {"speckle_pixels 30", [](auto& o) { o.speckle_pixels = 30; }, {}},
          {"speckle_pixels 120", [](auto& o) { o.speckle_pixels = 120; }, {}},
          {"surfaces.step 1", [](auto& o) { o.surfaces.step = 1; }, {}},
          {"surfaces.step 3", [](auto& o) { o.surfaces.step = 3; }, {}},
          {"surfaces.least_pixels 80", [](auto& o) { o.surfaces.least_pixels = 80; }, {}},
          {"surfaces.least_pixels 300", [](auto& o) { o.surfaces.least_pixels = 300; }, {}},
          {"surfaces.least_share 0.05", [](auto& o) { o.surfaces.least_share = 0.05; }, {}},
          {"surfaces.least_agreement 0.2", [](auto& o) { o.surfaces.least_agreement = 0.2; }, {}},
          {"surfaces.least_agreement 0.5", [](auto& o) { o.surfaces.least_agreement = 0.5; }, {}},
          {"surfaces.overrule_agreement 0.8", [](auto& o) { o.surfaces.overrule_agreement = 0.8; }, {}},
          {"surfaces.bare 0.2", [](auto& o) { o.surfaces.bare = 0.2; }, {}},
          {"surfaces.bare 0.6", [](auto& o) { o.surfaces.bare = 0.6; }, {}},
          {"surfaces.rival 0.2", [](auto& o) { o.surfaces.rival = 0.2; }, {}},
          {"surfaces.rival 0.6", [](auto& o) { o.surfaces.rival = 0.6; }, {}},
          {"no surfaces", [](auto& o) { o.fill_surfaces = false; }, {}}};
}

double MeanOver(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  double sum = 0.0;
  for (const std::size_t i : indices) sum += values[i];
  return sum / static_cast<double>(indices.size());
}

void Judge(const std::filesystem::path& dataset, std::vector<Choice>& choices) {
  for (const ListedPair& pair : ReadPairs(dataset / "pairs.csv").pairs) {
    const std::filesystem::path folder = dataset / pair.name;
    const ByteImage left = ReadImage(RequirePicture(folder, "left"));
    const ByteImage right = ReadImage(RequirePicture(folder, "right"));
    const GroundTruth truth = ReadGroundTruth(RequirePicture(folder, "gt"), FindPicture(folder, "gt_right"),
                                              pair.scale, folder, left);
    for (Choice& choice : choices) {
      MatcherOptions options;
      options.max_disparity = pair.max_disparity;
      choice.apply(options.best);
      const DisparityMap disparity = MakeMatcher(kBestEngine, options)->Match(left, right);
      choice.bad.push_back(100.0 * Evaluate(disparity, truth.disparity, truth.masks).bad_non_occluded);
    }
  }
}

void ChooseOnHalves(const std::vector<Choice>& choices, int splits) {
  std::vector<std::size_t> pairs(choices.front().bad.size());
  std::iota(pairs.begin(), pairs.end(), 0U);
  std::mt19937 random(1);
  double chosen_here = 0.0;
  double as_is_here = 0.0;
  double chosen_there = 0.0;
  double as_is_there = 0.0;
  for (int k = 0; k < splits; ++k) {
    std::shuffle(pairs.begin(), pairs.end(), random);
    const auto middle = pairs.begin() + static_cast<std::ptrdiff_t>(pairs.size() / 2);
    const std::vector<std::size_t> here(pairs.begin(), middle);
    const std::vector<std::size_t> there(middle, pairs.end());
    const auto& chosen = *std::min_element(
        choices.begin(), choices.end(),
        [&](const Choice& a, const Choice& b) { return MeanOver(a.bad, here) < MeanOver(b.bad, here); });
    chosen_here += MeanOver(chosen.bad, here) / splits;
    chosen_there += MeanOver(chosen.bad, there) / splits;
    as_is_here += MeanOver(choices.front().bad, here) / splits;
    as_is_there += MeanOver(choices.front().bad, there) / splits;
  }
  std::printf("%d random halves, mean non-occluded bad [%%]:\n", splits);
  std::printf("  chosen on a half: %.2f there, %.2f on the other; as it is: %.2f and %.2f\n", chosen_here,
              chosen_there, as_is_here, as_is_there);
}

}  // namespace
}  // namespace thalweg::stereo

int main(int argc, char** argv) try {
  std::string dataset;
  int splits = 1000;
  CLI::App app("What best's accuracy owes to the pairs that its parameters were chosen on");
  app.add_option("dataset", dataset, "Folder with pairs.csv, as for thalweg stereo")->required();
  app.add_option("--splits", splits)->check(CLI::PositiveNumber)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  auto choices = thalweg::stereo::Choices();
  thalweg::stereo::Judge(dataset, choices);
  for (const auto& choice : choices) {
    const double mean =
        std::accumulate(choice.bad.begin(), choice.bad.end(), 0.0) / static_cast<double>(choice.bad.size());
    std::printf("%-34s %6.2f\n", choice.name.c_str(), mean);
  }
  thalweg::stereo::ChooseOnHalves(choices, splits);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "bench_stereo_tuning: " << error.what() << '\n';
  return EXIT_FAILURE;
}
