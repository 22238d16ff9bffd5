#include <array>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>

#include "common/base/statistics.h"
#include "common/base/stopwatch.h"
#include "services/cli/command/command.h"
#include "services/cli/report/trajectory_picture.h"
#include "services/visual_odometry/adapter/sequence.h"
#include "services/visual_odometry/core/trajectory_error.h"
#include "services/visual_odometry/core/visual_odometry.h"

namespace thalweg::cli {
namespace {

namespace vo = visual_odometry;

constexpr double kDegree = std::numbers::pi / 180.0;

struct Args {
  std::string sequence;
  std::string out;
  std::string json;
  std::string picture;
  std::size_t first = 0;
  int most_places = vo::PlaceMemory::Options().most_places;
};

struct Outcome {
  std::string layout;
  std::size_t frames = 0;
  std::array<int, 3> states{};  ///< By vo::TrackingState.
  int recognised = 0;           ///< Frames that saw a place again.
  std::size_t places = 0;
  std::vector<vo::TimedPose> trajectory;
  std::vector<vo::PosePair> compared;
  std::optional<vo::TrajectoryError> error;
  TimingStatistics::Summary time;
};

Outcome Follow(const vo::Sequence& sequence, std::size_t first, int most_places) {
  if (first >= sequence.size()) {
    throw std::runtime_error("--first is " + std::to_string(first) + ", the sequence has " +
                             std::to_string(sequence.size()) + " frames");
  }
  Outcome outcome;
  outcome.layout = sequence.layout();
  vo::VisualOdometry::Options options;
  options.places.most_places = most_places;
  vo::VisualOdometry odometry(sequence.geometry(), options);
  TimingStatistics timing;
  std::string last_reason;
  for (std::size_t i = first; i < sequence.size(); ++i) {
    const vo::StereoImages images = sequence.Load(i);
    const Stopwatch watch;
    const vo::PoseEstimate estimate = odometry.Track(images);
    timing.Add(watch.Milliseconds());
    ++outcome.frames;
    ++outcome.states[static_cast<std::size_t>(estimate.state)];
    outcome.recognised += estimate.recognised ? 1 : 0;
    if (!estimate.reason.empty() && estimate.reason != last_reason) {
      std::cout << "frame " << i << ": " << vo::NameOf(estimate.state) << ", " << estimate.reason << '\n';
    }
    last_reason = estimate.reason;
    outcome.trajectory.push_back({estimate.stamp, estimate.T_OC});
    if (const auto T_WC_true = sequence.TruthAt(i)) {
      outcome.compared.push_back({estimate.stamp, estimate.T_OC, *T_WC_true, estimate.covariance});
    }
  }
  outcome.places = odometry.places().size();
  outcome.time = timing.Summarize();
  if (outcome.compared.size() >= 2) outcome.error = vo::Compare(outcome.compared);
  return outcome;
}

std::string Fixed(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::vector<std::string> Describe(const Outcome& outcome) {
  std::vector<std::string> lines;
  lines.push_back(outcome.layout + ", " + std::to_string(outcome.frames) +
                  " frames: " + std::to_string(outcome.states[0]) + " tracking, " +
                  std::to_string(outcome.states[1]) + " degraded, " + std::to_string(outcome.states[2]) +
                  " lost; " + std::to_string(outcome.places) + " places kept, known again " +
                  std::to_string(outcome.recognised) + " times");
  lines.push_back("ms per frame: median " + Fixed(outcome.time.p50_ms, 1) + ", 95 % " +
                  Fixed(outcome.time.p95_ms, 1) + ", max " + Fixed(outcome.time.max_ms, 1));
  if (!outcome.error) {
    lines.emplace_back("no truth to compare with");
    return lines;
  }
  const vo::TrajectoryError& error = *outcome.error;
  lines.push_back("path " + Fixed(error.path_length, 2) + " m, ATE " + Fixed(error.ate_rmse, 4) + " m (max " +
                  Fixed(error.ate_max, 4) + "), end off by " + Fixed(error.drift, 4) + " m (max " +
                  Fixed(error.drift_max, 4) + ") and " + Fixed(error.drift_angle / kDegree, 3) + " deg");
  lines.push_back("relative errors: " + Fixed(100.0 * error.relative_translation, 3) + " %, " +
                  Fixed(error.relative_rotation / kDegree, 5) + " deg/m");
  lines.push_back("within the 95 % ellipsoid: position " + Fixed(100.0 * error.inside_position, 1) +
                  " %, rotation " + Fixed(100.0 * error.inside_rotation, 1) + " % of the frames");
  return lines;
}

nlohmann::ordered_json ToJson(const Outcome& outcome) {
  nlohmann::ordered_json json;
  json["layout"] = outcome.layout;
  json["frames"] = outcome.frames;
  for (const auto state :
       {vo::TrackingState::kTracking, vo::TrackingState::kDegraded, vo::TrackingState::kLost}) {
    json["states"][vo::NameOf(state)] = outcome.states[static_cast<std::size_t>(state)];
  }
  json["places"] = outcome.places;
  json["recognised"] = outcome.recognised;
  json["frame_time_ms"] = {
      {"p50", outcome.time.p50_ms}, {"p95", outcome.time.p95_ms}, {"max", outcome.time.max_ms}};
  if (!outcome.error) {
    json["error"] = nullptr;
    return json;
  }
  const vo::TrajectoryError& error = *outcome.error;
  auto& to = json["error"];
  to["poses"] = error.poses;
  to["path_length_m"] = error.path_length;
  to["ate_rmse_m"] = error.ate_rmse;
  to["ate_max_m"] = error.ate_max;
  to["drift_m"] = error.drift;
  to["drift_max_m"] = error.drift_max;
  to["drift_deg"] = error.drift_angle / kDegree;
  to["inside_95_percent"] = {{"position", error.inside_position}, {"rotation", error.inside_rotation}};
  to["relative_translation_percent"] = 100.0 * error.relative_translation;  // NaN becomes null
  to["relative_rotation_deg_per_m"] = error.relative_rotation / kDegree;
  to["by_length"] = nlohmann::ordered_json::array();
  for (const vo::RelativeError& relative : error.by_length) {
    to["by_length"].push_back({{"length_m", relative.length},
                               {"stretches", relative.stretches},
                               {"translation_percent", 100.0 * relative.translation},
                               {"rotation_deg_per_m", relative.rotation / kDegree}});
  }
  return json;
}

void WriteJson(const Outcome& outcome, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << ToJson(outcome).dump(2) << '\n';
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

void WritePicture(const Outcome& outcome, const std::string& title, const std::filesystem::path& file) {
  TrajectoryPicture picture{title, Describe(outcome), {}, {}};
  RigidTransform T_WO = RigidTransform::Identity();
  if (!outcome.compared.empty()) {
    T_WO = outcome.compared.front().T_WC_true * outcome.compared.front().T_OC.inverse();
  }
  for (const vo::TimedPose& pose : outcome.trajectory) picture.way.push_back((T_WO * pose.T).translation());
  for (const vo::PosePair& pair : outcome.compared) picture.true_way.push_back(pair.T_WC_true.translation());
  if (!cv::imwrite(file.string(), Draw(picture)))
    throw std::runtime_error(file.string() + ": cannot be written");
}

int Odometry(const Args& args) {
  const vo::Sequence sequence = vo::Sequence::Open(args.sequence);
  const Outcome outcome = Follow(sequence, args.first, args.most_places);
  for (const std::string& line : Describe(outcome)) std::cout << line << '\n';
  if (outcome.error) {
    for (const vo::RelativeError& relative : outcome.error->by_length) {
      std::cout << "  " << Fixed(relative.length, 0) << " m, " << relative.stretches
                << " stretches: " << Fixed(100.0 * relative.translation, 3) << " %, "
                << Fixed(relative.rotation / kDegree, 5) << " deg/m\n";
    }
  }
  for (const std::string& file : {args.out, args.json, args.picture}) {
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    if (!folder.empty()) std::filesystem::create_directories(folder);
  }
  if (!args.out.empty()) vo::WriteTumTrajectory(outcome.trajectory, args.out);
  if (!args.json.empty()) WriteJson(outcome, args.json);
  std::filesystem::path picture = args.picture;
  if (picture.empty()) picture = std::filesystem::path(args.out).parent_path() / "trajectory.png";
  const std::string title = std::filesystem::absolute(args.sequence).lexically_normal().filename().string();
  WritePicture(outcome, title, picture);
  std::cout << "picture: " << picture.string() << '\n';
  return EXIT_SUCCESS;
}

}  // namespace

void AddOdometry(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  const std::string purpose =
      "Follow the camera of a stereo sequence (KITTI or EuRoC layout) and compare with its truth";
  CLI::App* command = app.add_subcommand("odometry", purpose);
  command->add_option("sequence", args->sequence, "Folder")->required();
  command->add_option("--out", args->out, "Trajectory to write, TUM format");
  command->add_option("--json", args->json, "Figures to write");
  command->add_option("--picture", args->picture,
                      "Picture to write; trajectory.png beside --out when absent");
  command->add_option("--first", args->first, "Frame to begin with")->capture_default_str();
  command->add_option("--most-places", args->most_places, "Kept, to be known again; 0 = none")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command->callback([args, &exit_code] { exit_code = Odometry(*args); });
}

}  // namespace thalweg::cli
