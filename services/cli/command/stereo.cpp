#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "common/base/stopwatch.h"
#include "services/cli/command/command.h"
#include "services/stereo/adapter/calibration_file.h"
#include "services/stereo/adapter/ground_truth.h"
#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/matcher.h"
#include "services/stereo/core/refinement.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;
using stereo::ByteImage;
using stereo::DisparityMap;

constexpr double kPercent = 100.0;
constexpr double kLeastDisparity = 1.0;  // [px] of a cloud without calibration

struct Args {
  fs::path left, right, out, ground_truth, ground_truth_right, masks, dataset, json;
  std::vector<fs::path> calibration;
  std::vector<std::string> engines;
  double scale = 1.0;
  bool refine = false;
  stereo::MatcherOptions matcher;
  stereo::TriangulationOptions triangulation;
};

struct Row {
  std::string pair;
  std::string engine;
  stereo::Evaluation evaluation;
  double milliseconds = 0.0;
};

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

/// Nothing is known in metres: all that has a disparity worth the name.
stereo::TriangulationOptions WithoutMetres(const StereoGeometry& camera) {
  stereo::TriangulationOptions options;
  options.min_depth = 0.0;
  options.max_depth = camera.camera.fx * camera.baseline / kLeastDisparity;
  options.max_depth_error = std::numeric_limits<double>::infinity();
  return options;
}

/// A percentage; "-" where there was nothing to judge by.
std::string Percent(double share) {
  if (std::isnan(share)) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << kPercent * share;
  return text.str();
}

void PrintEvaluation(const stereo::Evaluation& e, const stereo::GroundTruth& truth) {
  std::cout << "bad pixels (> 1 px) in %: non-occluded " << Percent(e.bad_non_occluded)
            << ", near discontinuities " << Percent(e.bad_near_discontinuities) << ", all "
            << Percent(e.bad_all) << ", of the matched " << Percent(e.bad_matched)
            << "\n  non-occluded as told by " << truth.non_occluded_from << '\n';
}

/// A line for people where the truth cannot be found for its size; else empty.
std::string BeyondRange(const stereo::GroundTruth& truth, int max_disparity) {
  float greatest = 0.0F;
  for (const float d : truth.disparity.data()) greatest = d > greatest ? d : greatest;  // not NaN
  if (greatest < static_cast<float>(max_disparity)) return "";
  std::ostringstream text;
  text << "  the ground truth reaches " << greatest << " px, those below " << max_disparity
       << " are searched: is its scale right, and the range?\n";
  return text.str();
}

int MatchPair(const Args& args) {
  ByteImage left = stereo::ReadImage(args.left);
  ByteImage right = stereo::ReadImage(args.right);
  stereo::CheckPair(left, right);
  StereoGeometry camera = UnknownCamera(left);
  stereo::TriangulationOptions triangulation = WithoutMetres(camera);
  if (!args.calibration.empty()) {
    const StereoRectifier rectifier(
        stereo::ReadCalibration(args.calibration, stereo::ImageSize{left.width(), left.height()}));
    left = stereo::Rectify(rectifier, Side::kLeft, left);
    right = stereo::Rectify(rectifier, Side::kRight, right);
    camera = rectifier.geometry();
    triangulation = args.triangulation;
  }
  std::optional<stereo::GroundTruth> truth;
  if (!args.ground_truth.empty()) {
    truth = stereo::ReadGroundTruth(args.ground_truth, args.ground_truth_right, args.scale, args.masks, left);
  }
  const std::string engine = args.engines.empty() ? stereo::kBestEngine : args.engines.front();
  const auto matcher = stereo::MakeMatcher(engine, args.matcher);
  double milliseconds = 0.0;
  DisparityMap disparity = MatchTimed(*matcher, left, right, milliseconds);
  if (args.refine) {
    stereo::Refine(stereo::ToGray(left), stereo::ToGray(right), {},
                   static_cast<std::size_t>(args.matcher.threads), disparity);
  }

  fs::create_directories(args.out);
  stereo::WritePfm(args.out / "disparity.pfm", disparity);
  stereo::WriteColored(args.out / "disparity.png", disparity, args.matcher.max_disparity);
  const PointCloud cloud = stereo::Triangulate(disparity, left, camera, triangulation);
  stereo::WritePly(args.out / "cloud.ply", cloud);
  const auto points = std::count_if(cloud.points_C.begin(), cloud.points_C.end(),
                                    [](const Eigen::Vector3f& p_C) { return p_C.allFinite(); });
  std::cout << std::fixed << std::setprecision(1) << engine << ": density "
            << kPercent * stereo::Density(disparity) << " %, " << milliseconds << " ms\n"
            << "cloud.ply: " << points << " points, depths to " << FarthestDepth(camera, triangulation)
            << (args.calibration.empty() ? " baselines, for a lens as wide as the image (no --calibration)"
                                         : " m")
            << '\n';
  const std::string why = stereo::WhyNoMatches(disparity, left, right, args.matcher.max_disparity);
  if (!why.empty()) std::cout << why << '\n';
  if (points == 0 && stereo::Density(disparity) > 0.0) {
    std::cout << "no point of the cloud is left: the baseline is " << std::setprecision(3) << camera.baseline
              << " m; is the calibration in metres?\n";
  }
  if (truth) {
    PrintEvaluation(stereo::Evaluate(disparity, truth->disparity, truth->masks), *truth);
    std::cout << BeyondRange(*truth, args.matcher.max_disparity);
  }
  return EXIT_SUCCESS;
}

// ---- A data set

void PrintRow(const Row& row) {
  const stereo::Evaluation& e = row.evaluation;
  std::cout << std::left << std::setw(18) << row.pair << std::setw(16) << row.engine << std::right;
  for (const double share :
       {e.bad_non_occluded, e.bad_near_discontinuities, e.bad_all, e.density, e.bad_matched}) {
    std::cout << std::setw(9) << Percent(share);
  }
  std::cout << std::fixed << std::setprecision(1) << std::setw(9) << row.milliseconds << std::endl;
}

/// The mean of those rows that have one; NaN of none.
template <class ValueOf>
double MeanOf(const std::vector<Row>& rows, const std::string& engine, ValueOf&& value_of) {
  double sum = 0.0;
  double count = 0.0;
  for (const Row& row : rows) {
    const double value = value_of(row);
    if (row.engine != engine || std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  return sum / count;
}

Row MeanRow(const std::vector<Row>& rows, const std::string& engine) {
  const auto mean = [&](double stereo::Evaluation::*share) {
    return MeanOf(rows, engine, [share](const Row& row) { return row.evaluation.*share; });
  };
  using stereo::Evaluation;
  return {"mean",
          engine,
          {mean(&Evaluation::bad_non_occluded), mean(&Evaluation::bad_near_discontinuities),
           mean(&Evaluation::bad_all), mean(&Evaluation::density), mean(&Evaluation::bad_matched)},
          MeanOf(rows, engine, [](const Row& row) { return row.milliseconds; })};
}

nlohmann::json JsonPercent(double share) {
  return std::isnan(share) ? nlohmann::json() : nlohmann::json(kPercent * share);
}

void WriteJson(const fs::path& file, const std::vector<Row>& rows, const std::vector<std::string>& mistakes) {
  nlohmann::json report;
  report["rows"] = nlohmann::json::array();
  for (const Row& row : rows) {
    const stereo::Evaluation& e = row.evaluation;
    report["rows"].push_back({{"pair", row.pair},
                              {"engine", row.engine},
                              {"bad_nonocc", JsonPercent(e.bad_non_occluded)},
                              {"bad_disc", JsonPercent(e.bad_near_discontinuities)},
                              {"bad_all", JsonPercent(e.bad_all)},
                              {"density", JsonPercent(e.density)},
                              {"bad_matched", JsonPercent(e.bad_matched)},
                              {"ms", row.milliseconds}});
  }
  if (!mistakes.empty()) report["errors"] = mistakes;
  std::ofstream out(file);
  using nlohmann::json;
  out << report.dump(2, ' ', false, json::error_handler_t::replace) << '\n';  // names may be anything
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

/// Prints and adds the rows of one pair.
void MatchListed(const Args& args, const stereo::ListedPair& pair, const std::vector<std::string>& engines,
                 std::vector<Row>& rows, std::vector<std::string>& mistakes) {
  const fs::path folder = args.dataset / pair.name;
  const ByteImage left = stereo::ReadImage(stereo::RequirePicture(folder, "left"));
  const ByteImage right = stereo::ReadImage(stereo::RequirePicture(folder, "right"));
  const stereo::GroundTruth truth =
      stereo::ReadGroundTruth(stereo::RequirePicture(folder, "gt"), stereo::FindPicture(folder, "gt_right"),
                              pair.scale, folder, left);
  stereo::MatcherOptions options = args.matcher;
  options.max_disparity = pair.max_disparity;
  stereo::CheckPair(left, right);
  stereo::MakeMatcher(engines.front(), options);  // throws what holds for every engine
  for (const std::string& engine : engines) {
    Row row{pair.name, engine, {}, 0.0};
    try {
      const auto matcher = stereo::MakeMatcher(engine, options);
      const DisparityMap disparity = MatchTimed(*matcher, left, right, row.milliseconds);
      row.evaluation = stereo::Evaluate(disparity, truth.disparity, truth.masks);
      PrintRow(row);
      const std::string why = stereo::WhyNoMatches(disparity, left, right, options.max_disparity);
      if (!why.empty()) std::cout << "  " << why << std::endl;
      rows.push_back(row);
    } catch (const std::exception& error) {  // one engine's limit is not the end of the others
      mistakes.push_back(pair.where + ": " + pair.name + ", " + engine + ": " + error.what());
      std::cerr << mistakes.back() << std::endl;
    }
  }
  std::cout << BeyondRange(truth, options.max_disparity) << std::flush;
}

int MatchDataset(const Args& args) {
  std::vector<std::string> engines = args.engines;
  if (engines.empty()) engines.assign(stereo::EngineNames().begin(), stereo::EngineNames().end());
  for (const std::string& engine : engines)
    stereo::MakeMatcher(engine, args.matcher);  // throws if there is none
  const stereo::PairList list = stereo::ReadPairs(args.dataset / "pairs.csv");
  if (!args.json.empty() && !std::ofstream(args.json, std::ios::app)) {  // before the work, not after it
    throw std::runtime_error(args.json.string() + ": cannot be written");
  }
  std::cout << std::left << std::setw(18) << "pair" << std::setw(16) << "engine" << std::right << std::setw(9)
            << "nonocc %" << std::setw(9) << "disc %" << std::setw(9) << "all %" << std::setw(9) << "density"
            << std::setw(9) << "matched%" << std::setw(9) << "ms" << std::endl;
  std::vector<Row> rows;
  std::vector<std::string> mistakes = list.mistakes;
  for (const std::string& mistake : mistakes) std::cerr << mistake << std::endl;
  std::size_t failed = mistakes.size();
  for (const stereo::ListedPair& pair : list.pairs) {
    const std::size_t before = mistakes.size();
    try {
      MatchListed(args, pair, engines, rows, mistakes);
    } catch (const std::exception& error) {  // one bad pair is not the end of the others
      mistakes.push_back(pair.where + ": " + pair.name + ": " + error.what());
      std::cerr << mistakes.back() << std::endl;
    }
    failed += mistakes.size() > before ? 1 : 0;
  }
  if (!rows.empty()) {
    for (const std::string& engine : engines) PrintRow(MeanRow(rows, engine));
  }
  if (!args.json.empty()) WriteJson(args.json, rows, mistakes);
  if (mistakes.empty()) return EXIT_SUCCESS;
  std::cerr << failed << " of " << list.pairs.size() + list.mistakes.size()
            << " pairs could not be judged, or not by every engine\n";
  return EXIT_FAILURE;
}

CLI::Validator NotNegative() {
  return {[](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= 0.0;
            return good ? std::string() : "is " + text + ", must be a number >= 0";
          },
          "NONNEGATIVE"};
}

/// A finite number > 0: CLI11's own check takes NaN and infinity for one.
CLI::Validator Positive() {
  return {[](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0.0;
            return good ? std::string() : "is " + text + ", must be a number > 0";
          },
          "POSITIVE"};
}

}  // namespace

void AddStereo(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  args->out = "stereo";
  CLI::App* command = app.add_subcommand("stereo", "Match a stereo pair, or every pair of a data set");
  auto* left = command->add_option("left", args->left, "Image of the left camera");
  auto* right = command->add_option("right", args->right, "Image of the right camera");
  left->needs(right);
  auto* calibration =
      command
          ->add_option("--calibration", args->calibration,
                       "OpenCV's stereo YAML, or its intrinsics,extrinsics; without: rectified "
                       "already")
          ->delimiter(',')
          ->expected(1, 2)
          ->allow_extra_args(false);
  std::string engines;
  for (const std::string_view name : stereo::EngineNames()) engines += " " + std::string(name);
  command->add_option("--engine", args->engines, "One or, for a data set, several of:" + engines)
      ->delimiter(',')
      ->allow_extra_args(false);
  stereo::MatcherOptions& matcher = args->matcher;
  auto* range =
      command->add_option("--max-disparity", matcher.max_disparity, "Disparities below it are searched")
          ->capture_default_str();
  command->add_option("--threads", matcher.threads, "0 = one a core")->capture_default_str();
  command->add_option("--window-px", matcher.sad5.window, "sad5-*: side of each of its windows")
      ->capture_default_str();
  command->add_option("--uniqueness", matcher.sad5.uniqueness, "sad5-*: least (C2 - C1) / C1")
      ->capture_default_str()
      ->check(NotNegative());
  command->add_option("--seed", matcher.best.surfaces.seed, "best: of its search for planes")
      ->capture_default_str();
  command->add_flag("!--no-fill", matcher.best.fill_surfaces,
                    "best: guess no planes over surfaces without texture, as the service");
  auto* refine =
      command->add_flag("--refine", args->refine, "Refine disparities for a cloud, as the service");
  auto* depth_error = command
                          ->add_option("--max-depth-error-m", args->triangulation.max_depth_error,
                                       "Of the points of cloud.ply, at most")
                          ->capture_default_str()
                          ->check(Positive())
                          ->needs(calibration);
  auto* out = command->add_option("--out", args->out, "Folder for disparity.pfm, disparity.png, cloud.ply")
                  ->capture_default_str();
  auto* truth =
      command->add_option("--ground-truth", args->ground_truth, "Picture of the true disparity, or PFM");
  auto* truth_right = command
                          ->add_option("--ground-truth-right", args->ground_truth_right,
                                       "The same of the right image: tells what is occluded")
                          ->needs(truth);
  auto* scale =
      command->add_option("--scale", args->scale, "Grey values of the ground truth a pixel of disparity")
          ->check(Positive())
          ->capture_default_str()
          ->needs(truth);
  auto* masks = command->add_option("--masks", args->masks, "Folder of mask_nonocc, mask_disc, mask_all")
                    ->check(CLI::ExistingDirectory)
                    ->needs(truth);
  auto* dataset = command->add_option("--dataset", args->dataset,
                                      "Folder with pairs.csv (name,scale,max_disparity) and a folder a pair: "
                                      "left, right, gt, and gt_right or mask_*");
  for (CLI::Option* const of_a_pair :
       {left, calibration, range, refine, depth_error, out, truth, truth_right, scale, masks}) {
    dataset->excludes(of_a_pair);
  }
  command->add_option("--json", args->json, "The table of a data set as a file")->needs(dataset);
  command->callback([args, &exit_code] {
    if (args->dataset.empty() && args->right.empty()) {
      throw CLI::RequiredError("LEFT and RIGHT, or --dataset");
    }
    if (args->dataset.empty() && args->engines.size() > 1) {
      throw CLI::ValidationError("--engine", "several are for --dataset, one is for a pair");
    }
    exit_code = args->dataset.empty() ? MatchPair(*args) : MatchDataset(*args);
  });
}

}  // namespace thalweg::cli
