#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/stereo_rectifier.h"
#include "services/visual_odometry/adapter/trajectory_file.h"
#include "services/visual_odometry/core/frame.h"

namespace thalweg::visual_odometry {

/// A folder of stereo images with their calibration and, if available, the ground truth.
///
/// KITTI: image_l + image_r, or image_0 + image_1, or image_2 + image_3; calib.txt (the projection matrices,
/// in two lines or in lines that begin with "P0:" etc.); optionally times.txt [s] (else 10 Hz) and poses.txt.
/// The images are rectified.
/// EuRoC: cam0 + cam1 (also under mav0, images also in data/); cam0.yaml + cam1.yaml (or sensor.yaml in
/// each); optionally groundtruth.csv (or state_groundtruth_estimate0/data.csv). Images are rectified on
/// loading.
class Sequence {
 public:
  /// Opens a sequence. Throws std::runtime_error naming file and line, or field: unknown layout, images
  /// without a partner, a calibration that does not fit the images, a malformed line.
  static Sequence Open(const std::filesystem::path& folder);

  const std::string& layout() const { return layout_; }  ///< KITTI, EuRoC
  const StereoGeometry& geometry() const { return geometry_; }
  std::size_t size() const { return frames_.size(); }
  Time StampOf(std::size_t index) const { return frames_[index].stamp; }
  /// Loads a pair, rectified and grayscale. Throws std::runtime_error naming the file if it is not an image
  /// or has another size.
  StereoImages Load(std::size_t index) const;
  /// True pose of the rectified left camera; nothing where the ground truth has a gap.
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
  /// Pose of the camera in the body whose pose the ground truth gives.
  RigidTransform T_BC_ = RigidTransform::Identity();
};

}  // namespace thalweg::visual_odometry
