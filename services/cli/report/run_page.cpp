#include "services/cli/report/run_page.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "common/base/angles.h"
#include "common/base/version.h"
#include "services/cli/report/encoding.h"
#include "services/cli/report/packed_map.h"
#include "services/cli/report/report_json.h"
#include "services/cli/report/report_picture.h"
#include "services/cli/report/rounded.h"

namespace thalweg::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostSamples = 2000;
constexpr std::size_t kMostPoses = 4000;
constexpr int kMostHalvings = 10;
static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");

/// Calls visit(item) for at most `most` items, evenly spaced, among them the first and the last.
template <class Items, class Visit>
void ForSome(const Items& items, std::size_t most, Visit&& visit) {
  if (items.size() <= most) {
    for (const auto& item : items) visit(item);
    return;
  }
  for (std::size_t k = 0; k < most; ++k) visit(items[k * (items.size() - 1) / (most - 1)]);
}

std::string Packed(std::span<const std::uint8_t> bytes) {
  return Base64(Deflated(bytes));
}

Json Point(const Eigen::Vector3d& p) {
  return {Rounded(p.x()), Rounded(p.y()), Rounded(p.z())};
}

Json ProgressOf(const RunRecord& record) {
  Json columns = {{"t_s", Json::array()},      {"distance_m", Json::array()}, {"explored_m3", Json::array()},
                  {"coverage", Json::array()}, {"frontiers", Json::array()},  {"planning_ms", Json::array()}};
  ForSome(record.progress, kMostSamples, [&](const ProgressSample& sample) {
    columns["t_s"].push_back(Rounded(sample.time));
    columns["distance_m"].push_back(Rounded(sample.distance));
    columns["explored_m3"].push_back(Rounded(sample.explored));
    columns["coverage"].push_back(Rounded(sample.coverage));
    columns["frontiers"].push_back(sample.frontiers ? Json(*sample.frontiers) : Json(nullptr));
    columns["planning_ms"].push_back(Rounded(sample.planning_ms));
  });
  return columns;
}

/// Eight floats for each pose: time [s], position [m], quaternion x, y, z, w.
Json PathOf(const RunRecord& record) {
  std::vector<float> numbers;
  std::size_t count = 0;
  const std::vector<TimedPose> path = PathUntilEnd(record);
  ForSome(path, kMostPoses, [&](const TimedPose& pose) {
    const Eigen::Quaterniond q(pose.T.linear());
    const Eigen::Vector3d& p = pose.T.translation();
    for (const double value :
         {Seconds(pose.stamp - path.front().stamp), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) {
      numbers.push_back(static_cast<float>(value));
    }
    ++count;
  });
  std::vector<std::uint8_t> bytes(numbers.size() * sizeof(float));
  if (!bytes.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return {{"poses", count}, {"data", Packed(bytes)}};
}

Json DecisionsOf(const RunRecord& record) {
  Json list = Json::array();
  for (const Decision& decision : record.decisions) {
    list.push_back({{"number", decision.number},
                    {"t_s", Rounded(decision.time)},
                    {"purpose", decision.purpose},
                    {"target", decision.target_W ? Point(*decision.target_W) : Json(nullptr)},
                    {"length_m", Rounded(decision.length)},
                    {"interruption", decision.interruption}});
  }
  return list;
}

Json FrontiersOf(const RunRecord& record) {
  Json list = Json::array();
  for (const FrontierMark& frontier : record.frontiers) {
    list.push_back({{"center", Point(frontier.center_W)},
                    {"voxels", frontier.voxels},
                    {"fate", frontier.fate},
                    {"reason", frontier.reason}});
  }
  return list;
}

Json ServicesOf(const RunRecord& record) {
  Json list = Json::array();
  for (const ServiceRecord& service : record.services) {
    Json timings = Json::array();
    for (const StageTiming& timing : service.timings) {
      timings.push_back({{"name", timing.name},
                         {"count", timing.count},
                         {"p50_ms", Rounded(timing.p50_ms)},
                         {"p95_ms", Rounded(timing.p95_ms)},
                         {"max_ms", Rounded(timing.max_ms)}});
    }
    list.push_back({{"name", service.name},
                    {"host", service.host},
                    {"processes", service.processes},
                    {"uptime_s", Rounded(service.uptime)},
                    {"rejected", service.rejected},
                    {"dropped", service.dropped},
                    {"timings", timings}});
  }
  return list;
}

Json RobotOf(const RobotModel& robot, const PinholeCamera& camera) {
  const double horizontal_fov_deg = 2.0 * std::atan(0.5 * camera.width_px / camera.fx) / kDegree;
  const Eigen::Quaterniond q(robot.T_BC.linear());
  return {{"radius_m", robot.radius},
          {"height_m", robot.height},
          {"horizontal_fov_deg", horizontal_fov_deg},
          {"aspect", static_cast<double>(camera.width_px) / camera.height_px},
          {"camera_position", Point(robot.T_BC.translation())},
          {"camera_rotation", {Rounded(q.x()), Rounded(q.y()), Rounded(q.z()), Rounded(q.w())}}};
}

/// The map with the finest voxels that leave the page within `room` bytes.
Json MapOf(const OccupancyGrid& grid, const CoverageTally& tally, double duration, std::size_t room) {
  for (int halvings = 0;; ++halvings) {
    const PackedMap packed = Pack(grid, tally, duration, halvings);
    if (packed.occupied > kMostOccupiedVoxels && halvings < kMostHalvings) continue;
    std::string data = Packed(packed.bytes);
    if (data.size() > room && halvings < kMostHalvings) continue;
    if (data.size() > room) return nullptr;  // scattered over kilometers: there is nothing to see
    return {{"voxel_size_m", packed.voxel_size}, {"true_voxel_size_m", grid.voxel_size()},
            {"blocks", packed.blocks},           {"occupied", packed.occupied},
            {"left_out", packed.left_out},       {"data", std::move(data)}};
  }
}

}  // namespace

std::string RunPage(std::string_view page_template, const RunRecord& record, const OccupancyGrid* map,
                    const CoverageTally& tally) {
  const std::size_t place = page_template.find(kDataPlace);
  if (place == std::string_view::npos) {
    throw std::invalid_argument("the page's template has no place for data");
  }
  Json data;
  data["version"] = Version();
  data["title"] = record.title;
  data["succeeded"] = record.succeeded;
  data["report"] = ToJson(record);
  data["report"].erase("coverage_over");  // thinned below
  data["progress"] = ProgressOf(record);
  data["path"] = PathOf(record);
  data["decisions"] = DecisionsOf(record);
  data["decisions_forgotten"] = record.decisions_forgotten;
  data["frontiers"] = FrontiersOf(record);
  data["services"] = ServicesOf(record);
  data["robot"] = RobotOf(record.robot, record.camera);
  data["scenario_text"] = record.scenario_text;
  const std::size_t without_map = page_template.size() + JsonForScript(data).size() + 200;
  const std::size_t room = kMostPageBytes > without_map ? kMostPageBytes - without_map : 0;
  data["map"] = map != nullptr ? MapOf(*map, tally, record.duration, room) : Json(nullptr);

  std::string page(page_template.substr(0, place));
  page += JsonForScript(data);
  page += page_template.substr(place + kDataPlace.size());
  return page;
}

}  // namespace thalweg::cli
