#include "common/files/tum.h"

#include <fmt/format.h>

#include <cstdlib>
#include <iterator>

namespace thalweg {

std::string TumText(const std::vector<TimedPose>& poses) {
  constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]
  std::string text = "# stamp_s tx ty tz qx qy qz qw\n";
  for (const TimedPose& pose : poses) {
    const std::int64_t ns = pose.stamp.time_since_epoch().count();
    const Eigen::Vector3d p = pose.T.translation();
    const Eigen::Quaterniond q(pose.T.linear());
    fmt::format_to(std::back_inserter(text), "{}{}.{:09} {} {} {} {} {} {} {}\n", ns < 0 ? "-" : "",
                   std::abs(ns / kSecond), std::abs(ns % kSecond), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(),
                   q.w());
  }
  return text;
}

}  // namespace thalweg
