#include "services/cli/adapter/rift_runs.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/scenario/models.h"
#include "services/evaluator/core/seen_surface.h"

namespace thalweg::cli {
namespace {

constexpr double kHangs = 0.1;  // [m] from any surface

double Percent(std::size_t part, std::size_t whole) {
  return 100.0 * static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(1, whole));
}

std::vector<Eigen::Vector3d> MiddlesOf(const std::vector<surface::Rift>& rifts,
                                       const surface::SurfaceGraph& graph) {
  std::vector<Eigen::Vector3d> middles_W;
  for (const surface::Rift& rift : rifts) {
    for (const surface::SurfaceGraph::Edge edge : rift.edges) {
      const Eigen::Vector3f sum_W = graph.Position(graph.End(edge, 0)) + graph.Position(graph.End(edge, 1));
      middles_W.push_back(0.5 * sum_W.cast<double>());
    }
  }
  return middles_W;
}

}  // namespace

RiftRuns::RiftRuns(const std::string& scenario, const std::vector<std::string>& overrides, bool exact,
                   const surface::ExplorationOptions& options)
    : scene_(scenario, overrides),
      camera_(scenario, overrides, exact),
      robot_(RobotFrom(scene_.scenario())),
      options_(options) {
  surface::CheckOptions(options);
}

RiftRun RiftRuns::From(int start) {
  const RigidTransform T_WB = scene_.Start(start);
  const auto truth = scene_.Truth(T_WB.translation());
  const auto surfaces = scene_.Surfaces(truth, T_WB.translation());
  evaluator::SeenSurface seen(scene_.world(), *surfaces, camera_.camera(), scene_.TruthOptions().view_range,
                              {});
  RiftRun run{.start = start};
  RigidTransform at = T_WB * robot_.T_BC;
  seen.Note(at);
  std::size_t first_points = 0;
  std::vector<Eigen::Vector3d> middles_W;
  const surface::Camera look = [&](const RigidTransform& T_WC, const Eigen::Vector3d& above_W) {
    Result<surface::View> view = camera_.LookFromAbove(T_WC, above_W);
    if (view) {
      seen.Note(T_WC);
      run.path += (T_WC.translation() - at.translation()).norm();
      at = T_WC;
    }
    return view;
  };
  const surface::ExplorationListener listener{
      .measured =
          [&](const surface::SurfaceRow& row, const surface::Surface& surface, const surface::Move& move) {
            if (row.views == 1) first_points = row.points;
            run.views = row.views;
            run.points = row.points - first_points;
            run.merged = row.points - row.vertices;
            run.vertices = row.vertices;
            run.cubes = row.cubes;
            run.rifts = row.rifts;
            run.rift_edges = row.rift_edges;
            middles_W = MiddlesOf(move.rifts, surface.graph());
            run.poses += move.poses.size();
            for (const surface::CameraPose& pose : move.poses)
              run.in_solid += camera_.WhyNotAt(pose.T_WC) ? 1 : 0;
          },
      .refused = [&](const std::string&) { ++run.refused; }};
  const surface::Exploration made = surface::Explore(camera_.Look(at), look, options_, listener);
  run.end = made.end;
  run.moves = made.moves;
  run.seen = seen.seen();
  run.inspected = seen.inspected();
  run.hanging =
      static_cast<std::size_t>(std::ranges::count_if(middles_W, [&](const Eigen::Vector3d& middle_W) {
        return scene_.world().DistanceToSurface(middle_W, 2.0 * kHangs) > kHangs;
      }));
  return run;
}

std::string RiftRunHeading() {
  return fmt::format("{:>5} {:>5} {:>5} {:>7} {:>7} {:>7} {:>9} {:>8} {:>7} {:>9} {:>7} {:>5} {:>7}  {}\n",
                     "start", "moves", "views", "refused", "path", "seen", "inspected", "in solid", "merged",
                     "vertices", "cubes", "rifts", "hanging", "end");
}

std::string ToText(const RiftRun& run) {
  return fmt::format(
      "{:>5} {:>5} {:>5} {:>7} {:>5.1f} m {:>5.1f} % {:>7.1f} % {:>6.1f} % {:>5.1f} % {:>9} {:>7} {:>5} "
      "{:>5.1f} %  {}\n",
      run.start, run.moves, run.views, run.refused, run.path, 100.0 * run.seen, 100.0 * run.inspected,
      Percent(run.in_solid, run.poses), Percent(run.merged, run.points), run.vertices, run.cubes, run.rifts,
      Percent(run.hanging, run.rift_edges), surface::ToText(run.end));
}

std::string RiftRunLegend() {
  return R"(
  refused: poses on the way from which it should have looked, but in which the robot would be in something
  path: straight lines between the poses from which it looked
  seen, inspected: share of the observable surface in view, and from within 2 m and 60 degrees of its normal
  in solid: share of the poses of the camera's trajectories in which the robot would touch something
  merged: share of the points of later views that became points of the view before
  cubes: of 5 cm, that contain a vertex; rifts: left at the end
  hanging: share of their edges whose middle is more than 0.1 m from any surface
)";
}

nlohmann::ordered_json ToJson(const std::vector<RiftRun>& runs) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const RiftRun& run : runs) {
    json.push_back({{"start", run.start},
                    {"end", surface::ToText(run.end)},
                    {"moves", run.moves},
                    {"views", run.views},
                    {"refused", run.refused},
                    {"path_m", run.path},
                    {"seen", run.seen},
                    {"inspected", run.inspected},
                    {"poses", run.poses},
                    {"poses_in_solid", run.in_solid},
                    {"later_points", run.points},
                    {"merged_points", run.merged},
                    {"vertices", run.vertices},
                    {"cubes_5cm", run.cubes},
                    {"rifts", run.rifts},
                    {"rift_edges", run.rift_edges},
                    {"hanging_edges", run.hanging}});
  }
  return json;
}

}  // namespace thalweg::cli
