#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/stereo_rectifier.h"
#include "services/visual_odometry/adapter/trajectory_file.h"
#include "services/visual_odometry/core/frame.h"

namespace thalweg::visual_odometry {

/// Stereo images in a folder, with their calibration and, where it is known, the truth.
///
/// KITTI: image_l + image_r, or image_0 + image_1, or image_2 + image_3; calib.txt (the projection matrices,
/// two lines, or lines "P0:" and on); times.txt [s] and poses.txt where they are there, else 10 Hz.
/// Rectified. EuRoC: cam0 + cam1 (also under mav0, images also in data/), cam0.yaml + cam1.yaml (or
/// sensor.yaml in each), groundtruth.csv (or state_groundtruth_estimate0/data.csv) where it is there.
/// Rectified here.
class Sequence {
 public:
  /// Throws std::runtime_error naming file and line, or field: no such layout, images without a partner, a
  /// calibration that does not fit the images, a line that cannot be read.
  static Sequence Open(const std::filesystem::path& folder);

  const std::string& layout() const { return layout_; }  ///< KITTI, EuRoC
  const StereoGeometry& geometry() const { return geometry_; }
  std::size_t size() const { return frames_.size(); }
  Time StampOf(std::size_t index) const { return frames_[index].stamp; }
  /// Rectified and grey. Throws std::runtime_error naming the file: not an image, or of another size.
  StereoImages Load(std::size_t index) const;
  /// Of the rectified left camera; nothing where the truth has a gap.
  std::optional<RigidTransform> TruthAt(std::size_t index) const;

 private:
  struct Entry {
    Time stamp;
    std::filesystem::path left;
    std::filesystem::path right;
  };
  static Sequence OpenKitti(const std::filesystem::path& folder, const std::string& left,
                            const std::string& right);
  static Sequence OpenEuroc(const std::filesystem::path& folder);
  cv::Mat LoadImage(const std::filesystem::path& file) const;

  std::string layout_;
  StereoGeometry geometry_;
  cv::Size raw_size_;
  std::vector<Entry> frames_;
  std::optional<StereoRectifier> rectifier_;
  std::optional<Trajectory> truth_;
  RigidTransform T_BC_ = RigidTransform::Identity();  ///< Camera in what the truth is the pose of.
};

}  // namespace thalweg::visual_odometry
