#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>

#include "common/base/stopwatch.h"
#include "common/base/text.h"
#include "common/files/write_file.h"
#include "common/scenario/scenario.h"
#include "common/service/command_line.h"
#include "common/service/service.h"
#include "services/cli/adapter/evaluation_files.h"
#include "services/cli/adapter/flown_outcomes.h"
#include "services/cli/command/command.h"
#include "services/cli/command/list.h"
#include "services/cli/command/number_range.h"
#include "services/cli/report/evaluation_progress.h"
#include "services/cli/report/evaluation_report.h"
#include "services/evaluator/adapter/campaign.h"
#include "services/evaluator/adapter/optimum.h"
#include "services/evaluator/adapter/outcome_json.h"

namespace thalweg::cli {
namespace {

using evaluator::Campaign;
using evaluator::Outcome;

struct EvaluateArgs {
  Campaign::Options campaign{
      .scenarios = {kDefaultScenario}, .overrides = {}, .strategies = {"closest", "cover"}, .journal = {}};
  std::string json;
  std::string report;
  std::string shard;  ///< "K/N"
  std::vector<std::filesystem::path> trajectories;
  std::string surface;  ///< Folder of the meshes; empty = none.
  bool makes_runs = true;
  bool optimum = false;
  evaluator::TourGround::Options tours;
};

struct Made {
  std::vector<Outcome> outcomes;
  std::size_t total = 0;  ///< How many there would be if it had not been stopped.
};

Made MakeRuns(const EvaluateArgs& args, const std::stop_token& stop) {
  Campaign campaign(args.campaign);
  if (!args.campaign.merged.empty() && campaign.resumed() < campaign.total()) {
    throw std::runtime_error(fmt::format(
        "--merge: {} of {} runs are in none of the files; they must be of this program and of the same "
        "scenarios and options",
        campaign.total() - campaign.resumed(), campaign.total()));
  }
  const ProgressBar bar(campaign.total(), campaign.resumed(), isatty(STDOUT_FILENO) != 0);
  fmt::print("{}", bar.Beginning());
  const Stopwatch watch;
  const auto show = [&](const Outcome& outcome, std::size_t made) {
    fmt::print("{}", bar.After(outcome, made, watch.Milliseconds() * 1e-3));
    std::fflush(stdout);
  };
  return {campaign.Run(stop, show), campaign.total()};
}

void FindTours(const EvaluateArgs& args, const std::stop_token& stop, std::vector<Outcome>& outcomes) {
  if (!args.optimum) return;
  evaluator::OptimumOptions options{.scenarios = args.campaign.scenarios,
                                    .overrides = args.campaign.overrides,
                                    .tours = args.tours,
                                    .cache = {},
                                    .threads = args.campaign.threads};
  if (!args.campaign.journal.empty()) options.cache = args.campaign.journal.string() + ".optimum";
  evaluator::AddOptimum(options, outcomes, stop, [](const Outcome& outcome, bool from_cache) {
    fmt::print("{}\n", TourText(outcome, from_cache));
    std::fflush(stdout);
  });
}

int Evaluate(const EvaluateArgs& args) {
  const std::stop_token stop = StopOnSignals();
  CheckWritable({args.json, args.campaign.journal});
  if (!args.surface.empty() && !args.makes_runs)
    throw std::invalid_argument("--surface is for runs, and --trajectory makes none");
  if (!args.report.empty()) CheckFolderWritable(args.report);
  // Meshes of merged parts are where these were made.
  if (!args.surface.empty() && args.campaign.merged.empty()) CheckFolderWritable(args.surface);
  const auto check_nothing_moves = [&](const std::string& option) {
    evaluator::CheckNothingMoves(args.campaign.scenarios, args.campaign.overrides, option);
  };
  if (args.optimum) check_nothing_moves("--optimum");
  if (!args.surface.empty()) check_nothing_moves("--surface");
  Made made;
  if (args.makes_runs) made = MakeRuns(args, stop);
  const std::vector<Outcome> flown = JudgeTrajectories(args.trajectories, args.campaign, stop);
  made.outcomes.insert(made.outcomes.end(), flown.begin(), flown.end());
  made.total += args.trajectories.size();
  FindTours(args, stop, made.outcomes);
  const std::vector<Outcome>& outcomes = made.outcomes;
  if (made.total == 0) {
    std::cout << "no run is in this shard\n";
    return EXIT_SUCCESS;
  }
  if (outcomes.empty()) {
    std::cerr << "thalweg: stopped before the first run was made\n";
    return EXIT_FAILURE;
  }
  std::cout << "\n" << EvaluationText(outcomes, args.campaign.overrides);
  if (!args.json.empty()) {
    const nlohmann::ordered_json json = evaluator::EvaluationJson(outcomes, args.campaign.overrides);
    WriteFile(args.json, json.dump(1) + '\n');
  }
  if (!args.report.empty()) WriteEvaluation(outcomes, args.campaign, args.report);
  if (outcomes.size() < made.total) {
    std::cerr << "thalweg: stopped after " << outcomes.size() << " of " << made.total << " runs; "
              << (args.campaign.journal.empty() ? "without --journal or --json they are not kept"
                                                : "the same command continues with the others")
              << '\n';
    return EXIT_FAILURE;
  }
  const auto has_tours = [](const Outcome& outcome) { return outcome.optimum.has_value(); };
  if (args.optimum && !std::ranges::all_of(outcomes, has_tours)) {
    std::cerr << "thalweg: stopped before all tours were found; the same command continues\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}

}  // namespace

void AddEvaluate(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<EvaluateArgs>();
  CLI::App* command = app.add_subcommand(
      "evaluate", "Compare strategies over many simulated runs, in one process and faster than real time");
  command->footer("Strategies:\n" + StrategyLines("  ", ""));
  command->add_option("--scenario", args->campaign.scenarios, "Scenarios, names or files: A,B,...")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--strategy", args->campaign.strategies,
                   "Strategies: X,Y,...; the others are compared with the first")
      ->delimiter(',')
      ->capture_default_str();
  const NamedValues<evaluator::PoseSource> sources = {{"truth", evaluator::PoseSource::kTruth},
                                                      {"odometry", evaluator::PoseSource::kOdometry}};
  std::vector<std::string> default_sources;
  for (const evaluator::PoseSource source : args->campaign.poses)
    default_sources.push_back(NameAmong(sources, source));
  command
      ->add_option("--pose", args->campaign.poses,
                   "Where the robot's pose comes from: truth (the simulator), odometry (the images of the "
                   "scenario's stereo_camera), or truth,odometry for both")
      ->delimiter(',')
      ->transform(OneOf(sources))
      ->type_name("NAME")
      ->default_str(Joined(default_sources, ","));
  const NamedValues<evaluator::MotionModel> motions = {{"kinematic", evaluator::MotionModel::kKinematic},
                                                       {"dynamic", evaluator::MotionModel::kDynamic}};
  command
      ->add_option(
          "--motion", args->campaign.motion,
          "How the robot moves: kinematic (at once at full speed, turning meanwhile), or dynamic (as the "
          "controller leads it, within its accelerations; with the true pose only)")
      ->transform(OneOf(motions))
      ->type_name("NAME")
      ->default_str(NameAmong(motions, args->campaign.motion));
  command
      ->add_option("--runs", args->campaign.runs,
                   "Runs of each strategy in each scenario; start k is the same for all strategies")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command
      ->add_option("--seed", args->campaign.seed,
                   "Seed of the first start; each further start takes the next")
      ->check(CLI::Range(1, 1000000000))
      ->capture_default_str();
  command->add_option("--threads", args->campaign.threads, "0 = one per core; results do not depend on it")
      ->check(CLI::Range(0, 1024));
  command
      ->add_option("--set", args->campaign.overrides,
                   "Override a field of the scenarios, FIELD=VALUE; may be repeated")
      ->allow_extra_args(false);
  command->add_option(
      "--json", args->json,
      "Where to write all results as JSON: {\"overrides\": [...], \"rows\": [...], \"comparisons\": "
      "[...], \"runs\": [...]}");
  command->add_option("--report", args->report,
                      "Folder to write index.html with tables, curves and paths to");
  command->add_option(
      "--journal", args->campaign.journal,
      "File of finished runs, from which an interrupted evaluation continues; default: the JSON file + "
      ".journal");
  command->add_option(
      "--shard", args->shard,
      "K/N: make only every Nth start, from the Kth; a part of a campaign on several machines");
  command
      ->add_option("--merge", args->campaign.merged,
                   "Journals of all parts: make no runs, but tables and report of the whole")
      ->check(CLI::ExistingFile);
  command
      ->add_option(
          "--trajectory", args->trajectories,
          "Trajectory of the body in map that another program flew, in TUM's format, to be judged as our "
          "runs are; without --strategy nothing else is run. May be repeated")
      ->check(CLI::ExistingFile)
      ->allow_extra_args(false);
  command->add_flag("--optimum", args->optimum,
                    "Compare paths with offline tours from the same starts, of a robot that knows the world: "
                    "an upper bound of the optimum. Kept beside the journal");
  command
      ->add_option("--budget-s", args->tours.budget,
                   "Longest search for the tours from one start; where it ends a search, tours may differ "
                   "from one machine to another")
      ->check(NumberFrom(0.1, 1e6))
      ->capture_default_str();
  command
      ->add_option("--surface", args->surface,
                   "Folder: fuse all scans of each run into a surface, write its mesh there as "
                   "SCENARIO-STRATEGY-SEED.ply (and, as a picture, .png), and print how much of the true "
                   "surface was seen how well")
      ->check(CLI::Validator([](const std::string& folder) { return folder.empty() ? "is empty" : ""; },
                             "FOLDER"));
  command->add_flag("--tail", args->campaign.tail,
                    "Say where the paths go after 95 % coverage: journeys and their targets");
  command->callback([args, command, &exit_code] {
    args->makes_runs = args->trajectories.empty() || command->count("--strategy") > 0;
    if (!args->surface.empty()) args->campaign.meshes = args->surface;
    if (!args->shard.empty()) args->campaign.shard = evaluator::ShardFrom(args->shard);
    if (args->campaign.journal.empty() && !args->json.empty())
      args->campaign.journal = args->json + ".journal";
    exit_code = Evaluate(*args);
  });
}

}  // namespace thalweg::cli
