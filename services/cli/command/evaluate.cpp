#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "common/base/stopwatch.h"
#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/report/evaluation_report.h"
#include "services/cli/report/live_line.h"
#include "services/evaluator/adapter/campaign.h"
#include "services/evaluator/adapter/outcome_json.h"

namespace thalweg::cli {
namespace {

using evaluator::Campaign;
using evaluator::Outcome;

struct Args {
  Campaign::Options campaign{
      .scenarios = {"kitchen"}, .overrides = {}, .strategies = {"closest", "potential"}, .journal = {}};
  std::string json;
  std::string report;
};

void Write(const std::filesystem::path& file, const std::string& text) {
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::ofstream stream(file);
  if (!(stream << text) || !stream.flush()) throw std::runtime_error(file.string() + " cannot be written");
}

/// A bar on a terminal, a line a run elsewhere.
class ProgressBar {
 public:
  explicit ProgressBar(const Campaign& campaign) : total_(campaign.total()), resumed_(campaign.resumed()) {
    if (resumed_ > 0) std::printf("%zu of %zu runs are there already\n", resumed_, total_);
  }

  void Tell(const Outcome& outcome, std::size_t made) {
    const double wall = watch_.Milliseconds() * 1e-3;
    const double left = wall * static_cast<double>(total_ - made) / static_cast<double>(made - resumed_);
    constexpr std::size_t kWidth = 30;
    const std::string bar(kWidth * made / total_, '=');
    std::printf("%s[%-30s] %zu/%zu, %s left  %s %s start %d: %s, %.1f m, coverage %.1f %%%s",
                terminal_ ? "\r\33[K" : "", bar.c_str(), made, total_, ClockText(left).c_str(),
                outcome.scenario.c_str(), outcome.strategy.c_str(), outcome.seed, ToText(outcome.end).c_str(),
                outcome.distance, 100.0 * outcome.coverage, terminal_ && made < total_ ? "" : "\n");
    std::fflush(stdout);
  }

 private:
  std::size_t total_;
  std::size_t resumed_;
  bool terminal_ = isatty(STDOUT_FILENO) != 0;
  Stopwatch watch_;
};

/// The true map as a map that knows it all.
OccupancyGrid GridOf(const simulator::TrueMap& truth, double voxel_size) {
  OccupancyGrid grid(voxel_size);
  for (std::size_t k = 0; k < truth.voxels().size(); ++k) {
    const simulator::TrueVoxel kind = truth.voxels()[k];
    if (kind == simulator::TrueVoxel::kFree) grid.Set(truth.voxels().IndexAt(k), -1.0F);
    if (kind == simulator::TrueVoxel::kSurface) grid.Set(truth.voxels().IndexAt(k), 1.0F);
  }
  return grid;
}

void WriteReport(const Args& args, const std::vector<Outcome>& outcomes) {
  const std::filesystem::path folder = args.report;
  std::filesystem::create_directories(folder);
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> pictures;
  for (const std::string& name : args.campaign.scenarios) {
    const evaluator::Scene scene(name, args.campaign.overrides);
    const auto truth = scene.Truth(scene.Start(args.campaign.seed).translation());
    const OccupancyGrid grid = GridOf(*truth, scene.Options("", 0).mapper.voxel_size);
    for (const auto& [kind, picture] : {std::pair("coverage", DrawCoverageCurves(outcomes, scene.name())),
                                        std::pair("paths", DrawPaths(outcomes, scene.name(), 0, grid))}) {
      std::vector<std::uint8_t>& png = pictures[scene.name()].emplace_back();
      cv::imencode(".png", picture, png);
      Write(folder / (scene.name() + "-" + kind + ".png"), std::string(png.begin(), png.end()));
    }
  }
  Write(folder / "index.html", EvaluationHtml(outcomes, pictures));
}

int Evaluate(const Args& args) {
  const std::stop_token stop = StopOnSignals();
  Campaign campaign(args.campaign);
  ProgressBar bar(campaign);
  const std::vector<Outcome> outcomes =
      campaign.Run(stop, [&](const Outcome& outcome, std::size_t made) { bar.Tell(outcome, made); });
  std::cout << "\n" << EvaluationText(outcomes);
  if (!args.json.empty()) {
    nlohmann::ordered_json json;
    json["rows"] = evaluator::RowsOf(outcomes);
    json["comparisons"] = evaluator::ComparisonsOf(outcomes);
    for (const Outcome& outcome : outcomes) json["runs"].push_back(evaluator::ToJson(outcome));
    Write(args.json, json.dump(1) + '\n');
  }
  if (!args.report.empty()) WriteReport(args, outcomes);
  if (outcomes.size() < campaign.total()) {
    std::cerr << "thalweg: stopped after " << outcomes.size() << " of " << campaign.total()
              << " runs; the same command goes on from there\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}

}  // namespace

void AddEvaluate(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  CLI::App* command = app.add_subcommand(
      "evaluate",
      "Compare strategies over many runs in lock step, without processes and faster than real time");
  command->add_option("--scenario", args->campaign.scenarios, "Names or files, A,B,...")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--strategy", args->campaign.strategies,
                   "X,Y,...; the first is what the others are compared with")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option(
          "--pose", args->campaign.poses,
          "truth, odometry or both: whether the robot is told its pose or finds it from the images of "
          "the scenario's stereo_camera")
      ->delimiter(',')
      ->transform(CLI::CheckedTransformer(std::map<std::string, evaluator::PoseSource>{
          {"truth", evaluator::PoseSource::kTruth}, {"odometry", evaluator::PoseSource::kOdometry}}))
      ->default_str("truth");
  command->add_option("--runs", args->campaign.runs, "Starts of each, the same for all strategies")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--seed", args->campaign.seed, "Of the first start; the next has the next")
      ->check(CLI::Range(1, 1000000000))
      ->capture_default_str();
  command->add_option("--threads", args->campaign.threads, "0 = one a core; outcomes do not depend on it")
      ->check(CLI::Range(0, 1024));
  command
      ->add_option("--set", args->campaign.overrides,
                   "field=value over the scenarios'; again for each further field")
      ->allow_extra_args(false);
  command->add_option("--json", args->json,
                      "File for all figures: {\"rows\": [...], \"comparisons\": [...], \"runs\": [...]}");
  command->add_option("--report", args->report, "Folder for index.html with tables, curves and paths");
  command->add_option(
      "--journal", args->campaign.journal,
      "File of finished runs, from which an interrupted evaluation goes on [JSON file + .journal]");
  command->callback([args, &exit_code] {
    if (args->campaign.journal.empty() && !args->json.empty())
      args->campaign.journal = args->json + ".journal";
    exit_code = Evaluate(*args);
  });
}

}  // namespace thalweg::cli
