#include "services/surface/core/fused/fused_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/check.h"
#include "common/base/require.h"

namespace thalweg::surface {
namespace {

constexpr double kSqrt3 = std::numbers::sqrt3;
constexpr double kPatchStep = 2.0;  // voxels between the points of a patch around which blocks are made
/// In voxels: the corners of a cell that the surface crosses, and their neighbors, for the normals.
constexpr double kTruncation = kSqrt3 + 1.0;
/// In voxels: half the diagonal of the patch's squares more.
constexpr double kPatchReach = kTruncation + 0.5 * kPatchStep * std::numbers::sqrt2;

const FusedSurface::Options& Checked(const FusedSurface::Options& options) {
  const auto is_length = [](double value) { return std::isfinite(value) && value > 0.0; };
  Require(is_length(options.voxel_size), "voxel_size", options.voxel_size, "> 0");
  Require(is_length(options.min_depth), "min_depth", options.min_depth, "> 0");
  Require(is_length(options.max_range), "max_range", options.max_range, "> 0");
  Require(std::isfinite(options.depth_error.sigma) && options.depth_error.sigma >= 0.0, "depth_error.sigma",
          options.depth_error.sigma, ">= 0");
  return options;
}

/// The four pixels around a point of the image and their bilinear weights.
Rgb ColorBetween(const PointCloud& cloud, float u, float v) {
  const int left = std::clamp(static_cast<int>(u), 0, cloud.width_px - 2);
  const int top = std::clamp(static_cast<int>(v), 0, cloud.height_px - 2);
  const float du = std::clamp(u - static_cast<float>(left), 0.0F, 1.0F);
  const float dv = std::clamp(v - static_cast<float>(top), 0.0F, 1.0F);
  const std::size_t first = static_cast<std::size_t>(top) * static_cast<std::size_t>(cloud.width_px) +
                            static_cast<std::size_t>(left);
  const Rgb& a = cloud.colors[first];
  const Rgb& b = cloud.colors[first + 1];
  const Rgb& c = cloud.colors[first + static_cast<std::size_t>(cloud.width_px)];
  const Rgb& d = cloud.colors[first + static_cast<std::size_t>(cloud.width_px) + 1];
  const auto mix = [&](std::uint8_t Rgb::*channel) {
    const auto value = [&](const Rgb& color) { return static_cast<float>(color.*channel); };
    const float above = value(a) + du * (value(b) - value(a));
    const float below = value(c) + du * (value(d) - value(c));
    return static_cast<std::uint8_t>(std::lround(above + dv * (below - above)));
  };
  return {mix(&Rgb::r), mix(&Rgb::g), mix(&Rgb::b)};
}

}  // namespace

/// A cloud as voxels see it, in single precision.
struct FusedSurface::Sight {
  const PointCloud& cloud;
  Eigen::Matrix3f R_CW;
  Eigen::Vector3f p_CW;
  float fx, fy, cx, cy;
  float f_least;  ///< The smaller one of fx and fy, which spreads pixels more.
};

FusedSurface::FusedSurface(const Options& options)
    : FusedSurface(options, TruncatedVolume(options.voxel_size)) {}

FusedSurface::FusedSurface(const Options& options, TruncatedVolume volume)
    : options_(Checked(options)), volume_(std::move(volume)) {
  THALWEG_CHECK(volume_.voxel_size() == options_.voxel_size);
}

std::span<const VoxelIndex> FusedSurface::Fuse(const PointCloud& cloud, const PinholeCamera& camera,
                                               const RigidTransform& T_WC) {
  planes_.Compute(cloud, camera, options_.depth_error, 0.5 * options_.voxel_size);
  near_.clear();
  last_low_ = {1, 1, 1};  // no range
  last_high_ = {0, 0, 0};
  changed_.clear();
  AddBlocks(cloud, T_WC);
  const RigidTransform T_CW = T_WC.inverse();
  const Sight sight{.cloud = cloud,
                    .R_CW = T_CW.linear().cast<float>(),
                    .p_CW = T_CW.translation().cast<float>(),
                    .fx = static_cast<float>(camera.fx),
                    .fy = static_cast<float>(camera.fy),
                    .cx = static_cast<float>(camera.cx),
                    .cy = static_cast<float>(camera.cy),
                    .f_least = static_cast<float>(std::min(camera.fx, camera.fy))};
  for (const VoxelIndex& index : near_) {
    if (!full() || volume_.Find(index)) volume_.At(index);
  }
  const double block = volume_.block_size();
  const double radius = 0.5 * kSqrt3 * block;
  const Eigen::Vector2d ray_least((-0.5 - camera.cx) / camera.fx, (-0.5 - camera.cy) / camera.fy);
  const Eigen::Vector2d ray_most((camera.width_px - 0.5 - camera.cx) / camera.fx,
                                 (camera.height_px - 0.5 - camera.cy) / camera.fy);
  const auto in_view = [&](const VoxelIndex& index) {
    const Eigen::Vector3d c = T_CW * VoxelCenter(index, block);
    if (c.z() < -radius || c.norm() > options_.max_range + radius) return false;
    // Distances from the four planes through the camera and the image's edges.
    for (int axis = 0; axis < 2; ++axis) {
      const double least = ray_least[axis];
      const double most = ray_most[axis];
      if ((c[axis] - least * c.z()) / std::hypot(1.0, least) < -radius) return false;
      if ((most * c.z() - c[axis]) / std::hypot(1.0, most) < -radius) return false;
    }
    return true;
  };
  volume_.ForEachBlock([&](const VoxelIndex& index, TruncatedVolume::Block& voxels) {
    if (!near_.contains(index) && (!voxels.has_inside || !in_view(index))) return;
    if (FuseInto(voxels, index, sight)) changed_.push_back(index);
  });
  return changed_;
}

bool FusedSurface::IsUsed(const PixelPlane& plane, const Eigen::Vector3f& p_C) const {
  return plane.known() && static_cast<double>(plane.sigma) <= options_.voxel_size &&
         static_cast<double>(plane.depth) >= options_.min_depth &&
         static_cast<double>(p_C.norm()) <= options_.max_range;
}

/// Notes the blocks within reach of the patches between neighboring pixels of one surface, and of pixels.
void FusedSurface::AddBlocks(const PointCloud& cloud, const RigidTransform& T_WC) {
  using Box = Eigen::AlignedBox3f;
  const Eigen::Isometry3f T = T_WC.cast<float>();
  const auto width = static_cast<std::size_t>(cloud.width_px);
  const auto step = static_cast<float>(kPatchStep * options_.voxel_size);
  for (std::size_t pixel = 0; pixel < cloud.points_C.size(); ++pixel) {
    const Eigen::Vector3f& p_C = cloud.points_C[pixel];
    if (!IsUsed(planes_.at(pixel), p_C)) continue;
    const Eigen::Vector3f own = T * p_C;
    Box patch(own);
    constexpr int kRightBelow = 3;
    if (!planes_.IsOneSurface(pixel, kRightBelow)) {
      AddBlocksAround(patch);
      continue;
    }
    const Eigen::Vector3f right = T * cloud.points_C[pixel + 1];
    const Eigen::Vector3f below = T * cloud.points_C[pixel + width];
    const Eigen::Vector3f across = T * cloud.points_C[pixel + width + 1];
    patch.extend(right).extend(below).extend(across);
    const int steps = static_cast<int>(std::ceil(patch.sizes().maxCoeff() / step));
    if (steps <= TruncatedVolume::kEdge / static_cast<int>(kPatchStep)) {
      AddBlocksAround(patch);
      continue;
    }
    for (int j = 0; j <= steps; ++j) {
      for (int i = 0; i <= steps; ++i) {
        const float a = static_cast<float>(i) / static_cast<float>(steps);
        const float b = static_cast<float>(j) / static_cast<float>(steps);
        const Eigen::Vector3f above = (1.0F - a) * own + a * right;
        AddBlocksAround(Box(Eigen::Vector3f((1.0F - b) * above + b * ((1.0F - a) * below + a * across))));
      }
    }
  }
}

void FusedSurface::AddBlocksAround(const Eigen::AlignedBox3f& patch_W) {
  const double reach = kPatchReach * options_.voxel_size;
  const Eigen::AlignedBox3d patch = patch_W.cast<double>();
  const VoxelIndex low = VoxelAt(patch.min().array() - reach, volume_.block_size());
  const VoxelIndex high = VoxelAt(patch.max().array() + reach, volume_.block_size());
  if (low == last_low_ && high == last_high_) return;  // as of the pixel before, in most cases
  last_low_ = low;
  last_high_ = high;
  VoxelIndex i;
  for (i.z = low.z; i.z <= high.z; ++i.z) {
    for (i.y = low.y; i.y <= high.y; ++i.y) {
      for (i.x = low.x; i.x <= high.x; ++i.x) {
        if (InIndexRange(i)) near_.insert(i);
      }
    }
  }
}

bool FusedSurface::FuseInto(TruncatedVolume::Block& block, const VoxelIndex& index, const Sight& sight) {
  const auto v = static_cast<float>(options_.voxel_size);
  const Eigen::Vector3f first_W =
      VoxelCenter({index.x * TruncatedVolume::kEdge, index.y * TruncatedVolume::kEdge,
                   index.z * TruncatedVolume::kEdge},
                  options_.voxel_size)
          .cast<float>();
  const Eigen::Vector3f first_C = sight.R_CW * first_W + sight.p_CW;
  const Eigen::Matrix3f step_C = v * sight.R_CW;
  bool changed = false;
  bool has_inside = false;
  SurfaceVoxel* voxel = block.voxels.data();
  for (int z = 0; z < TruncatedVolume::kEdge; ++z) {
    for (int y = 0; y < TruncatedVolume::kEdge; ++y) {
      Eigen::Vector3f p_C =
          first_C + static_cast<float>(z) * step_C.col(2) + static_cast<float>(y) * step_C.col(1);
      for (int x = 0; x < TruncatedVolume::kEdge; ++x, ++voxel, p_C += step_C.col(0)) {
        if (FuseInto(*voxel, p_C, sight)) changed = true;
        has_inside = has_inside || (voxel->known() && voxel->distance < 0.0F);
      }
    }
  }
  block.has_inside = has_inside;
  return changed;
}

bool FusedSurface::FuseInto(SurfaceVoxel& voxel, const Eigen::Vector3f& p_C, const Sight& sight) const {
  if (p_C.z() < static_cast<float>(options_.min_depth)) return false;
  const float u = sight.fx * p_C.x() / p_C.z() + sight.cx;
  const float v = sight.fy * p_C.y() / p_C.z() + sight.cy;
  const float nearest_u = std::floor(u + 0.5F);
  const float nearest_v = std::floor(v + 0.5F);
  if (!(nearest_u >= 0.0F && nearest_v >= 0.0F && nearest_u < static_cast<float>(sight.cloud.width_px) &&
        nearest_v < static_cast<float>(sight.cloud.height_px))) {
    return false;
  }
  const std::size_t pixel =
      static_cast<std::size_t>(nearest_v) * static_cast<std::size_t>(sight.cloud.width_px) +
      static_cast<std::size_t>(nearest_u);
  const int quadrant = (u > nearest_u ? 1 : 0) | (v > nearest_v ? 2 : 0);
  const auto size = static_cast<float>(options_.voxel_size);
  const float spacing = p_C.z() / sight.f_least;
  const PixelPlane& plane = planes_.at(pixel);
  const float truncation = static_cast<float>(kTruncation) * size + 3.0F * plane.sigma;
  const bool used = IsUsed(plane, sight.cloud.points_C[pixel]);
  const float distance = used ? plane.DistanceTo(p_C) : 0.0F;
  if (used && distance < -truncation) return false;
  if (!used || distance > truncation) {
    const float depth = planes_.LeastDepth(pixel, quadrant);
    const float error =
        std::isfinite(depth) ? 3.0F * static_cast<float>(options_.depth_error.sigma) * depth * depth : 0.0F;
    if (!(depth > p_C.z() + truncation + error)) return false;
    if (spacing > std::max(size, voxel.finest.value())) return false;
    return voxel.FuseFree(static_cast<float>(kTruncation) * size,
                          size * size / (size * size + spacing * spacing));
  }
  const float on_surface = spacing / std::max(plane.cosine, 1e-3F);
  const bool on_ray = 2.0F * on_surface * std::max(std::abs(u - nearest_u), std::abs(v - nearest_v)) <= size;
  if (!on_ray && !planes_.IsOneSurface(pixel, quadrant)) return false;
  const float weight =
      size * size /
      (size * size + on_surface * on_surface + distance * distance + 12.0F * plane.sigma * plane.sigma);
  bool changed =
      voxel.Fuse({.distance = distance, .weight = weight, .margin = 0.5F * size + 3.0F * plane.sigma});
  voxel.finest.Lower(spacing);
  if (std::abs(distance) > static_cast<float>(kSqrt3) * size || !voxel.known()) return changed;
  if (!sight.cloud.colors.empty()) {
    const Rgb before = voxel.color;
    voxel.Paint(ColorBetween(sight.cloud, u, v), weight);
    changed = changed || !(voxel.color == before);
  }
  if (2.0F * std::abs(distance) <= static_cast<float>(kSqrt3) * size) {
    const ViewQuality quality{.distance = p_C.norm(), .cosine = plane.cosine, .sampling = on_surface};
    if (voxel.best.Improve(quality, options_.limits.Inspects(quality))) changed = true;
  }
  return changed;
}

}  // namespace thalweg::surface
