// All engines side by side on pairs of a data set, with windows of one size: a picture of their disparities,
// and how many pixels each matched. Or which of the differences between sad5-bilateral and sad5-thesis
// matter.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/drawing/canvas.h"
#include "services/stereo/adapter/ground_truth.h"
#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/matcher.h"
#include "services/stereo/core/sad5.h"
#include "services/stereo/core/sad5_thesis.h"

namespace thalweg {
namespace fs = std::filesystem;
namespace {

constexpr double kTile = 150.0;  // [px] width
constexpr double kGap = 5.0;
constexpr double kNames = 104.0;  // width of the engines' names
constexpr double kHead = 42.0;
constexpr double kFoot = 17.0;  // below a tile
constexpr double kLetters = 8.0;
constexpr double kMargin = 10.0;
constexpr int kJpegQuality = 80;  // small, and letters are still clear

struct Tile {
  stereo::DisparityMap disparity;
  stereo::Evaluation evaluation;
};

struct Column {
  stereo::ListedPair pair;
  stereo::DisparityMap truth;
  std::vector<Tile> tiles;  ///< As the engines are named.
};

std::size_t MatchesIn(const stereo::DisparityMap& disparity) {
  const double pixels = static_cast<double>(disparity.data().size());
  return static_cast<std::size_t>(std::lround(stereo::Density(disparity) * pixels));
}

struct Loaded {
  stereo::ByteImage left, right;
  stereo::GroundTruth truth;
};

Loaded Load(const fs::path& dataset, const stereo::ListedPair& pair) {
  const fs::path folder = dataset / pair.name;
  stereo::ByteImage left = stereo::ReadImage(stereo::RequirePicture(folder, "left"));
  stereo::GroundTruth truth =
      stereo::ReadGroundTruth(stereo::RequirePicture(folder, "gt"), stereo::FindPicture(folder, "gt_right"),
                              pair.scale, folder, left);
  return {std::move(left), stereo::ReadImage(stereo::RequirePicture(folder, "right")), std::move(truth)};
}

/// Prints the means over all pairs of sad5-thesis, of the same with one part as in sad5-bilateral, and of
/// sad5-bilateral.
void JudgeDepartures(const fs::path& dataset, const std::vector<stereo::ListedPair>& pairs) {
  stereo::Sad5Options ours;
  ours.prefilter.kind = stereo::Prefilter::kBilateral;
  const stereo::Sad5Options printed = stereo::AsTheThesisPrints(ours);
  std::vector<std::pair<std::string, stereo::Sad5Options>> variants(5, {"sad5-thesis", printed});
  variants[1].first = "  but image minus blur";
  variants[1].second.prefilter = ours.prefilter;
  variants[2].first = "  but truncated differences";
  variants[2].second.max_difference = ours.max_difference;
  variants[3].first = "  but 2 px between left and right";
  variants[3].second.left_right = ours.left_right;
  variants[4].first = "  but 4-connected regions";
  variants[4].second.corners_connect = ours.corners_connect;
  variants.emplace_back("sad5-bilateral", ours);
  std::printf("%-36s bad of the non-occluded [%%]   density [%%]\n", "");
  for (const auto& [name, sad5] : variants) {
    double bad = 0.0;
    double density = 0.0;
    for (const stereo::ListedPair& pair : pairs) {
      const Loaded loaded = Load(dataset, pair);
      stereo::MatcherOptions options;
      options.max_disparity = pair.max_disparity;
      options.sad5 = sad5;
      const stereo::DisparityMap disparity = stereo::Sad5(options).Match(loaded.left, loaded.right);
      const stereo::Evaluation evaluation =
          stereo::Evaluate(disparity, loaded.truth.disparity, loaded.truth.masks);
      bad += 100.0 / static_cast<double>(pairs.size()) * evaluation.bad_non_occluded;
      density += 100.0 / static_cast<double>(pairs.size()) * evaluation.density;
    }
    std::printf("%-36s %26.2f %13.1f\n", name.c_str(), bad, density);
  }
}

Column MatchWithAll(const fs::path& dataset, const stereo::ListedPair& pair,
                    const stereo::MatcherOptions& options) {
  const auto& [left, right, truth] = Load(dataset, pair);
  Column column{pair, truth.disparity, {}};
  for (const std::string_view engine : stereo::EngineNames()) {
    stereo::DisparityMap disparity = stereo::MakeMatcher(engine, options)->Match(left, right);
    const stereo::Evaluation evaluation = stereo::Evaluate(disparity, truth.disparity, truth.masks);
    std::printf("%-12s %3d x %3d  %-14s %7zu matches  %5.1f %%  bad of the matched %5.2f %%\n",
                pair.name.c_str(), left.width(), left.height(), std::string(engine).c_str(),
                MatchesIn(disparity), 100.0 * evaluation.density, 100.0 * evaluation.bad_matched);
    column.tiles.push_back({std::move(disparity), evaluation});
  }
  return column;
}

void DrawTile(Canvas& canvas, const Area& area, const stereo::DisparityMap& disparity,
              double max_disparity) {
  stereo::ByteImage colors = stereo::Colored(disparity, max_disparity);
  cv::Mat picture(colors.height(), colors.width(), CV_8UC3, colors.data().data());
  cv::cvtColor(picture, picture, cv::COLOR_RGB2BGR);
  canvas.Image(area, picture);
}

std::string SharesOf(const stereo::Evaluation& evaluation) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.0f %%, %.1f %% bad", 100.0 * evaluation.density,
                100.0 * evaluation.bad_matched);
  return text;
}

void DrawSideBySide(const std::vector<Column>& columns, const fs::path& file) {
  double tallest = 0.0;
  for (const Column& column : columns) {
    tallest = std::max(tallest, kTile * column.truth.height() / column.truth.width());
  }
  const std::span<const std::string_view> engines = stereo::EngineNames();
  const double row_height = tallest + kFoot + kGap;
  const double width = 2 * kMargin + kNames + static_cast<double>(columns.size()) * (kTile + kGap);
  const double height = kHead + static_cast<double>(engines.size() + 1) * row_height + kMargin;
  Canvas canvas(static_cast<int>(width), static_cast<int>(height));
  canvas.Fill({0, 0, width, height}, colors::kPaper);
  const auto name = [&](std::size_t row, std::string_view text) {
    canvas.Text(std::string(text), {kMargin, kHead + static_cast<double>(row) * row_height + 14.0}, 9.0,
                colors::kInk, Align::kLeft, true);
  };
  name(0, "truth");
  for (std::size_t i = 0; i < engines.size(); ++i) name(i + 1, engines[i]);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Column& column = columns[k];
    const double x = kMargin + kNames + static_cast<double>(k) * (kTile + kGap);
    const double tile_height = kTile * column.truth.height() / column.truth.width();
    const int range = column.pair.max_disparity;
    canvas.Text(column.pair.name, {x, 18.0}, 9.0, colors::kInk, Align::kLeft, true);
    canvas.Text("blue 0 to red " + std::to_string(range) + " px", {x, 34.0}, kLetters, colors::kMuted);
    const auto area = [&](std::size_t row) {
      return Area{x, kHead + static_cast<double>(row) * row_height, kTile, tile_height};
    };
    DrawTile(canvas, area(0), column.truth, range);
    for (std::size_t i = 0; i < engines.size(); ++i) {
      DrawTile(canvas, area(i + 1), column.tiles[i].disparity, range);
      canvas.Text(SharesOf(column.tiles[i].evaluation), {x, area(i + 1).bottom() + 12.0}, kLetters,
                  colors::kInk);
    }
  }
  if (!cv::imwrite(file.string(), canvas.Picture(), {cv::IMWRITE_JPEG_QUALITY, kJpegQuality})) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace
}  // namespace thalweg

int main(int argc, char** argv) try {
  thalweg::fs::path dataset;
  std::vector<std::string> names;
  thalweg::stereo::MatcherOptions options;
  int window = 7;
  thalweg::fs::path out = "engines.jpg";
  CLI::App app("All engines side by side");
  app.add_option("dataset", dataset, "Folder with pairs.csv, as for thalweg stereo")->required();
  app.add_option("--pairs", names, "Only these, in this order")->delimiter(',');
  app.add_option("--window-px", window, "Edge of every engine's window, where it has one")
      ->capture_default_str();
  app.add_option("--max-disparity", options.max_disparity, "Disparities below it are searched [px]")
      ->capture_default_str();
  app.add_option("--out", out, "Picture")->capture_default_str();
  bool departures = false;
  app.add_flag(
      "--departures", departures,
      "Only which differences between sad5-bilateral and sad5-thesis matter, with the default window "
      "and the pairs' own ranges");
  CLI11_PARSE(app, argc, argv);
  options.sad5.window = options.opencv.block_window = options.opencv.semi_global_window = window;
  const auto listed = thalweg::stereo::ReadPairs(dataset / "pairs.csv").pairs;
  if (names.empty()) {
    for (const auto& pair : listed) names.push_back(pair.name);
  }
  std::vector<thalweg::stereo::ListedPair> pairs;
  for (const std::string& name : names) {
    const auto found =
        std::find_if(listed.begin(), listed.end(), [&](const auto& pair) { return pair.name == name; });
    if (found == listed.end()) throw std::invalid_argument("no pair is named " + name);
    pairs.push_back(*found);
  }
  if (departures) {
    thalweg::JudgeDepartures(dataset, pairs);
    return EXIT_SUCCESS;
  }
  std::vector<thalweg::Column> columns;
  for (const auto& pair : pairs) columns.push_back(thalweg::MatchWithAll(dataset, pair, options));
  thalweg::DrawSideBySide(columns, out);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "bench_stereo_engines: " << error.what() << '\n';
  return EXIT_FAILURE;
}
