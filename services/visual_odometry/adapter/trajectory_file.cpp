#include "services/visual_odometry/adapter/trajectory_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/base/text.h"

namespace thalweg::visual_odometry {
namespace {

constexpr double kFarthest = 1e6;  // [m]
constexpr double kRotationTolerance = 1e-2;

std::string Quoted(std::string_view word) {
  std::string quoted("\"");
  quoted += word;
  quoted += '"';
  return quoted;
}

Time TimeFrom(double seconds) {
  return Time(FromSeconds(seconds));
}

/// The non-empty lines of a file, with their numbers, split into words.
class Lines {
 public:
  Lines(const std::filesystem::path& file, std::string_view separators)
      : file_(file), separators_(separators), stream_(file) {
    if (!stream_) throw std::runtime_error(file.string() + ": cannot be read");
  }

  bool Next() {
    while (std::getline(stream_, text_)) {
      ++number_;
      words_.clear();
      std::string_view rest(text_);
      while (true) {
        const std::size_t begin = rest.find_first_not_of(separators_);
        if (begin == std::string_view::npos) break;
        rest.remove_prefix(begin);
        const std::size_t end = std::min(rest.size(), rest.find_first_of(separators_));
        words_.push_back(rest.substr(0, end));
        rest.remove_prefix(end);
      }
      if (!words_.empty() && words_.front().front() != '#') return true;
    }
    return false;
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw std::runtime_error(file_.string() + ':' + std::to_string(number_) + ": " + what);
  }
  const std::vector<std::string_view>& words() const { return words_; }

  template <class Number>
  Number NumberAt(std::size_t index) const {
    Number value{};
    const std::string_view word = words_[index];
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      Fail(Quoted(word) + " is not a number");
    }
    return value;
  }
  /// [s] A time at or after the epoch, exact to the nanosecond.
  Time StampAt(std::size_t index) const {
    const double seconds = FiniteAt(index);
    if (seconds < 0.0 || seconds > 9e9) Fail("the stamp is beyond what a clock shows");
    const std::string_view word = words_[index];
    const std::size_t point = std::min(word.size(), word.find('.'));
    if (word.find_first_not_of("0123456789.") != std::string_view::npos) return TimeFrom(seconds);
    // A double cannot represent the nanoseconds of current stamps.
    std::string nanoseconds(word.substr(std::min(word.size(), point + 1), 9));
    nanoseconds.resize(9, '0');
    return Time(std::chrono::seconds(std::stoll('0' + std::string(word.substr(0, point)))) +
                Duration(std::stoll(nanoseconds)));
  }
  double FiniteAt(std::size_t index) const {
    const auto value = NumberAt<double>(index);
    if (!std::isfinite(value)) Fail(Quoted(words_[index]) + " is not finite");
    return value;
  }
  Eigen::Vector3d PositionAt(std::size_t x, std::size_t y, std::size_t z) const {
    const Eigen::Vector3d p(FiniteAt(x), FiniteAt(y), FiniteAt(z));
    if (p.cwiseAbs().maxCoeff() > kFarthest) Fail("position is beyond 1e6 m");
    return p;
  }
  Eigen::Matrix3d RotationAt(std::size_t w, std::size_t x) const {
    const Eigen::Quaterniond q(FiniteAt(w), FiniteAt(x), FiniteAt(x + 1), FiniteAt(x + 2));
    if (std::abs(q.norm() - 1.0) > kRotationTolerance) {
      Fail("quaternion has the length " + NumberText(q.norm()) + ", must be 1");
    }
    return q.normalized().toRotationMatrix();
  }
  void CheckOrder(const std::vector<TimedPose>& poses, Time stamp) const {
    if (!poses.empty() && stamp <= poses.back().stamp) Fail("the stamp is not later than the one before");
  }
  void CheckCount(std::size_t least, std::size_t most) const {
    if (words_.size() >= least && words_.size() <= most) return;
    Fail("has " + std::to_string(words_.size()) + " numbers, must have " + std::to_string(least));
  }
  RigidTransform MatrixPose() const {
    CheckCount(12, 12);
    Eigen::Matrix3d R;
    for (std::size_t i = 0; i < 9; ++i) {
      R(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) = FiniteAt(i / 3 * 4 + i % 3);
    }
    if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > kRotationTolerance ||
        R.determinant() < 0.0) {
      Fail("the 3 x 3 part is not a rotation");
    }
    return MakeTransform(Eigen::Quaterniond(R).normalized().toRotationMatrix(), PositionAt(3, 7, 11));
  }

 private:
  std::filesystem::path file_;
  std::string_view separators_;
  std::ifstream stream_;
  std::string text_;
  std::vector<std::string_view> words_;
  int number_ = 0;
};

}  // namespace

std::vector<RigidTransform> ReadKittiPoses(const std::filesystem::path& file) {
  std::vector<RigidTransform> poses;
  Lines lines(file, " \t\r");
  while (lines.Next()) poses.push_back(lines.MatrixPose());
  return poses;
}

std::vector<TimedPose> ReadTumTrajectory(const std::filesystem::path& file) {
  std::vector<TimedPose> poses;
  Lines lines(file, " \t\r");
  while (lines.Next()) {
    lines.CheckCount(8, 8);
    const Time stamp = lines.StampAt(0);
    lines.CheckOrder(poses, stamp);
    poses.push_back({stamp, MakeTransform(lines.RotationAt(7, 4), lines.PositionAt(1, 2, 3))});
  }
  return poses;
}

std::vector<TimedPose> ReadTrajectory(const std::filesystem::path& file, double kitti_rate) {
  Lines first(file, " \t\r");
  if (!first.Next()) throw std::runtime_error(file.string() + ": has no poses");
  if (first.words().size() != 12) return ReadTumTrajectory(file);
  std::vector<TimedPose> poses;
  for (const RigidTransform& T : ReadKittiPoses(file)) {
    poses.push_back({TimeFrom(static_cast<double>(poses.size()) / kitti_rate), T});
  }
  return poses;
}

std::vector<TimedPose> ReadEurocTruth(const std::filesystem::path& file) {
  std::vector<TimedPose> poses;
  Lines lines(file, ", \t\r");
  while (lines.Next()) {
    lines.CheckCount(8, 32);
    const Time stamp{Duration(lines.NumberAt<std::int64_t>(0))};
    lines.CheckOrder(poses, stamp);
    poses.push_back({stamp, MakeTransform(lines.RotationAt(4, 5), lines.PositionAt(1, 2, 3))});
  }
  return poses;
}

std::optional<RigidTransform> Trajectory::At(Time stamp) const {
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp,
                                      [](const TimedPose& pose, Time t) { return pose.stamp < t; });
  if (after == poses_.end()) return std::nullopt;
  if (after->stamp == stamp) return after->T;
  if (after == poses_.begin()) return std::nullopt;
  const TimedPose& before = *(after - 1);
  const Duration gap = after->stamp - before.stamp;
  if (gap > longest_gap_) return std::nullopt;
  return Interpolate(before.T, after->T, Seconds(stamp - before.stamp) / Seconds(gap));
}

}  // namespace thalweg::visual_odometry
