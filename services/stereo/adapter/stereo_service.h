#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/stamp_pairs.h"
#include "common/dds/bus.h"
#include "services/stereo/adapter/convert.h"
#include "services/stereo/adapter/options.h"
#include "services/stereo/core/row_alignment.h"

namespace thalweg::stereo {

/// Pairs images by their stamps, matches them and publishes disparity and point cloud. The cloud is published
/// where a depth sensor's would be, so that the mapper need not know the difference.
///
/// Matching runs on a thread of its own, one pair at a time. A pair that arrives meanwhile waits; if another
/// one arrives first, the waiting pair is dropped and counted.
class StereoService {
 public:
  /// Throws std::invalid_argument naming a bad option.
  StereoService(const StereoOptions& options, dds::Bus& bus);
  ~StereoService();

 private:
  /// Geometry of the images; shared, since a job may outlive the camera_info that it was created with.
  struct Camera {
    StereoGeometry geometry;
    std::optional<StereoRectifier> rectifier;  ///< Nothing if the images are already rectified.
  };
  struct Pair {
    Time stamp;
    ByteImage left, right;
  };
  struct Job {
    Time stamp;
    ByteImage left, right;
    std::shared_ptr<const Camera> camera;
  };

  template <class Topic>
  void OnImage(const sensor_msgs::msg::Image& message, bool is_left);
  template <class Topic>
  void OnInfo(const sensor_msgs::msg::CameraInfo& message, std::optional<sensor_msgs::msg::CameraInfo>& info);
  static std::shared_ptr<const Camera> MakeCamera(const StereoInfo& info);
  void OnPair(Time stamp, ByteImage left, ByteImage right);
  bool Due(Time stamp) const;
  void CountDropped(std::size_t count, const char* reason);
  void Work(const std::stop_token& stop);
  void Match(Job job);
  void WatchRows(Time stamp, const ByteImage& left, const ByteImage& right);

  StereoOptions options_;
  dds::Bus& bus_;
  std::unique_ptr<Matcher> matcher_;  ///< This and the next two are used by the worker thread only.
  RowMonitor rows_;
  std::optional<Time> rows_measured_;     ///< Stamp of the last pair of which they were measured.
  std::shared_ptr<const Camera> camera_;  ///< Null until computed from the camera_infos.
  StampPairs<ByteImage> pairs_;
  std::optional<Pair> early_;  ///< The newest, while the camera_infos have not arrived yet.
  std::optional<Time> taken_;  ///< Stamp of the last pair that was to be matched.
  std::optional<sensor_msgs::msg::CameraInfo> left_info_, right_info_;

  dds::Bus::Publisher<dds::topics::DepthPoints> points_out_;
  dds::Bus::Publisher<dds::topics::Disparity> disparity_out_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<Job> waiting_;  ///< Guarded by mutex_.
  std::jthread thread_;         ///< Last, so that it is joined before the members it uses are destroyed.
};

}  // namespace thalweg::stereo
