#include "services/evaluator/core/seen_surface.h"

#include <algorithm>

namespace thalweg::evaluator {
namespace {

constexpr unsigned kSeen = 1;
constexpr unsigned kInspected = 2;
constexpr unsigned kFine = 4;

}  // namespace

SeenSurface::SeenSurface(const simulator::World& world, const SurfaceTruth& truth,
                         const PinholeCamera& camera, double max_range,
                         const surface::InspectionLimits& limits)
    : world_(world),
      truth_(truth),
      camera_(camera),
      max_range_(max_range),
      limits_(limits),
      seen_(truth.points.size(), 0) {}

void SeenSurface::Note(const RigidTransform& T_WC) {
  const Eigen::Vector3d eye_W = T_WC.translation();
  const RigidTransform T_CW = T_WC.inverse();
  const double f = std::min(camera_.fx, camera_.fy);
  for (std::size_t k = 0; k < truth_.points.size(); ++k) {
    const SurfaceTruth::Point& point = truth_.points[k];
    const Eigen::Vector3d to_eye = eye_W - point.p_W;
    const double distance = to_eye.norm();
    if (distance > max_range_) continue;
    const double cosine = point.normal_W.dot(to_eye) / distance;
    if (cosine <= 0.0) continue;
    const Eigen::Vector3d p_C = T_CW * point.p_W;
    const surface::ViewQuality view{.distance = static_cast<float>(distance),
                                    .cosine = static_cast<float>(cosine),
                                    .sampling = static_cast<float>(p_C.z() / (f * cosine))};
    unsigned shows = kSeen;
    if (limits_.Inspects(view)) shows |= kInspected;
    if (limits_.SamplesFinely(view)) shows |= kFine;
    if ((shows & ~static_cast<unsigned>(seen_[k])) == 0 || !camera_.Sees(p_C)) continue;
    if (!world_.InSight(eye_W, point.before_W())) continue;
    seen_[k] = static_cast<std::uint8_t>(seen_[k] | shows);
  }
}

double SeenSurface::Share(unsigned what) const {
  const auto count = std::ranges::count_if(seen_, [&](std::uint8_t seen) { return (seen & what) != 0; });
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, seen_.size()));
}

double SeenSurface::seen() const {
  return Share(kSeen);
}

double SeenSurface::inspected() const {
  return Share(kInspected);
}

double SeenSurface::fine() const {
  return Share(kFine);
}

}  // namespace thalweg::evaluator
