#include "services/mapper/core/occupancy_map.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include "common/base/require.h"
#include "common/base/text.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"
#include "services/mapper/core/scan_points.h"
#include "services/mapper/core/surface_fill.h"

namespace thalweg::mapper {

namespace {

constexpr double kFillMinGapVoxels = 0.7;
static_assert(SurfaceFill::kNowhere == ScanMarks::kOutside);

int ReachInVoxels(const OccupancyMap::Options& options) {
  return static_cast<int>(std::ceil(options.max_range / options.voxel_size)) + 1;
}

/// The share of a Gaussian distribution along the ray, centered at p_W, that lies in the voxel of p_W; 0 if
/// anything is NaN.
/// @param sigma  Standard deviation in units of the length of ray_W.
double ShareInVoxel(const Eigen::Vector3f& p_W, const Eigen::Vector3f& ray_W, double sigma,
                    double voxel_size) {
  double ahead = std::numeric_limits<double>::infinity();
  double behind = ahead;
  for (int axis = 0; axis < 3; ++axis) {
    const auto along = static_cast<double>(ray_W[axis]);
    if (along == 0.0) continue;
    const double cell = static_cast<double>(p_W[axis]) / voxel_size;
    const double above_floor = cell - std::floor(cell);
    const double up = (1.0 - above_floor) * voxel_size / std::abs(along);
    const double down = above_floor * voxel_size / std::abs(along);
    ahead = std::min(ahead, along > 0.0 ? up : down);
    behind = std::min(behind, along > 0.0 ? down : up);
  }
  const double scale = 1.0 / (std::sqrt(2.0) * sigma);
  const double share = 0.5 * (std::erf(ahead * scale) + std::erf(behind * scale));
  return share > 0.0 ? share : 0.0;
}

bool HasSizeOf(const PointCloud& cloud, const PinholeCamera& camera) {
  return cloud.width_px == camera.width_px && cloud.height_px == camera.height_px &&
         cloud.points_C.size() ==
             static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
}

float SquaredNorm(const Eigen::Vector3f& v) {
  return v.x() * v.x() + v.y() * v.y() + v.z() * v.z();
}

}  // namespace

const OccupancyMap::Options& Checked(const OccupancyMap::Options& o) {
  Require(std::isfinite(o.voxel_size) && o.voxel_size > 0.0, "voxel_size", o.voxel_size, "> 0 m");
  Require(o.max_range > 0.0 && o.max_range <= o.voxel_size * (ScanMarks::kMaxReach - 1), "max_range",
          o.max_range, "> 0 m and below 400 voxels");
  Require(o.min_range >= 0.0 && o.min_range < o.max_range, "min_range", o.min_range,
          ">= 0 m and below max_range");
  Require(std::isfinite(o.log_odds_hit) && o.log_odds_hit > 0.0F, "log_odds_hit", o.log_odds_hit, "> 0");
  Require(std::isfinite(o.log_odds_miss) && o.log_odds_miss < 0.0F, "log_odds_miss", o.log_odds_miss, "< 0");
  Require(std::isfinite(o.log_odds_min) && o.log_odds_min < 0.0F, "log_odds_min", o.log_odds_min, "< 0");
  Require(std::isfinite(o.log_odds_max) && o.log_odds_max > 0.0F, "log_odds_max", o.log_odds_max, "> 0");
  Require(std::isfinite(o.fill_max_gap) && o.fill_max_gap > 0.0, "fill_max_gap", o.fill_max_gap, "> 0 m");
  Require(o.shadow >= 0.0, "shadow", o.shadow, ">= 0 m");
  Require(o.fill_tolerance >= 0.0, "fill_tolerance", o.fill_tolerance, ">= 0");
  Require(o.depth_error.sigma >= 0.0, "depth_error", o.depth_error.sigma, ">= 0 1/m");
  Require(o.min_hit_probability >= 0.0 && o.min_hit_probability < 1.0, "min_hit_probability",
          o.min_hit_probability, ">= 0 and below 1");
  return o;
}

OccupancyMap::Options OccupancyMap::Options::OfOctomap() {
  Options options;
  options.protect = options.fill = options.exact_rays = false;
  options.shadow = 0.0;
  return options;
}

OccupancyMap::OccupancyMap(const Options& options)
    : OccupancyMap(options, OccupancyGrid(Checked(options).voxel_size)) {}

OccupancyMap::OccupancyMap(const Options& options, OccupancyGrid map)
    : options_(Checked(options)),
      grid_(std::move(map)),
      marks_(options_.voxel_size, ReachInVoxels(options_)) {
  Require(grid_.voxel_size() == options_.voxel_size, "voxel_size", options_.voxel_size,
          ("that of the map to resume from, " + NumberText(grid_.voxel_size())).c_str());
  if (options_.depth_error.sigma > 0.0) smoother_.emplace(options_.depth_error);
}

std::span<const VoxelChange> OccupancyMap::Integrate(const PointCloud& cloud, const RigidTransform& T_WC) {
  changes_.clear();
  hits_.clear();
  const Eigen::Matrix3f R_WC = T_WC.linear().cast<float>();
  const Eigen::Vector3f p_WC = T_WC.translation().cast<float>();
  const double reach = options_.voxel_size * (kMaxVoxelIndex - ScanMarks::kMaxReach);
  if (!(p_WC.cast<double>().cwiseAbs().maxCoeff() < reach)) return changes_;
  marks_.MoveTo(p_WC);
  if (smoother_) SplitByError(cloud, R_WC, p_WC);
  const PointCloud& sure = smoother_ ? sure_ : cloud;
  far_seen_.fill(marks_.sensor_voxel());  // a value that no voxel beyond the window equals
  CollectEnds(sure, R_WC, p_WC, ends_);
  if (smoother_) CollectEnds(unsure_, R_WC, p_WC, unsure_ends_);
  if (smoother_) {
    rays_.clear();
    AddRays(unsure_, R_WC, p_WC, unsure_ends_, /*are_hits=*/false);
    marks_.MarkRays(rays_, ScanMarks::kWeakMiss);
  }
  rays_.clear();
  AddRays(sure, R_WC, p_WC, ends_, /*are_hits=*/true);
  if (options_.no_return) AddOpenRays(cloud, R_WC, p_WC);
  marks_.MarkRays(rays_);
  if (options_.shadow > 0.0) CastShadows(sure, R_WC, p_WC, hits_);
  if (options_.shadow > 0.0 && smoother_) CastShadows(unsure_, R_WC, p_WC, unsure_ends_);
  for (const Hit& hit : hits_) marks_.Set(hit.voxel, ScanMarks::kHit);
  if (CanFill(sure)) FillSurfaces(sure, R_WC, p_WC);
  ApplyMarks();
  return changes_;
}

void OccupancyMap::SplitByError(const PointCloud& cloud, const Eigen::Matrix3f& R_WC,
                                const Eigen::Vector3f& p_WC) {
  // Clearing a real surface does more harm than stopping short of it. The cleared ray therefore ends 3 sigma
  // before the estimate, and earlier still by the shift (`hidden`) that a depth edge too low for the tests to
  // detect may have caused in an averaged depth.
  constexpr float kClearSigmas = 3.0F;
  const auto hidden = static_cast<float>(0.25 * options_.depth_error.sigma);
  const Eigen::Vector3f none = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  smoother_->Smooth(cloud);
  sure_ = {cloud.width_px, cloud.height_px, {}, {}};
  unsure_ = sure_;
  sure_.points_C.reserve(cloud.points_C.size());
  unsure_.points_C.reserve(cloud.points_C.size());
  for (std::size_t pixel = 0; pixel < cloud.points_C.size(); ++pixel) {
    const float inverse = smoother_->inverse_depths()[pixel];
    const float sigma = smoother_->sigmas()[pixel];
    const Eigen::Vector3f ray_C = cloud.points_C[pixel] / cloud.points_C[pixel].z();
    const Eigen::Vector3f point_C = ray_C / inverse;
    const Eigen::Vector3f ray_W = ToWorld(R_WC, Eigen::Vector3f::Zero(), ray_C);
    const double depth_error = static_cast<double>(sigma / (inverse * inverse));
    const bool sure = ShareInVoxel(ToWorld(R_WC, p_WC, point_C), ray_W, depth_error, options_.voxel_size) >=
                      options_.min_hit_probability;
    sure_.points_C.push_back(sure ? point_C : none);
    const float nearest_inverse = inverse + kClearSigmas * sigma + hidden;
    unsure_.points_C.push_back(sure ? none : Eigen::Vector3f(ray_C / nearest_inverse));
  }
}

void OccupancyMap::CollectEnds(const PointCloud& cloud, const Eigen::Matrix3f& R_WC,
                               const Eigen::Vector3f& p_WC, std::vector<Hit>& ends) {
  ends.clear();
  const bool keep_offsets = &ends == &ends_ && CanFill(cloud);
  if (keep_offsets) pixel_offsets_.clear();
  VoxelBatch batch;
  std::array<std::uint32_t, VoxelBatch::kSize> offsets;
  const std::span<const Eigen::Vector3f> points(cloud.points_C);
  for (std::size_t first = 0; first < points.size(); first += VoxelBatch::kSize) {
    const std::size_t count = std::min(VoxelBatch::kSize, points.size() - first);
    PlaceInVoxels(points.subspan(first, count), R_WC, p_WC, options_.voxel_size, options_.min_range, batch);
    marks_.Locate(batch, offsets);
    if (keep_offsets) {
      pixel_offsets_.insert(pixel_offsets_.end(), offsets.begin(),
                            offsets.begin() + static_cast<std::ptrdiff_t>(count));
    }
    for (std::size_t k = 0; k < count; ++k) {
      const VoxelIndex voxel{batch.x[k], batch.y[k], batch.z[k]};
      if (offsets[k] != ScanMarks::kOutside) {
        std::uint8_t& mark = marks_.At(offsets[k]);
        if (mark == ScanMarks::kSeen) continue;
        mark = ScanMarks::kSeen;
      } else {
        if (voxel.x == VoxelBatch::kNone) continue;
        // This cache catches most duplicates; a missed one only costs a ray.
        VoxelIndex& seen = far_seen_[VoxelIndexHash{}(voxel) % far_seen_.size()];
        if (seen == voxel) continue;
        seen = voxel;
      }
      ends.push_back({voxel, static_cast<std::uint32_t>(first + k)});
    }
  }
}

void OccupancyMap::AddRays(const PointCloud& cloud, const Eigen::Matrix3f& R_WC, const Eigen::Vector3f& p_WC,
                           std::span<const Hit> ends, bool are_hits) {
  const auto max_range = static_cast<float>(options_.max_range);
  for (const Hit& hit : ends) {
    const VoxelIndex& end = hit.voxel;
    const Eigen::Vector3f end_W = options_.exact_rays ? ToWorld(R_WC, p_WC, cloud.points_C[hit.pixel])
                                                      : VoxelCenter(end, options_.voxel_size).cast<float>();
    const Eigen::Vector3f ray = end_W - p_WC;
    const double range = std::sqrt(static_cast<double>(SquaredNorm(ray)));
    const bool is_hit = are_hits && range <= options_.max_range;
    if (is_hit) {
      hits_.push_back(hit);
    } else if (marks_.Contains(end)) {
      marks_.At(marks_.OffsetOf(end)) = ScanMarks::kNone;
    }
    if (range <= options_.max_range) {
      rays_.push_back({end_W, end});
      continue;
    }
    const auto length = static_cast<float>(range);
    const Eigen::Vector3f direction(ray.x() / length, ray.y() / length, ray.z() / length);
    const Eigen::Vector3f cut_W = p_WC + direction * max_range;
    rays_.push_back({cut_W, VoxelAt(cut_W.cast<double>(), options_.voxel_size)});
  }
}

void OccupancyMap::AddOpenRays(const PointCloud& cloud, const Eigen::Matrix3f& R_WC,
                               const Eigen::Vector3f& p_WC) {
  const PinholeCamera& camera = *options_.no_return;
  if (!HasSizeOf(cloud, camera)) return;
  const auto max_range = static_cast<float>(options_.max_range);
  far_seen_.fill(marks_.sensor_voxel());  // no entry: a ray that ends in the sensor's voxel crosses nothing
  std::size_t pixel = 0;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u, ++pixel) {
      if (!IsNoReturn(cloud.points_C[pixel])) continue;
      const Eigen::Vector3f direction_C = camera.RayAtUnitDepth(u, v).normalized().cast<float>();
      const Eigen::Vector3f end_W = ToWorld(R_WC, p_WC, direction_C * max_range);
      const VoxelIndex end = VoxelAt(end_W.cast<double>(), options_.voxel_size);
      // As for measured points, one ray per voxel is enough.
      VoxelIndex& seen = far_seen_[VoxelIndexHash{}(end) % far_seen_.size()];
      if (seen == end) continue;
      seen = end;
      rays_.push_back({end_W, end});
    }
  }
}

void OccupancyMap::CastShadows(const PointCloud& cloud, const Eigen::Matrix3f& R_WC,
                               const Eigen::Vector3f& p_WC, std::span<const Hit> ends) {
  // Before the hits are marked: a miss found here comes from rays that pass beside the point.
  for (const Hit& hit : ends) {
    const Eigen::Vector3d end_W = ToWorld(R_WC, p_WC, cloud.points_C[hit.pixel]).cast<double>();
    const Eigen::Vector3d behind_W = end_W + (end_W - p_WC.cast<double>()).normalized() * options_.shadow;
    TraverseVoxels(end_W, behind_W, options_.voxel_size, [this](const VoxelIndex& voxel) {
      if (!marks_.Contains(voxel)) return false;
      std::uint8_t& mark = marks_.At(marks_.OffsetOf(voxel));
      if (mark == ScanMarks::kMiss || mark == ScanMarks::kWeakMiss) mark = ScanMarks::kNone;
      return true;
    });
  }
}

bool OccupancyMap::CanFill(const PointCloud& cloud) const {
  const bool organized = cloud.width_px > 1 && cloud.height_px > 1 &&
                         cloud.points_C.size() == static_cast<std::size_t>(cloud.width_px) *
                                                      static_cast<std::size_t>(cloud.height_px);
  return options_.fill && organized;
}

void OccupancyMap::FillSurfaces(const PointCloud& cloud, const Eigen::Matrix3f& R_WC,
                                const Eigen::Vector3f& p_WC) {
  const auto in_range = [this](const Eigen::Vector3f& p_C) {
    return static_cast<double>(SquaredNorm(p_C)) <= options_.max_range * options_.max_range;
  };
  const SurfaceFill fill({.min_gap = kFillMinGapVoxels * options_.voxel_size,
                          .max_gap = options_.fill_max_gap,
                          .tolerance = options_.fill_tolerance});
  fill.ForEachPair(cloud, pixel_offsets_, [&](std::size_t a, std::size_t b) {
    if (!in_range(cloud.points_C[a]) || !in_range(cloud.points_C[b])) return;
    const Eigen::Vector3d a_W = ToWorld(R_WC, p_WC, cloud.points_C[a]).cast<double>();
    const Eigen::Vector3d b_W = ToWorld(R_WC, p_WC, cloud.points_C[b]).cast<double>();
    TraverseVoxels(a_W, b_W, options_.voxel_size, [&](const VoxelIndex& voxel) {
      if (!marks_.Contains(voxel) || marks_.Get(voxel) == ScanMarks::kHit) return true;
      marks_.Set(voxel, ScanMarks::kHit);
      hits_.push_back({voxel, static_cast<std::uint32_t>(a)});
      return true;
    });
  });
}

bool OccupancyMap::IsProtected(const VoxelIndex& voxel, float log_odds) const {
  if (!options_.protect || !(log_odds >= 0.0F)) return false;
  return !ForEachVoxel(CubeAround(voxel, 1),
                       [&](const VoxelIndex& neighbor) { return marks_.Get(neighbor) != ScanMarks::kHit; });
}

void OccupancyMap::ApplyBlock(const VoxelIndex& index, const std::uint8_t* marks) {
  OccupancyGrid::Block* block = nullptr;
  const float weakly_free = std::max(options_.log_odds_min, OccupancyGrid::kWeaklyFree);
  const float steps[] = {0.0F, options_.log_odds_miss, options_.log_odds_hit, options_.log_odds_miss};
  for (std::size_t row = 0; row < ScanMarks::kBlockVoxels; row += OccupancyGrid::kBlockEdge) {
    std::uint64_t row_marks = 0;
    std::memcpy(&row_marks, marks + row, sizeof(row_marks));
    if (row_marks == 0) continue;
    if (!block) block = &grid_.BlockAt(index);
    VoxelIndex voxel = OccupancyGrid::IndexInBlock(index, row);
    float* value = block->data() + row;
    const std::uint8_t* mark = marks + row;
    for (const float* end = value + OccupancyGrid::kBlockEdge; value != end; ++value, ++mark, ++voxel.x) {
      const float before = *value;
      if (*mark == ScanMarks::kNone) continue;
      if (*mark == ScanMarks::kWeakMiss && (before >= 0.0F || before <= weakly_free)) continue;
      if (*mark == ScanMarks::kMiss && IsProtected(voxel, before)) continue;
      const float start = std::isnan(before) ? 0.0F : before;
      // Eq. (2.14), clamped as in Hornung et al., Sec. 3.
      const float least = *mark == ScanMarks::kWeakMiss ? weakly_free : options_.log_odds_min;
      const float after = std::clamp(start + steps[*mark], least, options_.log_odds_max);
      if (after == before) continue;
      *value = after;
      changes_.push_back({voxel, after});
    }
  }
}

void OccupancyMap::ApplyMarks() {
  marks_.ForEachBlock(
      [this](const VoxelIndex& index, const std::uint8_t* marks) { ApplyBlock(index, marks); });
  marks_.Clear();
}

}  // namespace thalweg::mapper
