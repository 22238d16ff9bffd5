#include "services/stereo/core/surface_fill.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "services/stereo/core/opencv_view.h"
#include "services/stereo/core/regions.h"

namespace thalweg::stereo {
namespace {

constexpr double kBlurSigma = 1.0;  // [px]
constexpr int kTrials = 300;
constexpr std::size_t kJudges = 400;  // matches by which a trial is scored
constexpr int kMostRefinements = 5;   // for a trial that is the best so far
constexpr int kLastRefinements = 2;
constexpr float kSteepest = 0.7F;    // [px / px]
constexpr float kLeastArea = 20.0F;  // [px^2] twice the area of a trial's triangle

struct Match {
  float u, v, d;
};

/// d = a u + b v + c
struct Plane {
  float a = 0.0F, b = 0.0F, c = 0.0F;
  float At(float u, float v) const { return a * u + b * v + c; }
  bool Holds(const Match& m, float tolerance) const { return std::abs(At(m.u, m.v) - m.d) <= tolerance; }
};

/// A connected region of uniform color.
struct Surface {
  std::uint32_t pixels = 0;
  std::vector<Match> matches;
  std::optional<Plane> plane;
  /// A second plane that many matches agree with: the region may contain two surfaces.
  std::optional<Plane> rival;
  bool overrules = false;
};

std::optional<Plane> Through(const Match& p, const Match& q, const Match& r) {
  Eigen::Matrix3f m;
  m << p.u, p.v, 1.0F, q.u, q.v, 1.0F, r.u, r.v, 1.0F;
  if (std::abs(m.determinant()) < kLeastArea) return std::nullopt;
  const Eigen::Vector3f x = m.inverse() * Eigen::Vector3f(p.d, q.d, r.d);
  if (x.head<2>().norm() > kSteepest) return std::nullopt;
  return Plane{x[0], x[1], x[2]};
}

/// Least-squares plane through the matches that agree with `plane`.
Plane RefinedPlane(const Plane& plane, std::span<const Match> matches, float tolerance) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Match& match : matches) {
    if (!plane.Holds(match, tolerance)) continue;
    const Eigen::Vector3d x(match.u, match.v, 1.0);
    normal += x * x.transpose();
    right += static_cast<double>(match.d) * x;
  }
  const Eigen::Vector3f x = normal.ldlt().solve(right).cast<float>();
  return {x[0], x[1], x[2]};
}

/// Takes every n-th match, so that the sample covers the whole surface.
std::vector<Match> Thinned(std::span<const Match> matches) {
  const std::size_t step = (matches.size() + kJudges - 1) / kJudges;
  std::vector<Match> some;
  for (std::size_t i = 0; i < matches.size(); i += step) some.push_back(matches[i]);
  return some;
}

/// Score of a plane: each match adds 1 if it lies on the plane, falling to 0 at the tolerance [MSAC: Torr,
/// Zisserman, CVIU 78, 2000].
float Agreement(const Plane& plane, std::span<const Match> matches, float tolerance) {
  float sum = 0.0F;
  for (const Match& m : matches) {
    const float off = (plane.At(m.u, m.v) - m.d) / tolerance;
    sum += std::max(0.0F, 1.0F - off * off);
  }
  return sum;
}

/// The plane with the best score, and the share of matches within the tolerance of it. RANSAC in which every
/// new best plane is refined immediately [Chum, Matas, Kittler: Locally Optimized RANSAC, DAGM 2003]: most
/// samples then converge to the same plane, so that the result depends little on the random draw.
struct Found {
  Plane plane;
  double share = 0.0;
};
Found FindPlane(std::span<const Match> matches, float tolerance, std::mt19937& random) {
  if (matches.empty()) return {};
  const std::vector<Match> judges = Thinned(matches);
  std::uniform_int_distribution<std::size_t> any(0, judges.size() - 1);
  float best = 0.0F;
  Plane plane;
  const auto consider = [&](const Plane& candidate) {
    const float agreement = Agreement(candidate, judges, tolerance);
    if (agreement <= best) return false;
    best = agreement;
    plane = candidate;
    return true;
  };
  for (int k = 0; k < kTrials; ++k) {
    const Match& p = judges[any(random)];
    const Match& q = judges[any(random)];
    const auto candidate = Through(p, q, judges[any(random)]);
    if (!candidate || !consider(*candidate)) continue;
    for (int i = 0; i < kMostRefinements && consider(RefinedPlane(plane, judges, tolerance)); ++i) continue;
  }
  if (best == 0.0F) return {};
  for (int k = 0; k < kLastRefinements; ++k) plane = RefinedPlane(plane, matches, tolerance);
  const auto agree =
      std::count_if(judges.begin(), judges.end(), [&](const Match& m) { return plane.Holds(m, tolerance); });
  return {plane, static_cast<double>(agree) / static_cast<double>(judges.size())};
}

void FindPlanes(Surface& surface, const SurfaceFillOptions& options, std::mt19937& random) {
  const auto tolerance = static_cast<float>(options.tolerance);
  const Found first = FindPlane(surface.matches, tolerance, random);
  if (first.share < options.least_agreement) return;
  surface.plane = first.plane;
  surface.overrules = first.share > options.overrule_agreement ||
                      static_cast<double>(surface.matches.size()) < options.bare * surface.pixels;
  std::vector<Match> others;
  for (const Match& match : surface.matches) {
    if (!first.plane.Holds(match, 2.0F * tolerance)) others.push_back(match);
  }
  if (others.empty()) return;
  const Found second = FindPlane(others, tolerance, random);
  const double share =
      second.share * static_cast<double>(others.size()) / static_cast<double>(surface.matches.size());
  if (share > options.rival * first.share) surface.rival = second.plane;
}

/// For each pixel, the root pixel of its region.
std::vector<std::uint32_t> EvenRegions(const ByteImage& image, int step) {
  ByteImage blurred(image.width(), image.height(), image.channels());
  cv::Mat to(image.height(), image.width(), CV_MAKETYPE(CV_8U, image.channels()), blurred.data().data());
  cv::GaussianBlur(ViewOf(image), to, {0, 0}, kBlurSigma);
  const auto width = static_cast<std::uint32_t>(image.width());
  const auto count = width * static_cast<std::uint32_t>(image.height());
  const auto channels = static_cast<std::uint32_t>(image.channels());
  const auto even = [&](std::uint32_t i, std::uint32_t j) {
    for (std::uint32_t k = 0; k < channels; ++k) {
      const int difference = blurred.data()[i * channels + k] - blurred.data()[j * channels + k];
      if (std::abs(difference) > step) return false;
    }
    return true;
  };
  Regions regions(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (i % width != 0 && even(i, i - 1)) regions.Join(i, i - 1);
    if (i >= width && even(i, i - width)) regions.Join(i, i - width);
  }
  std::vector<std::uint32_t> roots(count);
  for (std::uint32_t i = 0; i < count; ++i) roots[i] = regions.RootOf(i);
  return roots;
}

}  // namespace

void FillSurfaces(const ByteImage& image, const SurfaceFillOptions& options, float max_disparity,
                  DisparityMap& disparity) {
  std::vector<float>& d = disparity.data();
  const std::vector<std::uint32_t> roots = EvenRegions(image, options.step);
  const auto count = static_cast<std::uint32_t>(roots.size());
  const auto width = static_cast<std::uint32_t>(image.width());
  const auto u = [&](std::uint32_t i) { return static_cast<float>(i % width); };
  const auto v = [&](std::uint32_t i) { return static_cast<float>(i / width); };

  struct Region {
    std::uint32_t pixels = 0, matches = 0;
    std::int32_t surface = -1;
  };
  std::vector<Region> regions(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    ++regions[roots[i]].pixels;
    regions[roots[i]].matches += std::isnan(d[i]) ? 0U : 1U;
  }
  std::vector<Surface> surfaces;
  for (Region& region : regions) {
    const bool has_gaps = region.matches < region.pixels;
    if (!has_gaps || region.pixels < static_cast<std::uint32_t>(options.least_pixels) ||
        region.matches < static_cast<std::uint32_t>(options.least_matches) ||
        region.matches < options.least_share * region.pixels) {
      continue;
    }
    region.surface = static_cast<std::int32_t>(surfaces.size());
    surfaces.emplace_back().pixels = region.pixels;
  }
  const auto surface_of = [&](std::uint32_t i) -> Surface* {
    const std::int32_t surface = regions[roots[i]].surface;
    return surface < 0 ? nullptr : &surfaces[static_cast<std::size_t>(surface)];
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (std::isnan(d[i])) continue;
    if (Surface* const surface = surface_of(i)) surface->matches.push_back({u(i), v(i), d[i]});
  }
  std::mt19937 random(options.seed);
  for (Surface& surface : surfaces) FindPlanes(surface, options, random);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Surface* const surface = surface_of(i);
    if (surface == nullptr || !surface->plane) continue;
    const float tolerance = static_cast<float>(options.tolerance);
    float on_plane = surface->plane->At(u(i), v(i));
    if (surface->rival) {
      const float on_rival = surface->rival->At(u(i), v(i));
      if (std::abs(on_rival - d[i]) <= tolerance) continue;
      if (on_rival >= 0.0F) on_plane = std::min(on_plane, on_rival);
    }
    if (on_plane < 0.0F || on_plane >= max_disparity) continue;
    if (std::isnan(d[i]) || (surface->overrules && std::abs(on_plane - d[i]) > tolerance)) {
      d[i] = on_plane;
    }
  }
}

}  // namespace thalweg::stereo
