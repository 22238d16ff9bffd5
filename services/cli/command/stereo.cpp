#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>

#include "common/files/write_file.h"
#include "services/cli/command/command.h"
#include "services/cli/command/number_range.h"
#include "services/stereo/evaluation/benchmark.h"
#include "services/stereo/evaluation/pair.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;

struct StereoArgs {
  stereo::PairFiles files;
  stereo::PairOptions options;
  std::vector<std::string> engines;
  fs::path out = "stereo";
  fs::path dataset;
  fs::path json;
};

int MatchPair(const StereoArgs& args) {
  stereo::PairOptions options = args.options;
  if (!args.engines.empty()) options.engine = args.engines.front();
  CheckFolderWritable(args.out);
  const stereo::PairResult result = stereo::MatchFiles(args.files, options);
  stereo::WriteResult(result, options, args.out);
  std::cout << stereo::Describe(result, options);
  return EXIT_SUCCESS;
}

int MatchDataset(const StereoArgs& args) {
  if (!args.json.empty()) CheckWritable(args.json);
  std::cout << stereo::BenchmarkHeading() << std::flush;
  stereo::BenchmarkListener listener;
  listener.row = [](const auto& row) { std::cout << stereo::ToText(row) << std::flush; };
  listener.remark = [](const std::string& remark) { std::cout << remark << std::flush; };
  listener.mistake = [](const std::string& mistake) { std::cerr << mistake << std::endl; };
  const stereo::Benchmark benchmark =
      stereo::RunBenchmark({args.dataset, args.engines, args.options.matcher}, listener);
  if (!benchmark.rows.empty()) {
    for (const std::string& engine : benchmark.engines) {
      std::cout << stereo::ToText(stereo::MeanRow(benchmark.rows, engine));
    }
  }
  if (!args.json.empty()) {
    using nlohmann::json;  // names of pairs may contain any character
    const auto replace = json::error_handler_t::replace;
    WriteFile(args.json, stereo::ToJson(benchmark).dump(2, ' ', false, replace) + '\n');
  }
  if (benchmark.mistakes.empty()) return EXIT_SUCCESS;
  std::cerr << benchmark.failed << " of " << benchmark.pairs
            << " pairs could not be judged, or not by every engine\n";
  return EXIT_FAILURE;
}

}  // namespace

void AddStereo(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<StereoArgs>();
  CLI::App* command =
      app.add_subcommand("stereo", "Match a stereo pair, or every pair of a data set, and rate the result");
  auto* left = command->add_option("left", args->files.left, "Image of the left camera");
  auto* right = command->add_option("right", args->files.right, "Image of the right camera");
  left->needs(right);
  auto* calibration =
      command
          ->add_option("--calibration", args->files.calibration,
                       "OpenCV's stereo YAML, or its INTRINSICS,EXTRINSICS; without it the images "
                       "are taken as rectified")
          ->delimiter(',')
          ->expected(1, 2)
          ->allow_extra_args(false);
  std::string engines;
  for (const std::string_view name : stereo::EngineNames()) engines += " " + std::string(name);
  command->add_option("--engine", args->engines, "One, or with --dataset several, of:" + engines)
      ->delimiter(',')
      ->allow_extra_args(false);
  stereo::MatcherOptions& matcher = args->options.matcher;
  auto* range =
      command->add_option("--max-disparity", matcher.max_disparity, "Disparities below it are searched [px]")
          ->capture_default_str();
  command->add_option("--threads", matcher.threads, "0 = one per core")->capture_default_str();
  command->add_option("--window-px", matcher.sad5.window, "sad5-*: side of each of its windows [px]")
      ->capture_default_str();
  command->add_option("--uniqueness", matcher.sad5.uniqueness, "sad5-*: least (C2 - C1) / C1")
      ->capture_default_str()
      ->check(NotNegative());
  command->add_option("--seed", matcher.best.surfaces.seed, "best: seed of its search for planes")
      ->capture_default_str();
  command->add_flag(
      "!--no-fill", matcher.best.fill_surfaces,
      "best: do not fill textureless surfaces with planes; the service does not fill them either");
  auto* refine = command->add_flag("--refine", args->options.refine,
                                   "Refine disparities for a cloud, as the service does");
  auto* depth_error = command
                          ->add_option("--max-depth-error-m", args->options.triangulation.max_depth_error,
                                       "Leave points with a larger depth error out of cloud.ply [m]")
                          ->capture_default_str()
                          ->check(Positive())
                          ->needs(calibration);
  auto* out =
      command->add_option("--out", args->out, "Folder to write disparity.pfm, disparity.png and cloud.ply to")
          ->capture_default_str();
  auto* truth = command->add_option("--ground-truth", args->files.truth, "True disparity, a picture or PFM");
  auto* truth_right = command
                          ->add_option("--ground-truth-right", args->files.truth_right,
                                       "The same for the right image: shows what is occluded")
                          ->needs(truth);
  auto* scale =
      command
          ->add_option("--scale", args->files.scale, "Gray values of the ground truth per pixel of disparity")
          ->check(Positive())
          ->capture_default_str()
          ->needs(truth);
  auto* masks =
      command->add_option("--masks", args->files.masks, "Folder with mask_nonocc, mask_disc, mask_all")
          ->check(CLI::ExistingDirectory)
          ->needs(truth);
  auto* dataset =
      command->add_option("--dataset", args->dataset,
                          "Folder with pairs.csv (name,scale,max_disparity) and one folder per pair: "
                          "left, right, gt, and gt_right or mask_*");
  for (CLI::Option* const of_a_pair :
       {left, calibration, range, refine, depth_error, out, truth, truth_right, scale, masks}) {
    dataset->excludes(of_a_pair);
  }
  command->add_option("--json", args->json, "Where to write the table of a data set as JSON")->needs(dataset);
  command->callback([args, &exit_code] {
    if (args->dataset.empty() && args->files.right.empty()) {
      throw CLI::RequiredError("LEFT and RIGHT, or --dataset");
    }
    if (args->dataset.empty() && args->engines.size() > 1) {
      throw CLI::ValidationError("--engine", "give one for a pair; several are for --dataset");
    }
    exit_code = args->dataset.empty() ? MatchPair(*args) : MatchDataset(*args);
  });
}

}  // namespace thalweg::cli
