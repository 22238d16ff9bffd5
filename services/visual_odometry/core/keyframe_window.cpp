#include "services/visual_odometry/core/keyframe_window.h"

#include <Eigen/LU>
#include <algorithm>

#include "common/base/check.h"

namespace thalweg::visual_odometry {

void KeyframeWindow::Clear() {
  keyframes_.clear();
  landmarks_.clear();
}

std::vector<RigidTransform> KeyframeWindow::Steps() const {
  std::vector<RigidTransform> steps;
  for (std::size_t k = 1; k < keyframes_.size(); ++k) steps.push_back(keyframes_[k].T_from_last);
  return steps;
}

KeyframeWindow KeyframeWindow::Newest() const {
  KeyframeWindow alone(rig_, options_);
  alone.next_id_ = next_id_;
  alone.bias_ = bias_;
  alone.keyframes_.push_back(keyframes_.back());
  const std::int64_t id = keyframes_.back().id;
  for (const Landmark& landmark : landmarks_) {
    if (landmark.seen.back().keyframe != id) continue;
    alone.landmarks_.push_back(landmark);
    Landmark& own = alone.landmarks_.back();
    own.host = id;
    own.q = own.q_K;
    own.seen = {landmark.seen.back()};
  }
  return alone;
}

RigidTransform KeyframeWindow::NewestFromOldest() const {
  return ChainOf(Steps(), 0, static_cast<int>(keyframes_.size()) - 1);
}

RigidTransform KeyframeWindow::Append(const Frame& frame, const RigidTransform& T_from_last,
                                      const std::vector<Sighting>& sightings,
                                      const std::vector<StereoPixel>& fresh) {
  const std::int64_t id = next_id_++;
  keyframes_.push_back({id, T_from_last, frame.left, frame.search});
  for (Landmark& landmark : landmarks_) ++landmark.misses;
  for (const Sighting& sighting : sightings) {
    Landmark& landmark = landmarks_[sighting.landmark];
    landmark.seen.push_back({id, sighting.pixel, sighting.has_right});
    landmark.misses = 0;
  }
  std::erase_if(landmarks_, [&](const Landmark& landmark) { return landmark.misses > options_.most_misses; });
  for (const StereoPixel& pixel : fresh) {
    Landmark landmark;
    landmark.host = id;
    landmark.q = Triangulate(rig_, Unbiased(rig_, pixel, bias_));
    landmark.seen.push_back({id, pixel, true});
    landmarks_.push_back(std::move(landmark));
  }
  RigidTransform T_old_new = RigidTransform::Identity();
  if (keyframes() > options_.most_keyframes) {
    T_old_new = keyframes_[1].T_from_last.inverse();
    DropOldest();
  }
  Refresh();
  return T_old_new;
}

void KeyframeWindow::DropOldest() {
  const std::int64_t gone = keyframes_.front().id;
  const std::vector<RigidTransform> steps = Steps();
  for (Landmark& landmark : landmarks_) {
    if (landmark.host != gone) continue;
    landmark.seen.erase(landmark.seen.begin());
    if (landmark.seen.empty()) continue;
    // The landmark moves to the next keyframe that saw it.
    const std::int64_t next = landmark.seen.front().keyframe;
    const RigidTransform T = ChainOf(steps, 0, IndexOf(next));
    if (ScaledTransform(T, landmark.q).z() < kLeastForward) {
      landmark.seen.clear();
      continue;
    }
    landmark.q = TransformPoint(T, landmark.q);
    landmark.host = next;
  }
  std::erase_if(landmarks_, [](const Landmark& landmark) { return landmark.seen.empty(); });
  keyframes_.pop_front();
}

void KeyframeWindow::Refresh() {
  const std::vector<RigidTransform> steps = Steps();
  const int newest_index = keyframes() - 1;
  std::erase_if(landmarks_, [&](Landmark& landmark) {
    const int host = IndexOf(landmark.host);
    const RigidTransform T_KH = ChainOf(steps, host, newest_index);
    const RigidTransform T_SH = ChainOf(steps, host, IndexOf(landmark.seen.back().keyframe));
    if (ScaledTransform(T_KH, landmark.q).z() < kLeastForward ||
        ScaledTransform(T_SH, landmark.q).z() < kLeastForward) {
      return true;
    }
    landmark.q_K = TransformPoint(T_KH, landmark.q);
    landmark.q_source = TransformPoint(T_SH, landmark.q);
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const Landmark::Observation& seen : landmark.seen) {
      const RigidTransform T = ChainOf(steps, host, IndexOf(seen.keyframe));
      const int rows = seen.has_right ? 3 : 2;
      const Eigen::Matrix3d by_point = PointJacobian(rig_, T, landmark.q);
      information += by_point.topRows(rows).transpose() * by_point.topRows(rows);
    }
    const Eigen::Matrix3d to_K = TransformPointJacobian(T_KH, landmark.q);
    landmark.q_covariance = to_K * information.inverse() * to_K.transpose();
    return !landmark.q_covariance.allFinite();
  });
}

std::vector<std::uint8_t> KeyframeWindow::HeldSteps() const {
  std::vector<int> across(keyframes_.size() - 1, 0);
  for (const Landmark& landmark : landmarks_) {
    for (int k = IndexOf(landmark.seen.front().keyframe); k < IndexOf(landmark.seen.back().keyframe); ++k) {
      ++across[static_cast<std::size_t>(k)];
    }
  }
  std::vector<std::uint8_t> held;
  for (const int landmarks : across) held.push_back(landmarks < options_.least_across ? 1 : 0);
  if (keyframes() == options_.most_keyframes) {
    for (int k = 0; k < std::min(options_.settled_steps, static_cast<int>(held.size())); ++k) {
      held[static_cast<std::size_t>(k)] = 1;
    }
  }
  return held;
}

void KeyframeWindow::SetBias(const DisparityBias& bias) {
  for (Landmark& landmark : landmarks_) {
    const double u_right = rig_.camera.fx * (landmark.q[0] - rig_.baseline * landmark.q[2]) + rig_.camera.cx;
    landmark.q[2] += InverseDepthByBias(rig_, u_right).dot(bias - bias_);
  }
  bias_ = bias;
  if (!empty()) Refresh();
}

std::pair<AdjustmentWindow, std::vector<std::size_t>> KeyframeWindow::Observed() const {
  AdjustmentWindow window;
  window.steps = Steps();
  std::vector<std::size_t> owners;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const Landmark& landmark = landmarks_[i];
    if (landmark.seen.size() < 2) continue;
    AdjustmentWindow::Point point{IndexOf(landmark.host), landmark.q, {}};
    for (const Landmark::Observation& seen : landmark.seen) {
      const RigidTransform T = ChainOf(window.steps, point.host, IndexOf(seen.keyframe));
      if (ScaledTransform(T, landmark.q).z() < kLeastForward) continue;
      point.seen.push_back({IndexOf(seen.keyframe), Unbiased(rig_, seen.pixel, bias_), seen.has_right});
    }
    window.points.push_back(std::move(point));
    owners.push_back(i);
  }
  return {std::move(window), std::move(owners)};
}

std::optional<BiasEvidence> KeyframeWindow::EvidenceOfBias() const {
  if (keyframes_.size() < 2) return std::nullopt;
  return visual_odometry::EvidenceOfBias(rig_, Observed().first, options_.point_sigma_px);
}

void KeyframeWindow::AdjustAll(Hold hold) {
  if (keyframes_.size() < 2) return;
  auto [window, owners] = Observed();
  if (hold == Hold::kSettled) window.held = HeldSteps();
  Adjust(rig_, window, options_.adjustment);
  for (std::size_t k = 0; k < window.steps.size(); ++k) keyframes_[k + 1].T_from_last = window.steps[k];
  for (std::size_t i = 0; i < owners.size(); ++i) {
    Landmark& landmark = landmarks_[owners[i]];
    landmark.q = window.points[i].q;
    // Observations that do not fit are removed, and so is a landmark that its own host contradicts.
    const auto wrong = [&, &steps = window.steps](const Landmark::Observation& seen) {
      const RigidTransform T = ChainOf(steps, IndexOf(landmark.host), IndexOf(seen.keyframe));
      const Eigen::Vector3d m = ScaledTransform(T, landmark.q);
      if (m.z() < kLeastForward) return true;
      const Eigen::Vector3d error = ProjectScaled(rig_, m, landmark.q[2]) - Unbiased(rig_, seen.pixel, bias_);
      return error.head(seen.has_right ? 3 : 2).norm() > options_.outlier_px;
    };
    if (wrong(landmark.seen.front())) {
      landmark.seen.clear();
    } else {
      std::erase_if(landmark.seen, wrong);
    }
  }
  std::erase_if(landmarks_, [](const Landmark& landmark) { return landmark.seen.empty(); });
  Refresh();
}

}  // namespace thalweg::visual_odometry
