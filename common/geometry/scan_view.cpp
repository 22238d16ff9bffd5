#include "common/geometry/scan_view.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace thalweg {
namespace {

int IsMeasured(const Eigen::Vector3f& p_C) {  // branch-free, since holes in depth images are unpredictable
  return static_cast<int>(!std::isnan(p_C.x())) & static_cast<int>(!std::isnan(p_C.y())) &
         static_cast<int>(!std::isnan(p_C.z()));
}

}  // namespace

std::optional<MeasuredShares> MeasuredShares::Of(const PointCloud& cloud) {
  if (cloud.width_px < kSide || cloud.height_px < kSide) return std::nullopt;
  const auto width = static_cast<std::size_t>(cloud.width_px);
  const auto height = static_cast<std::size_t>(cloud.height_px);
  THALWEG_CHECK(cloud.points_C.size() == width * height);
  constexpr std::size_t kCells = kSide;
  MeasuredShares shares;
  for (std::size_t row = 0; row < kCells; ++row) {
    // Pixel v belongs to row floor(kCells v / height).
    const std::size_t first_v = (row * height + kCells - 1) / kCells;
    const std::size_t end_v = ((row + 1) * height + kCells - 1) / kCells;
    for (std::size_t column = 0; column < kCells; ++column) {
      const std::size_t first_u = (column * width + kCells - 1) / kCells;
      const std::size_t end_u = ((column + 1) * width + kCells - 1) / kCells;
      std::size_t measured = 0;
      for (std::size_t v = first_v; v < end_v; ++v) {
        const Eigen::Vector3f* const points_C = cloud.points_C.data() + v * width;
        for (std::size_t u = first_u; u < end_u; ++u)
          measured += static_cast<std::size_t>(IsMeasured(points_C[u]));
      }
      const std::size_t pixels = (end_v - first_v) * (end_u - first_u);
      shares.of_255[row * kCells + column] =
          static_cast<std::uint8_t>((255 * measured + pixels / 2) / pixels);
    }
  }
  return shares;
}

std::optional<double> MeasuredShares::At(const PinholeCamera& camera, const Eigen::Vector3d& p_C) const {
  const std::optional<Eigen::Vector2d> pixel = camera.Project(p_C);
  if (!pixel) return std::nullopt;
  const auto cell = [](double coordinate, int size) {
    return std::min(kSide - 1, static_cast<int>(kSide * (coordinate + 0.5) / size));
  };
  const int row = cell(pixel->y(), camera.height_px);
  const int column = cell(pixel->x(), camera.width_px);
  return of_255[static_cast<std::size_t>(row * kSide + column)] / 255.0;
}

}  // namespace thalweg
