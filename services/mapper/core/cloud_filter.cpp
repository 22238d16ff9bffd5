#include "services/mapper/core/cloud_filter.h"

#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <unordered_map>
#include <vector>

#include "common/base/check.h"
#include "common/base/require.h"
#include "common/voxel/voxel_index.h"

namespace thalweg::mapper {
namespace {

constexpr float kFarthest = 1e4F;  // [m] far beyond every sensor, and every voxel of 1 mm has an index

void DropPoint(Eigen::Vector3f& p_C) {
  p_C.setConstant(std::numeric_limits<float>::quiet_NaN());
}

/// Indices of the points that were measured, but for those that no map holds: their squares may not be
/// finite.
std::vector<std::uint32_t> MeasuredPoints(const PointCloud& cloud) {
  std::vector<std::uint32_t> measured;
  measured.reserve(cloud.points_C.size());
  for (std::uint32_t k = 0; k < cloud.points_C.size(); ++k) {
    if ((cloud.points_C[k].array().abs() < kFarthest).all()) measured.push_back(k);
  }
  return measured;
}

class DistanceFilter final : public CloudFilter {
 public:
  explicit DistanceFilter(double max_distance) : max_distance_(static_cast<float>(max_distance)) {}
  void Apply(PointCloud& cloud) override {
    for (Eigen::Vector3f& p_C : cloud.points_C) {
      if (!IsNoReturn(p_C) && p_C.norm() > max_distance_) DropPoint(p_C);
    }
  }

 private:
  float max_distance_;
};

class VoxelFilter final : public CloudFilter {
 public:
  explicit VoxelFilter(double cell) : cell_(cell) {}
  void Apply(PointCloud& cloud) override {
    struct Cell {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int points = 0;
      std::uint32_t kept = 0;
      double distance = std::numeric_limits<double>::infinity();
    };
    const std::vector<std::uint32_t> measured = MeasuredPoints(cloud);
    std::unordered_map<VoxelIndex, Cell, VoxelIndexHash> cells;
    std::vector<Cell*> cell_of;
    cell_of.reserve(measured.size());
    for (const std::uint32_t k : measured) {
      const Eigen::Vector3d p_C = cloud.points_C[k].cast<double>();
      Cell& cell = cells[VoxelAt(p_C, cell_)];
      cell.sum += p_C;
      ++cell.points;
      cell_of.push_back(&cell);
    }
    for (std::size_t n = 0; n < measured.size(); ++n) {
      Cell& cell = *cell_of[n];
      const Eigen::Vector3d mean_C = cell.sum / cell.points;
      const double distance = (cloud.points_C[measured[n]].cast<double>() - mean_C).squaredNorm();
      if (distance >= cell.distance) continue;
      cell.distance = distance;
      cell.kept = measured[n];
    }
    for (std::size_t n = 0; n < measured.size(); ++n) {
      if (cell_of[n]->kept != measured[n]) DropPoint(cloud.points_C[measured[n]]);
    }
  }

 private:
  double cell_;
};

/// The measured points of a cloud, as nanoflann reads them.
struct PointsInTree {
  const PointCloud& cloud;
  const std::vector<std::uint32_t>& measured;

  std::size_t kdtree_get_point_count() const { return measured.size(); }
  float kdtree_get_pt(std::size_t n, std::size_t axis) const {
    return cloud.points_C[measured[n]][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;  // nanoflann computes it
  }
};

class OutlierFilter final : public CloudFilter {
 public:
  OutlierFilter(int neighbors, double deviations)
      : neighbors_(static_cast<std::size_t>(neighbors)), deviations_(deviations) {}

  void Apply(PointCloud& cloud) override {
    const std::vector<std::uint32_t> measured = MeasuredPoints(cloud);
    if (measured.size() <= neighbors_) return;  // too few to tell what is usual
    const std::vector<double> distances = MeanDistances({cloud, measured});
    double sum = 0.0;
    double square_sum = 0.0;
    for (const double distance : distances) {
      sum += distance;
      square_sum += distance * distance;
    }
    const auto count = static_cast<double>(distances.size());
    const double mean = sum / count;
    const double deviation = std::sqrt(std::max(0.0, (square_sum - sum * mean) / (count - 1.0)));
    for (std::size_t n = 0; n < measured.size(); ++n) {
      if (distances[n] > mean + deviations_ * deviation) DropPoint(cloud.points_C[measured[n]]);
    }
  }

 private:
  /// [m] Mean distance of each point to its nearest neighbors.
  std::vector<double> MeanDistances(const PointsInTree& points) const {
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointsInTree>,
                                                     PointsInTree, 3>;
    const Tree tree(3, points);
    const std::size_t wanted = neighbors_ + 1;  // with the point itself
    std::vector<std::uint32_t> found(wanted);
    std::vector<float> squares(wanted);
    std::vector<double> means;
    means.reserve(points.measured.size());
    for (const std::uint32_t k : points.measured) {
      tree.knnSearch(points.cloud.points_C[k].data(), wanted, found.data(), squares.data());
      double sum = 0.0;
      for (const float square : squares) sum += std::sqrt(static_cast<double>(square));
      means.push_back(sum / static_cast<double>(neighbors_));
    }
    return means;
  }

  std::size_t neighbors_;
  double deviations_;
};

}  // namespace

std::unique_ptr<CloudFilter> MakeFilter(const FilterOptions& options) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  Require(positive(options.max_distance), "filter.max_distance", options.max_distance, "> 0");
  Require(positive(options.cell), "filter.cell", options.cell, "> 0");
  Require(options.neighbors >= 1, "filter.neighbors", options.neighbors, ">= 1");
  Require(options.deviations >= 0.0, "filter.deviations", options.deviations, ">= 0");
  switch (options.type) {
    case FilterOptions::Type::kNone:
      return nullptr;
    case FilterOptions::Type::kDistance:
      return std::make_unique<DistanceFilter>(options.max_distance);
    case FilterOptions::Type::kVoxel:
      return std::make_unique<VoxelFilter>(options.cell);
    case FilterOptions::Type::kOutlier:
      return std::make_unique<OutlierFilter>(options.neighbors, options.deviations);
  }
  THALWEG_CHECK(!"a type without a filter");
  return nullptr;
}

}  // namespace thalweg::mapper
