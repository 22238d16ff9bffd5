#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "common/geometry/point_cloud.h"
#include "services/link/core/ray_table.h"

namespace thalweg::link {

struct CloudCodecOptions {
  /// [m] Step of coded depths of organized clouds: a point moves along its ray by at most half of it in z.
  double depth_step = 0.005;
  double point_step = 0.01;  ///< [m] Step of the coordinates of other clouds; points that become equal merge.
  bool colors = false;       ///< Whether colors cross.
};

/// A coded cloud, and the table that its decoder needs before it; no table if it needs none.
struct CodedCloud {
  std::shared_ptr<const Buffer> table;
  Buffer bytes;
};

/// Codes clouds for a thin link.
///
/// An organized cloud is an image of depths, since the directions of its pixels do not change: the depths in
/// steps, each predicted from the pixels to the left and above. Inverse depth is linear in pixel coordinates
/// on a plane seen by a pinhole camera, so three neighbors predict the fourth:
///   1 / z(u, v) = 1 / z(u - 1, v) + 1 / z(u, v - 1) - 1 / z(u - 1, v - 1)
/// The prediction is computed in integers, so that both sides agree bit by bit. What is not measured (NaN)
/// and what has no return stay what they are. Other clouds lose their order: their points are sorted, and
/// coded as differences; those without three finite coordinates are left out.
///
/// Threading: one thread.
class CloudEncoder {
 public:
  explicit CloudEncoder(const CloudCodecOptions& options) : options_(options) {}
  CodedCloud Encode(const PointCloud& cloud);

 private:
  bool FindTable(const PointCloud& cloud);

  CloudCodecOptions options_;
  std::optional<RayTable> table_;
  std::shared_ptr<const Buffer> table_bytes_;
};

/// The inverse of CloudEncoder, for bytes from anywhere.
class CloudDecoder {
 public:
  /// From now on, clouds are decoded by this table. Returns what is wrong with it.
  std::optional<Error> SetTable(Bytes table);
  /// Error: bytes that are no coded cloud, or one of another table.
  Result<PointCloud> Decode(Bytes bytes) const;

 private:
  std::optional<RayTable> table_;
};

}  // namespace thalweg::link
