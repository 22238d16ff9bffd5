#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <numeric>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/base/stopwatch.h"
#include "services/visual_odometry/core/visual_odometry.h"
#include "tests/services/visual_odometry/support/textured_room.h"
#include "tests/support/resident_memory.h"

namespace thalweg::visual_odometry {
namespace {

constexpr int kFrames = 2000;
constexpr int kPeriod = 48;  ///< Frames per swing, rendered once and shown repeatedly.
constexpr int kEnds = 200;

/// Swings through the room and back, so that the first image follows the last one.
RigidTransform Swing(int frame) {
  const double phase = 2.0 * 3.14159265358979 * frame / kPeriod;
  return MakeTransform(
      RotationFromYawPitch(0.25 * std::sin(phase), 0.06 * std::sin(2.0 * phase)) * BodyFromOptical(),
      Eigen::Vector3d(2.5 + 0.6 * std::sin(phase), 2.5 + 0.4 * std::cos(phase), 1.4));
}

/// [ms] Processor time of this thread.
double ProcessorMilliseconds() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return 1e3 * static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-3 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

double Mean(const std::vector<double>& values, std::size_t first, std::size_t count) {
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
  return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(count), 0.0) / static_cast<double>(count);
}

/// Tracks 2000 frames on one core. Counters: frames per second of processor time, time of the last 200 frames
/// relative to the first 200 (excluding the very first), memory growth after the first 200.
void Follow(benchmark::State& state, int width, int height, double fov) {
  cv::setNumThreads(1);
  const StereoGeometry rig{PinholeCamera::FromFieldOfView(width, height, fov), 0.12};
  const test::TexturedRoom room(1.0, 2.0);
  std::vector<StereoImages> images;
  for (int k = 0; k < kPeriod; ++k) images.push_back(room.SeePair(rig, Swing(k), test::RoomStamp(k)));
  for (auto _ : state) {
    VisualOdometry odometry(rig);
    std::vector<double> times;
    double memory = 0.0;
    int not_tracking = 0;
    int keyframes = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      StereoImages& now = images[static_cast<std::size_t>(frame % kPeriod)];
      now.stamp = test::RoomStamp(frame);
      const double before = ProcessorMilliseconds();
      const PoseEstimate estimate = odometry.Track(now);
      times.push_back(ProcessorMilliseconds() - before);
      not_tracking += estimate.state != TrackingState::kTracking;
      keyframes += estimate.keyframe;
      if (frame == kEnds) memory = thalweg::test::ResidentMegabytes();
    }
    state.counters["frames_per_s"] = 1e3 / Mean(times, 0, kFrames);
    state.counters["last_to_first"] = Mean(times, kFrames - kEnds, kEnds) / Mean(times, 1, kEnds);
    state.counters["added_MB"] = thalweg::test::ResidentMegabytes() - memory;
    state.counters["max_ms"] = *std::max_element(times.begin(), times.end());
    state.counters["keyframes"] = keyframes;
    state.counters["not_tracking"] = not_tracking;
  }
}

BENCHMARK_CAPTURE(Follow, room_512x384, 512, 384, 1.1519173063162575)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Follow, room_1241x376, 1241, 376, 1.4)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace thalweg::visual_odometry
