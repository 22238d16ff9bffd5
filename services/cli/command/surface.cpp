#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/cli/adapter/rift_runs.h"
#include "services/cli/adapter/simulated_camera.h"
#include "services/cli/command/command.h"
#include "services/cli/command/number_range.h"
#include "services/evaluator/adapter/scene.h"
#include "services/surface/adapter/view_folder.h"
#include "services/surface/evaluation/experiment_report.h"
#include "services/surface/evaluation/exploration.h"
#include "services/surface/evaluation/search_comparison.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;

struct SurfaceArgs {
  std::string folder;
  std::vector<std::size_t> views;
  std::string scenario;
  std::vector<std::string> overrides;
  bool exact = false;
  bool searches = false;
  int starts = 0;
  surface::ExplorationOptions options;
  fs::path out = "surface";
  fs::path json;
};

/// What an experiment calls with each of its rows.
surface::ExplorationListener ListenerOf(surface::ExperimentReport& report) {
  return {.measured = [&](const auto& row, const auto& at, const auto& move) { report.Add(row, at, move); },
          .refused = [](const std::string& why) { std::cout << "  left out: " << why << '\n'; }};
}

void End(const surface::ExperimentReport& report, const surface::Surface& surface, const SurfaceArgs& args) {
  std::cout << surface::RowLegend();
  report.WriteGraphs(surface);
  if (!args.json.empty()) WriteFile(args.json, report.ToJson().dump(2) + '\n');
  std::cout << "pictures, graph.ply and surface.ply: " << args.out.string() << '\n';
}

int FromFolder(const SurfaceArgs& args) {
  surface::ViewFolder folder = surface::ViewFolder::Open(args.folder);
  std::vector<std::size_t> views = args.views;
  for (std::size_t i = 0; args.views.empty() && i < folder.size(); ++i) views.push_back(i);
  std::set<std::size_t> asked;
  for (const std::size_t view : views) {
    if (view >= folder.size()) {
      throw std::runtime_error(
          fmt::format("--views: {} has {} views, from 0; there is no {}", args.folder, folder.size(), view));
    }
    if (!asked.insert(view).second) throw std::runtime_error(fmt::format("--views: {} is there twice", view));
  }
  surface::ExperimentReport report(std::cout, args.out, args.options.views_per_move);
  const surface::Surface surface = surface::AddEach(
      views.size(),
      [&](std::size_t k) {
        return surface::NamedView{folder.NameOf(views[k]), folder.Load(views[k])};
      },
      args.options.surface, ListenerOf(report));
  if (surface.views().empty()) throw std::runtime_error(args.folder + ": no view has a measurement");
  End(report, surface, args);
  return EXIT_SUCCESS;
}

int FromScenario(const SurfaceArgs& args) {
  SimulatedCamera camera(args.scenario, args.overrides, args.exact);
  const RigidTransform start = camera.StartPose();
  surface::ExperimentReport report(std::cout, args.out, args.options.views_per_move);
  const surface::Exploration made = surface::Explore(
      camera.Look(start),
      [&](const auto& T_WC, const auto& above_W) { return camera.LookFromAbove(T_WC, above_W); },
      args.options, ListenerOf(report));
  std::cout << "  ended: " << surface::ToText(made.end) << '\n';
  End(report, made.surface, args);
  return EXIT_SUCCESS;
}

/// Explores from several starts, and compares with the truth.
int FromStarts(const SurfaceArgs& args) {
  evaluator::CheckNothingMoves({args.scenario}, args.overrides, "--starts");
  RiftRuns runs(args.scenario, args.overrides, args.exact, args.options);
  std::vector<RiftRun> made;
  std::cout << RiftRunHeading() << std::flush;
  for (int start = 1; start <= args.starts; ++start) {
    made.push_back(runs.From(start));
    std::cout << ToText(made.back()) << std::flush;
  }
  std::cout << RiftRunLegend();
  if (!args.json.empty()) WriteFile(args.json, ToJson(made).dump(2) + '\n');
  return EXIT_SUCCESS;
}

int CompareSearches(const SurfaceArgs& args) {
  const std::vector<surface::GridSearch> searches = surface::SearchGrids();
  for (const surface::GridSearch& search : searches) std::cout << surface::ToText(search);
  WritePicture(args.out / "searches.png", surface::Draw(searches));
  std::cout << "picture: " << (args.out / "searches.png").string() << '\n';
  return EXIT_SUCCESS;
}

int Surface(const SurfaceArgs& args) {
  surface::CheckOptions(args.options);
  if (!args.json.empty()) CheckWritable(args.json);
  if (args.starts > 0) return FromStarts(args);
  CheckFolderWritable(args.out);
  if (args.searches) return CompareSearches(args);
  return args.folder.empty() ? FromScenario(args) : FromFolder(args);
}

}  // namespace

void AddSurface(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<SurfaceArgs>();
  CLI::App* command = app.add_subcommand(
      "surface",
      "Build the surface graph of posed images and explore by its rifts, as the source thesis does");
  auto* folder = command->add_option(
      "folder", args->folder,
      "Posed depth or disparity images: camera-intrinsics.txt, NAME.pose.txt, NAME.depth.png or "
      "NAME.disparity.pfm");
  const CLI::Validator number(
      [](const std::string& text) {
        const bool digits = !text.empty() && text.size() < 10 &&
                            std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
        return digits ? std::string() : "\"" + text + "\" is not a number of a view";
      },
      "NUMBER");
  command->add_option("--views", args->views, "Which of them, in which order: I,J,..., from 0; default: all")
      ->delimiter(',')
      ->check(number)
      ->allow_extra_args(false)
      ->needs(folder);
  auto* scenario = command->add_option(
      "--scenario", args->scenario, "Simulate the stereo camera of this scenario, a name or a file, instead");
  command
      ->add_option("--set", args->overrides, "Set a field of the scenario: FIELD=VALUE, repeated as needed")
      ->allow_extra_args(false)
      ->needs(scenario);
  command->add_flag("--exact", args->exact, "True disparities in place of matched ones")->needs(scenario);
  auto* searches = command->add_flag("--searches", args->searches,
                                     "Compare the three searches on a grid, with and without an obstacle");
  folder->excludes(scenario)->excludes(searches);
  scenario->excludes(searches);
  surface::ExplorationOptions& options = args->options;
  command->add_option("--moves", options.moves, "Moves to a dominant rift")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str()
      ->needs(scenario);
  auto* starts =
      command
          ->add_option(
              "--starts", args->starts,
              "Explore from so many random starts, and compare with the truth: a line each, no files")
          ->check(CLI::Range(1, 1000))
          ->needs(scenario);
  command->add_option("--views-per-move", options.views_per_move, "Views on the way, the last above the rift")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->needs(scenario);
  surface::SurfaceOptions& surface = options.surface;
  const CLI::Validator length = NumberThat(
      [](double value) { return value > 0.0 && value <= 1000.0; },
      [](const std::string& text) { return "is " + text + ", must be above 0 and at most 1000"; }, "METERS");
  command->add_option("--height-m", surface.height, "Height of the camera's trajectory above the surface")
      ->check(length)
      ->excludes(searches)
      ->capture_default_str();
  command->add_option("--rift-edge-m", surface.rift_edge, "Longer edges are rifts")
      ->check(length)
      ->excludes(searches)
      ->capture_default_str();
  command->add_option("--merge-distance-m", surface.merge_distance, "Nearer points of two views are one")
      ->check(length)
      ->excludes(searches)
      ->capture_default_str();
  command
      ->add_option("--seen-through", surface.seen_through,
                   "Share of an edge's pixels that must be seen through to delete it")
      ->check(NumberThat(
          [](double value) { return value >= 0.0 && value < 1.0; },
          [](const std::string& text) { return "is " + text + ", must be at least 0 and below 1"; }, "SHARE"))
      ->excludes(searches)
      ->capture_default_str();
  command->add_option("--out", args->out, "Folder for pictures and PLY files")
      ->excludes(starts)
      ->capture_default_str();
  command->add_option("--json", args->json, "Where to write the table as JSON")->excludes(searches);
  command->callback([args, &exit_code] {
    if (args->folder.empty() && args->scenario.empty() && !args->searches) {
      throw CLI::RequiredError("FOLDER, --scenario or --searches");
    }
    exit_code = Surface(*args);
  });
}

}  // namespace thalweg::cli
