#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "common/base/stopwatch.h"
#include "services/cli/command/command.h"
#include "services/stereo/adapter/calibration_file.h"
#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/evaluation.h"
#include "services/stereo/core/matcher.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;
using stereo::ByteImage;
using stereo::DisparityMap;

constexpr double kPercent = 100.0;
constexpr auto kNonOccludedMask = "mask_nonocc.png";

struct Args {
  fs::path left, right, out, ground_truth, masks, dataset, json;
  std::vector<fs::path> calibration;
  std::vector<std::string> engines;
  double scale = 1.0;
  int max_disparity = stereo::MatcherOptions{}.max_disparity;
  int threads = stereo::MatcherOptions{}.threads;
};

/// What is known of a pair beside its images.
struct Truth {
  DisparityMap disparity;
  stereo::EvaluationMasks masks;
};

struct Row {
  std::string pair;
  std::string engine;
  stereo::Evaluation evaluation;
  double milliseconds = 0.0;
};

void RequireSize(const fs::path& file, const auto& image, const ByteImage& left) {
  if (image.SameSizeAs(left)) return;
  throw std::runtime_error(file.string() + ": is " + std::to_string(image.width()) + " x " +
                           std::to_string(image.height()) + ", the left image is " +
                           std::to_string(left.width()) + " x " + std::to_string(left.height()));
}

/// A mask counts where it is white: grey stands for occluded in the classic ones.
ByteImage ReadMask(const fs::path& file, const ByteImage& left) {
  ByteImage mask = stereo::ToGray(stereo::ReadImage(file));
  RequireSize(file, mask, left);
  for (std::uint8_t& value : mask.data()) value = value == 255 ? 255 : 0;
  return mask;
}

/// @param right_file  May not be there. @param masks  Folder; empty: from the truth of both images.
Truth ReadTruth(const fs::path& file, const fs::path& right_file, double scale, const fs::path& masks,
                const ByteImage& left) {
  Truth truth;
  truth.disparity = stereo::ReadScaledDisparity(file, scale);
  RequireSize(file, truth.disparity, left);
  if (!masks.empty()) {
    truth.masks = {ReadMask(masks / kNonOccludedMask, left), ReadMask(masks / "mask_disc.png", left),
                   ReadMask(masks / "mask_all.png", left)};
    return truth;
  }
  std::optional<DisparityMap> right;
  if (fs::exists(right_file)) {
    right = stereo::ReadScaledDisparity(right_file, scale);
    RequireSize(right_file, *right, left);
  }
  truth.masks = stereo::MasksFrom(truth.disparity, right);
  return truth;
}

std::unique_ptr<stereo::Matcher> MakeMatcher(const std::string& engine, int max_disparity, int threads) {
  stereo::MatcherOptions options;
  options.max_disparity = max_disparity;
  options.threads = threads;
  return stereo::MakeMatcher(engine, options);
}

/// The disparities, and the time that a matcher takes once it has its memory.
DisparityMap MatchTimed(stereo::Matcher& matcher, const ByteImage& left, const ByteImage& right,
                        double& milliseconds) {
  matcher.Match(left, right);
  const Stopwatch stopwatch;
  DisparityMap disparity = matcher.Match(left, right);
  milliseconds = stopwatch.Milliseconds();
  return disparity;
}

// ---- One pair

/// Without a calibration depths come in baselines, for a lens as wide as the image.
StereoGeometry UnknownCamera(const ByteImage& left) {
  const double f = left.width();
  return {{left.width(), left.height(), f, f, 0.5 * (left.width() - 1), 0.5 * (left.height() - 1)}, 1.0};
}

void PrintEvaluation(const stereo::Evaluation& e) {
  std::cout << std::fixed << std::setprecision(2) << "bad pixels (> 1 px): non-occluded "
            << kPercent * e.bad_non_occluded << " %, near discontinuities "
            << kPercent * e.bad_near_discontinuities << " %, all " << kPercent * e.bad_all
            << " %, of the matched " << kPercent * e.bad_matched << " %\n";
}

int MatchPair(const Args& args) {
  ByteImage left = stereo::ReadImage(args.left);
  ByteImage right = stereo::ReadImage(args.right);
  stereo::CheckPair(left, right);
  StereoGeometry camera = UnknownCamera(left);
  stereo::TriangulationOptions triangulation;
  if (args.calibration.empty()) {
    triangulation.max_depth_error = triangulation.max_depth;  // nothing is known in metres
  } else {
    const StereoRectifier rectifier(
        stereo::ReadCalibration(args.calibration, stereo::ImageSize{left.width(), left.height()}));
    left = stereo::Rectify(rectifier, Side::kLeft, left);
    right = stereo::Rectify(rectifier, Side::kRight, right);
    camera = rectifier.geometry();
  }
  const std::string engine = args.engines.empty() ? stereo::kBestEngine : args.engines.front();
  const auto matcher = MakeMatcher(engine, args.max_disparity, args.threads);
  double milliseconds = 0.0;
  const DisparityMap disparity = MatchTimed(*matcher, left, right, milliseconds);

  fs::create_directories(args.out);
  stereo::WritePfm(args.out / "disparity.pfm", disparity);
  stereo::WriteColored(args.out / "disparity.png", disparity, args.max_disparity);
  stereo::WritePly(args.out / "cloud.ply", stereo::Triangulate(disparity, left, camera, triangulation));
  const auto matched =
      std::count_if(disparity.data().begin(), disparity.data().end(), [](float d) { return !std::isnan(d); });
  std::cout << std::fixed << std::setprecision(1) << engine << ": density "
            << kPercent * static_cast<double>(matched) / static_cast<double>(disparity.data().size())
            << " %, " << milliseconds << " ms\n";
  if (!args.ground_truth.empty()) {
    const Truth truth = ReadTruth(args.ground_truth, {}, args.scale, args.masks, left);
    PrintEvaluation(stereo::Evaluate(disparity, truth.disparity, truth.masks));
  }
  return EXIT_SUCCESS;
}

// ---- A data set

struct Pair {
  std::string name;
  double scale = 1.0;
  int max_disparity = 0;
};

/// name,scale,max_disparity under a line of headings.
std::vector<Pair> ReadPairs(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": no file that can be read");
  std::vector<Pair> pairs;
  std::string line;
  std::getline(in, line);
  for (int number = 2; std::getline(in, line); ++number) {
    if (line.empty() || line == "\r") continue;
    std::istringstream fields(line);
    Pair pair;
    char comma = ' ';
    std::getline(fields, pair.name, ',');
    fields >> pair.scale >> comma >> pair.max_disparity;
    if (!fields || comma != ',' || pair.name.empty() || !(pair.scale > 0.0)) {
      throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": \"" + line +
                               "\" is not name,scale,max_disparity");
    }
    pairs.push_back(pair);
  }
  if (pairs.empty()) throw std::runtime_error(file.string() + ": lists no pairs");
  return pairs;
}

void PrintRow(const Row& row) {
  const stereo::Evaluation& e = row.evaluation;
  std::cout << std::left << std::setw(18) << row.pair << std::setw(16) << row.engine << std::right
            << std::fixed << std::setprecision(2);
  for (const double share :
       {e.bad_non_occluded, e.bad_near_discontinuities, e.bad_all, e.density, e.bad_matched}) {
    std::cout << std::setw(9) << kPercent * share;
  }
  std::cout << std::setprecision(1) << std::setw(9) << row.milliseconds << std::endl;
}

/// Of each engine, in the order of the rows.
std::vector<Row> Means(const std::vector<Row>& rows) {
  std::vector<Row> means;
  std::map<std::string, int> counts;
  for (const Row& row : rows) {
    auto mean =
        std::find_if(means.begin(), means.end(), [&](const Row& m) { return m.engine == row.engine; });
    if (mean == means.end()) mean = means.insert(mean, {"mean", row.engine, {}, 0.0});
    const double n = ++counts[row.engine];
    const auto add = [n](double& to, double value) { to += (value - to) / n; };
    add(mean->evaluation.bad_non_occluded, row.evaluation.bad_non_occluded);
    add(mean->evaluation.bad_near_discontinuities, row.evaluation.bad_near_discontinuities);
    add(mean->evaluation.bad_all, row.evaluation.bad_all);
    add(mean->evaluation.density, row.evaluation.density);
    add(mean->evaluation.bad_matched, row.evaluation.bad_matched);
    add(mean->milliseconds, row.milliseconds);
  }
  return means;
}

void WriteJson(const fs::path& file, const std::vector<Row>& rows) {
  nlohmann::json report;
  report["rows"] = nlohmann::json::array();
  for (const Row& row : rows) {
    const stereo::Evaluation& e = row.evaluation;
    report["rows"].push_back({{"pair", row.pair},
                              {"engine", row.engine},
                              {"bad_nonocc", kPercent * e.bad_non_occluded},
                              {"bad_disc", kPercent * e.bad_near_discontinuities},
                              {"bad_all", kPercent * e.bad_all},
                              {"density", kPercent * e.density},
                              {"bad_matched", kPercent * e.bad_matched},
                              {"ms", row.milliseconds}});
  }
  std::ofstream out(file);
  out << report.dump(2) << '\n';
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

int MatchDataset(const Args& args) {
  std::vector<std::string> engines = args.engines;
  if (engines.empty()) engines.assign(stereo::EngineNames().begin(), stereo::EngineNames().end());
  std::cout << std::left << std::setw(18) << "pair" << std::setw(16) << "engine" << std::right << std::setw(9)
            << "nonocc %" << std::setw(9) << "disc %" << std::setw(9) << "all %" << std::setw(9) << "density"
            << std::setw(9) << "matched%" << std::setw(9) << "ms" << '\n';
  std::vector<Row> rows;
  for (const Pair& pair : ReadPairs(args.dataset / "pairs.csv")) {
    const fs::path folder = args.dataset / pair.name;
    const ByteImage left = stereo::ReadImage(folder / "left.png");
    const ByteImage right = stereo::ReadImage(folder / "right.png");
    const bool has_masks = fs::exists(folder / kNonOccludedMask);
    const Truth truth = ReadTruth(folder / "gt.png", folder / "gt_right.png", pair.scale,
                                  has_masks ? folder : fs::path(), left);
    for (const std::string& engine : engines) {
      Row row{pair.name, engine, {}, 0.0};
      const auto matcher = MakeMatcher(engine, pair.max_disparity, args.threads);
      const DisparityMap disparity = MatchTimed(*matcher, left, right, row.milliseconds);
      row.evaluation = stereo::Evaluate(disparity, truth.disparity, truth.masks);
      PrintRow(row);
      rows.push_back(row);
    }
  }
  for (const Row& mean : Means(rows)) PrintRow(mean);
  if (!args.json.empty()) WriteJson(args.json, rows);
  return EXIT_SUCCESS;
}

}  // namespace

void AddStereo(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  args->out = "stereo";
  CLI::App* command = app.add_subcommand("stereo", "Match a stereo pair, or every pair of a data set");
  auto* left = command->add_option("left", args->left, "Image of the left camera");
  auto* right = command->add_option("right", args->right, "Image of the right camera");
  left->needs(right);
  command->add_option("--calibration", args->calibration, "OpenCV's stereo YAML; without: rectified already");
  std::string engines;
  for (const std::string_view name : stereo::EngineNames()) engines += " " + std::string(name);
  command->add_option("--engine", args->engines, "One or, for a data set, several of:" + engines)
      ->delimiter(',');
  command->add_option("--max-disparity", args->max_disparity, "Disparities below it are searched")
      ->capture_default_str();
  command->add_option("--threads", args->threads, "0 = one a core")->capture_default_str();
  command->add_option("--out", args->out, "Folder for disparity.pfm, disparity.png, cloud.ply")
      ->capture_default_str();
  auto* truth = command->add_option("--ground-truth", args->ground_truth, "Picture of the true disparity");
  command->add_option("--scale", args->scale, "Grey values of the ground truth a pixel of disparity")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--masks", args->masks, "Folder of mask_nonocc.png, mask_disc.png, mask_all.png")
      ->needs(truth);
  auto* dataset = command->add_option("--dataset", args->dataset,
                                      "Folder with pairs.csv (name,scale,max_disparity) and a folder a pair");
  dataset->excludes(left);
  command->add_option("--json", args->json, "The table of a data set as a file")->needs(dataset);
  command->callback([args, &exit_code] {
    if (args->dataset.empty() && args->right.empty()) {
      throw CLI::RequiredError("LEFT and RIGHT, or --dataset");
    }
    exit_code = args->dataset.empty() ? MatchPair(*args) : MatchDataset(*args);
  });
}

}  // namespace thalweg::cli
