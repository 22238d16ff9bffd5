#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/surface_graph/view.h"

namespace thalweg::surface {

/// A folder of posed depth or disparity images, in the layout of the 7-Scenes data set and of tsdf-fusion:
///   camera-intrinsics.txt   3 x 3 matrix [px]
///   NAME.pose.txt           4 x 4 matrix, camera to world [m]; camera axes x right, y down, z forward
///   NAME.depth.png          16 bit [mm], 0 and 65535 = not measured; or
///   NAME.disparity.pfm      32 bit [px], not positive or not finite = none, as `thalweg stereo` writes it
///   NAME.color.png          optional: 8 bit, of the same size
///   baseline.txt            [m], needed for disparities
/// Views are in the order of their names.
class ViewFolder {
 public:
  /// Throws std::runtime_error naming the file: none with a pose, an image missing, intrinsics or a baseline
  /// that are malformed or missing.
  static ViewFolder Open(const std::filesystem::path& folder);

  std::size_t size() const { return names_.size(); }
  const std::string& NameOf(std::size_t index) const { return names_[index]; }
  /// Throws std::runtime_error naming the file and what is wrong with it: a pose that is not one, an image
  /// that is of another kind or size than those before it.
  View Load(std::size_t index);

 private:
  std::filesystem::path folder_;
  std::vector<std::string> names_;
  PinholeCamera camera_;  ///< Its size is that of the first image loaded.
  double baseline_ = 0.0;
};

}  // namespace thalweg::surface
