#include "common/dds/placed_views.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "common/base/size_text.h"
#include "common/base/text.h"

namespace thalweg::dds {

void PlacedViews::AddPose(const StampedPose& pose) {
  const StampOrder::Verdict order = placement_.JudgePose(pose.stamp);
  if (order == StampOrder::Verdict::kNotLater) return;
  if (order == StampOrder::Verdict::kRestarted) continuity_.Forget();
  switch (continuity_.Judge(pose.stamp, pose.T)) {
    case PoseContinuity::Verdict::kJumps:
      return bus_.health().Reject<topics::Odometry>("jumps farther than the robot can have moved");
    case PoseContinuity::Verdict::kNewTrack:
      spdlog::warn(
          "the poses go on from where they jumped to: what is seen from now on may not fit the rest");
      placement_.poses().Clear();
      break;
    case PoseContinuity::Verdict::kFollows:
      break;
  }
  placement_.poses().Add(pose.stamp, pose.T);
}

void PlacedViews::Add(const sensor_msgs::msg::PointCloud2& message) {
  Result<StampedCloud> cloud = FromIdl(message, infinity_);
  if (!cloud) return bus_.health().Reject<topics::DepthPoints>(cloud.error());
  Add(*std::move(cloud), std::nullopt, topics::DepthPoints::kName);
}

template <class Message>
void PlacedViews::AddDepth(const Message& message) {
  std::optional<DepthImages::Cloud> cloud = depth_images_.Add(message);
  if (cloud) Add(std::move(cloud->stamped), cloud->camera, topics::DepthImage::kName);
}

template void PlacedViews::AddDepth(const sensor_msgs::msg::Image& message);
template void PlacedViews::AddDepth(const sensor_msgs::msg::CameraInfo& message);

void PlacedViews::Add(StampedCloud cloud, const std::optional<PinholeCamera>& stated, const char* topic) {
  const StampOrder::Verdict order = placement_.JudgeCloud(cloud.stamp, topic);
  if (order == StampOrder::Verdict::kNotLater) return;
  if (order == StampOrder::Verdict::kRestarted) waiting_.clear();
  const std::optional<PinholeCamera> camera = CameraFor(cloud.cloud, stated, topic);
  if (!camera) return;
  if (waiting_.size() == kMaxWaiting) {
    bus_.health().Drop(topic, "no odometry has reached its stamp");
    waiting_.pop_front();
  }
  waiting_.push_back({.stamped = std::move(cloud), .camera = *camera, .topic = topic});
}

std::optional<PinholeCamera> PlacedViews::CameraFor(const PointCloud& cloud,
                                                    const std::optional<PinholeCamera>& stated,
                                                    const char* topic) {
  Result<std::optional<PinholeCamera>> camera = stated;
  // A cloud that shows too little to determine its camera is of the one that is known, if that fits.
  if (!stated)
    camera = camera_.camera() && Fits(*camera_.camera(), cloud) ? camera_.camera() : CameraOf(cloud);
  if (!camera) {
    bus_.health().Reject(topic, camera.error());
    return std::nullopt;
  }
  if (!camera->has_value()) {
    bus_.health().Drop(topic, "shows too little to tell its camera");
    return std::nullopt;
  }
  const PinholeCamera& its = **camera;
  const bool is_other = camera_.camera() && !IsSameCamera(*camera_.camera(), its);
  const auto text = [&its] {
    return SizeText(its.width_px, its.height_px) + " pixels, fx " + NumberText(its.fx);
  };
  if (!camera_.Accepts(its)) {
    bus_.health().Reject(topic, "is of another camera than those before: " + text());
    return std::nullopt;
  }
  if (is_other) spdlog::warn("depths are of another camera now: {}", text());
  return camera_.camera();
}

std::vector<PlacedViews::View> PlacedViews::Take() {
  std::vector<View> placed;
  while (!waiting_.empty() && placement_.poses().Reaches(waiting_.front().stamped.stamp)) {
    View view = std::move(waiting_.front());
    waiting_.pop_front();
    const auto T_WB = placement_.PoseAt(view.stamped.stamp, view.topic);
    if (!T_WB) continue;
    view.T_WB = *T_WB;
    placed.push_back(std::move(view));
  }
  return placed;
}

}  // namespace thalweg::dds
