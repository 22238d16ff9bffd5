#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "common/scenario/scenario.h"
#include "common/service/service.h"

namespace thalweg::network {
namespace {

namespace topics = dds::topics;
using Json = nlohmann::ordered_json;
using Steady = std::chrono::steady_clock;

/// When the robot moved, on the wall clock, by its true poses.
class Motion {
 public:
  void Add(const RigidTransform& T_WB, Steady::time_point now) {
    constexpr double kLeastStep = 1e-4;  // [m] and [rad]
    if (!last_pose_) begun_ = now;
    if (last_pose_) {
      const RigidTransform step = last_pose_->inverse() * T_WB;
      const double turned = Eigen::AngleAxisd(step.rotation()).angle();
      if (step.translation().norm() < kLeastStep && turned < kLeastStep) return;
      if (last_moved_) longest_stand_ = std::max(longest_stand_, now - *last_moved_);
      if (!last_moved_) first_moved_ = now;
      last_moved_ = now;
    }
    last_pose_ = T_WB;
  }

  Json ToJson(Steady::time_point now) const {
    const auto seconds = [](Steady::duration duration) {
      return std::chrono::duration<double>(duration).count();
    };
    Json json;
    json["until_first_motion_s"] = last_moved_ ? Json(seconds(first_moved_ - begun_)) : Json(nullptr);
    json["longest_stand_between_motions_s"] = seconds(longest_stand_);
    json["stands_at_end_for_s"] =
        last_pose_ ? Json(seconds(now - last_moved_.value_or(begun_))) : Json(nullptr);
    return json;
  }

 private:
  std::optional<RigidTransform> last_pose_;  ///< Where it was when it last moved.
  std::optional<Steady::time_point> last_moved_;
  Steady::time_point begun_;
  Steady::time_point first_moved_;
  Steady::duration longest_stand_{0};
};

/// The number of operations that a service timed, by service and name.
using Timings = std::map<std::string, std::uint64_t>;

Json Listen(dds::Bus& bus, const std::stop_token& stop) {
  Motion motion;
  std::optional<thalweg_msgs::msg::SimulationStatus> simulation;
  Timings timings;
  bus.Subscribe<topics::SimulationStatus>([&](const auto& message) {
    simulation = message;
    if (const auto T_WB = dds::FromIdl(message.map_from_body_true())) motion.Add(*T_WB, Steady::now());
  });
  bus.Subscribe<topics::Health>([&](const auto& message) {
    for (const auto& timing : message.timings()) {
      timings[message.service() + "." + timing.name()] = timing.count();
    }
  });
  bus.Spin(stop);

  Json json = motion.ToJson(Steady::now());
  json["distance_m"] = simulation ? Json(simulation->distance_m()) : Json(nullptr);
  json["true_collisions"] = simulation ? Json(simulation->true_collisions()) : Json(nullptr);
  json["least_clearance_m"] = simulation ? Json(simulation->least_clearance_m()) : Json(nullptr);
  json["operations"] = timings;
  return json;
}

}  // namespace
}  // namespace thalweg::network

/// Listens beside the simulator, where no link disturbs it, and writes what the robot really did to
/// OUT/robot.json when it is stopped.
int main(int argc, char** argv) try {
  using namespace thalweg;
  const ServiceArgs args =
      ParseServiceArgs(argc, argv, "robot_log", "logs the true motion of a simulated robot");
  const Scenario scenario = LoadScenario(args.scenario, args.overrides);
  const std::stop_token stop = StopOnSignals();
  dds::BusOptions options = BusOptionsFrom(scenario, args, "robot_log");
  options.publish_health = false;
  dds::Bus bus(options);
  const nlohmann::ordered_json json = network::Listen(bus, stop);
  std::ofstream out(args.out + "/robot.json");
  out << json.dump(1) << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + args.out + "/robot.json");
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "robot_log: " << error.what() << '\n';
  return EXIT_FAILURE;
}
