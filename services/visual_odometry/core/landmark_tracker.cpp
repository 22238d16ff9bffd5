#include "services/visual_odometry/core/landmark_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/base/median.h"

namespace thalweg::visual_odometry {
namespace {

constexpr float kTrackReach = 2.5F;  // [px] of an alignment, at its pyramid level
constexpr int kWorstTrack = 35 * SearchPatch::kSize * SearchPatch::kSize;
constexpr float kUniqueWide = 0.85F;

/// Where a landmark should appear, and how its patch must be warped for that.
struct Prediction {
  Eigen::Vector2f source;            ///< [px] In the keyframe that saw it last.
  Eigen::Vector2f here;              ///< [px] In the frame.
  Eigen::Matrix2f source_from_here;  ///< Maps offsets in the frame to offsets in the source keyframe.
};

Eigen::Vector2f Seen(const StereoGeometry& rig, const RigidTransform& T, const InverseDepthPoint& q) {
  return Project(rig, T, q).head<2>().cast<float>();
}

/// Predicts where a landmark appears. Assumes that the surface around it is parallel to the image that saw it
/// last.
std::optional<Prediction> Predict(const StereoGeometry& rig, const Landmark& landmark,
                                  const RigidTransform& T_CS, const cv::Size& size) {
  const InverseDepthPoint& q = landmark.q_source;
  if (ScaledTransform(T_CS, q).z() < kLeastForward) return std::nullopt;
  Prediction prediction;
  prediction.source = landmark.seen.back().pixel.head<2>().cast<float>();
  prediction.here = Seen(rig, T_CS, q);
  if (prediction.here.x() < 0.0F || prediction.here.y() < 0.0F ||
      prediction.here.x() > static_cast<float>(size.width - 1) ||
      prediction.here.y() > static_cast<float>(size.height - 1)) {
    return std::nullopt;
  }
  constexpr double kStep = 4.0;  // [px]
  Eigen::Matrix2f here_from_source;
  const InverseDepthPoint right = q + Eigen::Vector3d(kStep / rig.camera.fx, 0, 0);
  const InverseDepthPoint below = q + Eigen::Vector3d(0, kStep / rig.camera.fy, 0);
  here_from_source.col(0) = (Seen(rig, T_CS, right) - prediction.here) / static_cast<float>(kStep);
  here_from_source.col(1) = (Seen(rig, T_CS, below) - prediction.here) / static_cast<float>(kStep);
  if (here_from_source.determinant() < 0.1F) return std::nullopt;
  prediction.source_from_here = here_from_source.inverse();
  return prediction;
}

/// The transforms from each keyframe of the window to the frame, computed once.
class FromKeyframes {
 public:
  FromKeyframes(const KeyframeWindow& window, const RigidTransform& T_CK) : newest_(window.newest().id) {
    RigidTransform T = T_CK;
    for (int k = 0; k < window.keyframes(); ++k) {
      from_newest_.push_back(T);
      T = T * window.at(newest_ - k).T_from_last;
    }
  }
  const RigidTransform& operator[](std::int64_t keyframe) const {
    return from_newest_[static_cast<std::size_t>(newest_ - keyframe)];
  }

 private:
  std::int64_t newest_;
  std::vector<RigidTransform> from_newest_;
};

float ScaleOf(int level) {
  return 1.0F / static_cast<float>(1 << level);
}

}  // namespace

/// Calls visit(landmark's index, the last keyframe that saw it, prediction) for each landmark that should be
/// in view.
template <class Visit>
void LandmarkTracker::ForEachInView(const KeyframeWindow& window, const RigidTransform& T_CK,
                                    const Frame& frame, Visit&& visit) const {
  const FromKeyframes T_CSs(window, T_CK);
  const cv::Size size = frame.left[0].size();
  for (std::size_t i = 0; i < window.landmarks().size(); ++i) {
    const Landmark& landmark = window.landmarks()[i];
    const std::int64_t source_id = landmark.seen.back().keyframe;
    const auto prediction = Predict(rig_, landmark, T_CSs[source_id], size);
    if (prediction) visit(i, window.at(source_id), *prediction);
  }
}

std::vector<LandmarkTracker::Sight> LandmarkTracker::SearchAll(const KeyframeWindow& window,
                                                               const Frame& frame, const RigidTransform& T_CK,
                                                               bool wide) const {
  std::vector<Sight> sights;
  const int radius = std::max(
      3, static_cast<int>((wide ? options_.wide_radius : options_.search_radius) * frame.search.cols));
  ForEachInView(
      window, T_CK, frame, [&](std::size_t i, const Keyframe& source, const Prediction& prediction) {
        const float scale = ScaleOf(levels_.search);
        const auto patch =
            SearchPatch::Cut(source.search, prediction.source * scale, prediction.source_from_here);
        if (!patch) return;
        const Eigen::Vector2f center = prediction.here * scale;
        const cv::Rect area(static_cast<int>(std::lround(center.x())) - radius,
                            static_cast<int>(std::lround(center.y())) - radius, 2 * radius + 1,
                            2 * radius + 1);
        const auto found = patch->Search(frame.search, area);
        if (!found || found->difference > kWorstTrack) return;
        if (wide && static_cast<float>(found->difference) > kUniqueWide * static_cast<float>(found->rival))
          return;
        Eigen::Vector2f here = found->position;
        bool good = true;
        float correlation = 0.0F;
        for (int level = levels_.search; level >= 0 && good; --level) {
          const auto index = static_cast<std::size_t>(level);
          const auto fine =
              Patch::Cut(source.left[index], prediction.source * ScaleOf(level), prediction.source_from_here);
          const auto aligned = fine ? fine->Find(frame.left[index], here, kTrackReach) : std::nullopt;
          if (!aligned) {
            // A coarse level may lack texture where the finest one has a corner.
            good = level > 0;
          } else {
            here = aligned->position;
            correlation = aligned->correlation;
          }
          if (level > 0) here *= 2.0F;
        }
        if (good && correlation >= options_.least_correlation) sights.push_back({i, here, correlation});
      });
  return sights;
}

std::vector<LandmarkTracker::Sight> LandmarkTracker::RefineAll(const KeyframeWindow& window,
                                                               const Frame& frame,
                                                               const RigidTransform& T_CK) const {
  std::vector<Sight> sights;
  ForEachInView(
      window, T_CK, frame, [&](std::size_t i, const Keyframe& source, const Prediction& prediction) {
        Eigen::Vector2f start = prediction.here;
        if (frame.left.size() > 1) {
          const auto coarse =
              Patch::Cut(source.left[1], prediction.source * 0.5F, prediction.source_from_here);
          const auto aligned = coarse ? coarse->Find(frame.left[1], start * 0.5F, kTrackReach) : std::nullopt;
          if (aligned) start = aligned->position * 2.0F;
        }
        const auto fine = Patch::Cut(source.left[0], prediction.source, prediction.source_from_here);
        const auto aligned = fine ? fine->Find(frame.left[0], start, kTrackReach) : std::nullopt;
        if (aligned && aligned->correlation >= options_.least_correlation) {
          sights.push_back({i, aligned->position, aligned->correlation});
        }
      });
  return sights;
}

std::vector<PosePoint> LandmarkTracker::PointsOf(const KeyframeWindow& window,
                                                 const std::vector<Sight>& sights) const {
  std::vector<PosePoint> points;
  points.reserve(sights.size());
  for (const Sight& sight : sights) {
    const Landmark& landmark = window.landmarks()[sight.landmark];
    points.push_back(
        {landmark.q_K, landmark.q_covariance,
         StereoPixel(static_cast<double>(sight.left.x()), static_cast<double>(sight.left.y()), 0.0), false});
  }
  return points;
}

std::optional<LandmarkTracker::Result> LandmarkTracker::Track(const KeyframeWindow& window,
                                                              const Frame& frame,
                                                              const RigidTransform& T_CK_predicted,
                                                              double sigma_px, bool wide,
                                                              bool use_right) const {
  const std::vector<Sight> searched = SearchAll(window, frame, T_CK_predicted, wide);
  const auto consensus = FindConsensus(rig_, PointsOf(window, searched), T_CK_predicted, options_.pose,
                                       static_cast<std::uint64_t>(frame.stamp.time_since_epoch().count()));
  if (!consensus) return std::nullopt;
  std::vector<Sight> agreed;
  for (std::size_t i = 0; i < searched.size(); ++i) {
    if (consensus->inlier[i] != 0) agreed.push_back(searched[i]);
  }
  const auto rough = SolvePose(rig_, PointsOf(window, agreed), consensus->T_CK, sigma_px, options_.pose);
  if (!rough) return std::nullopt;

  const std::vector<Sight> sights = RefineAll(window, frame, rough->T_CK);
  std::vector<PosePoint> points = PointsOf(window, sights);
  std::vector<double> rights(points.size(), 0.0);
  std::vector<double> row_offsets;
  if (use_right) {
    StereoMatcher matcher(frame, levels_, options_.stereo, row_offset_);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d m = ScaledTransform(rough->T_CK, points[i].q_K);
      if (m.z() < kLeastForward) continue;
      const double disparity = rig_.camera.fx * rig_.baseline * points[i].q_K[2] / m.z();
      const double u_right = points[i].pixel[0] - disparity;
      const auto right = matcher.Refine(sights[i].left, u_right + bias_.dot(BiasBasis(rig_.camera, u_right)));
      if (!right) continue;
      rights[i] = *right;
      points[i].pixel[2] = *right;
      points[i].pixel = Unbiased(rig_, points[i].pixel, bias_);
      points[i].has_right = true;
    }
    row_offsets = matcher.row_offsets();
  }
  auto pose = SolvePose(rig_, points, rough->T_CK, sigma_px, options_.pose);
  if (!pose) return std::nullopt;

  Result result;
  result.pose = std::move(*pose);
  result.row_offsets = std::move(row_offsets);
  std::vector<double> displacements;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (result.pose.inlier[i] == 0) continue;
    result.sightings.push_back(
        {sights[i].landmark, {points[i].pixel[0], points[i].pixel[1], rights[i]}, points[i].has_right});
    result.with_right += points[i].has_right ? 1 : 0;
    const StereoPixel before = Project(rig_, RigidTransform::Identity(), points[i].q_K);
    displacements.push_back((points[i].pixel - before).head<2>().norm());
  }
  result.parallax_px = Median(std::move(displacements));
  for (const Landmark& landmark : window.landmarks()) {
    const Eigen::Vector3d m = ScaledTransform(result.pose.T_CK, landmark.q_K);
    if (m.z() > kLeastForward && rig_.camera.Sees(m)) ++result.visible;
  }
  return result;
}

}  // namespace thalweg::visual_odometry
