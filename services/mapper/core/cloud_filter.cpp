#include "services/mapper/core/cloud_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "common/base/check.h"
#include "common/base/require.h"
#include "common/voxel/voxel_index.h"

namespace thalweg::mapper {
namespace {

constexpr double kSmallestCell = 0.001;  // [m]
constexpr float kBeyondSensors = 1e4F;   // [m] up to which every such cell has an index

void DropPoint(Eigen::Vector3f& p_C) {
  p_C.setConstant(std::numeric_limits<float>::quiet_NaN());
}

/// Indices of the points that were measured, but for those that no map holds: their squares may not be
/// finite.
std::vector<std::uint32_t> MeasuredPoints(const PointCloud& cloud) {
  std::vector<std::uint32_t> measured;
  measured.reserve(cloud.points_C.size());
  for (std::uint32_t k = 0; k < cloud.points_C.size(); ++k) {
    if ((cloud.points_C[k].array().abs() < kBeyondSensors).all()) measured.push_back(k);
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

/// The places at which points lie, each once: many drivers write all pixels that were not measured as one
/// point. As nanoflann reads them.
class Places {
 public:
  explicit Places(const PointCloud& cloud) : points_(MeasuredPoints(cloud)) {
    std::ranges::sort(points_, {}, [&](std::uint32_t k) {
      const Eigen::Vector3f& p_C = cloud.points_C[k];
      return std::tuple(p_C.x(), p_C.y(), p_C.z());
    });
    for (std::uint32_t n = 0; n < points_.size(); ++n) {
      const Eigen::Vector3f& p_C = cloud.points_C[points_[n]];
      if (!places_C_.empty() && places_C_.back() == p_C) continue;
      places_C_.push_back(p_C);
      first_.push_back(n);
    }
    first_.push_back(static_cast<std::uint32_t>(points_.size()));
  }

  std::size_t size() const { return places_C_.size(); }
  std::size_t point_count() const { return points_.size(); }
  const Eigen::Vector3f& operator[](std::size_t place) const { return places_C_[place]; }
  /// Indices of the points there.
  std::span<const std::uint32_t> PointsAt(std::size_t place) const {
    return std::span(points_).subspan(first_[place], first_[place + 1] - first_[place]);
  }

  std::size_t kdtree_get_point_count() const { return size(); }
  float kdtree_get_pt(std::size_t place, std::size_t axis) const {
    return places_C_[place][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;  // nanoflann computes it
  }

 private:
  std::vector<std::uint32_t> points_;  ///< By place.
  std::vector<Eigen::Vector3f> places_C_;
  std::vector<std::uint32_t> first_;  ///< The place's first index in points_, and the end of the last one's.
};

// Where GCC 12 inlines nanoflann's constructor, it takes the memory of an empty vector for a null pointer in
// use.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnull-dereference"

class OutlierFilter final : public CloudFilter {
 public:
  OutlierFilter(int neighbors, double deviations)
      : neighbors_(static_cast<std::size_t>(neighbors)), deviations_(deviations) {}

  void Apply(PointCloud& cloud) override {
    const Places places(cloud);
    if (places.point_count() <= neighbors_) return;  // too few to tell what is usual
    const std::vector<double> distances = MeanDistances(places);
    double sum = 0.0;
    double square_sum = 0.0;
    for (std::size_t n = 0; n < places.size(); ++n) {
      const auto points = static_cast<double>(places.PointsAt(n).size());
      sum += points * distances[n];
      square_sum += points * distances[n] * distances[n];
    }
    const auto count = static_cast<double>(places.point_count());
    const double mean = sum / count;
    const double deviation = std::sqrt(std::max(0.0, (square_sum - sum * mean) / (count - 1.0)));
    for (std::size_t n = 0; n < places.size(); ++n) {
      if (distances[n] <= mean + deviations_ * deviation) continue;
      for (const std::uint32_t k : places.PointsAt(n)) DropPoint(cloud.points_C[k]);
    }
  }

 private:
  /// [m] Mean distance of the points of each place to their nearest neighbors.
  std::vector<double> MeanDistances(const Places& places) const {
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Places>, Places, 3>;
    const Tree tree(3, places);
    std::vector<std::uint32_t> found(std::min(neighbors_ + 1, places.size()));  // with the place itself
    std::vector<float> squares(found.size());
    std::vector<double> means;
    means.reserve(places.size());
    for (std::size_t place = 0; place < places.size(); ++place) {
      tree.knnSearch(places[place].data(), found.size(), found.data(), squares.data());
      std::size_t missing = neighbors_ - std::min(neighbors_, places.PointsAt(place).size() - 1);
      double sum = 0.0;
      for (std::size_t n = 0; n < found.size() && missing > 0; ++n) {
        if (found[n] == place) continue;
        const std::size_t points = std::min(missing, places.PointsAt(found[n]).size());
        sum += static_cast<double>(points) * std::sqrt(static_cast<double>(squares[n]));
        missing -= points;
      }
      means.push_back(sum / static_cast<double>(neighbors_));
    }
    return means;
  }

  std::size_t neighbors_;
  double deviations_;
};

#pragma GCC diagnostic pop

}  // namespace

std::unique_ptr<CloudFilter> MakeFilter(const FilterModel& model) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  Require(positive(model.max_distance), "filter.max_distance", model.max_distance, "> 0");
  Require(std::isfinite(model.cell) && model.cell >= kSmallestCell, "filter.cell", model.cell, ">= 0.001");
  Require(model.neighbors >= 1, "filter.neighbors", model.neighbors, ">= 1");
  Require(model.deviations >= 0.0, "filter.deviations", model.deviations, ">= 0");
  switch (model.type) {
    case FilterModel::Type::kNone:
      return nullptr;
    case FilterModel::Type::kDistance:
      return std::make_unique<DistanceFilter>(model.max_distance);
    case FilterModel::Type::kVoxel:
      return std::make_unique<VoxelFilter>(model.cell);
    case FilterModel::Type::kOutlier:
      return std::make_unique<OutlierFilter>(model.neighbors, model.deviations);
  }
  THALWEG_CHECK(!"a type without a filter");
  return nullptr;
}

}  // namespace thalweg::mapper
