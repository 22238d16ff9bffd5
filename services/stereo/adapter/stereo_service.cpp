#include "services/stereo/adapter/stereo_service.h"

#include <spdlog/spdlog.h>

#include <exception>
#include <string>
#include <utility>

#include "common/base/size_text.h"
#include "common/base/stopwatch.h"
#include "services/stereo/adapter/convert.h"

namespace thalweg::stereo {
namespace {

namespace topics = dds::topics;

constexpr Duration kBetweenRows = std::chrono::seconds(2);  // of stamps: a mount does not move faster

bool SayTheSame(const sensor_msgs::msg::CameraInfo& a, const sensor_msgs::msg::CameraInfo& b) {
  return a.width() == b.width() && a.height() == b.height() && a.distortion_model() == b.distortion_model() &&
         a.d() == b.d() && a.k() == b.k() && a.r() == b.r() && a.p() == b.p();
}

}  // namespace

StereoService::StereoService(const StereoOptions& options, dds::Bus& bus)
    : options_(options),
      bus_(bus),
      matcher_(MakeMatcher(options.engine, options.matcher)),
      points_out_(bus.Advertise<topics::DepthPoints>()),
      disparity_out_(bus.Advertise<topics::Disparity>()) {
  if (options.calibration) {
    StereoRectifier rectifier(*options.calibration);
    camera_ = std::make_shared<const Camera>(Camera{rectifier.geometry(), rectifier});
  }
  bus.Subscribe<topics::LeftImage>([this](const auto& m) { OnImage<topics::LeftImage>(m, true); });
  bus.Subscribe<topics::RightImage>([this](const auto& m) { OnImage<topics::RightImage>(m, false); });
  if (!options.calibration) {
    bus.Subscribe<topics::LeftCameraInfo>(
        [this](const auto& m) { OnInfo<topics::LeftCameraInfo>(m, left_info_); });
    bus.Subscribe<topics::RightCameraInfo>(
        [this](const auto& m) { OnInfo<topics::RightCameraInfo>(m, right_info_); });
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { Work(stop); });
}

StereoService::~StereoService() = default;

template <class Topic>
void StereoService::OnInfo(const sensor_msgs::msg::CameraInfo& message,
                           std::optional<sensor_msgs::msg::CameraInfo>& info) {
  const Result<dds::StampedCamera> camera = dds::FromIdl(message);
  if (!camera) return bus_.health().Reject<Topic>(camera.error());
  if (info && SayTheSame(*info, message)) return;
  info = message;
  camera_.reset();
  if (!left_info_ || !right_info_ || !early_) return;
  Pair pair = *std::exchange(early_, std::nullopt);
  OnPair(pair.stamp, std::move(pair.left), std::move(pair.right));
}

std::shared_ptr<const StereoService::Camera> StereoService::MakeCamera(const StereoInfo& info) {
  Camera camera{info.geometry, std::nullopt};
  if (info.rectifications) {
    const auto& [left, right] = *info.rectifications;
    camera.rectifier.emplace(left, right, info.geometry);
  }
  return std::make_shared<const Camera>(std::move(camera));
}

template <class Topic>
void StereoService::OnImage(const sensor_msgs::msg::Image& message, bool is_left) {
  const Result<dds::ImageView> view = dds::FromIdl(message);
  if (!view) return bus_.health().Reject<Topic>(view.error());
  Result<ByteImage> image = ToByteImage(*view);
  if (!image) return bus_.health().Reject<Topic>(image.error());
  const Time stamp = view->stamp;
  if (pairs_.ClearIfRestarted(stamp)) {
    CountDropped(1, "time jumped back: forgets the images before");
    taken_.reset();
    early_.reset();
  }
  auto pair = is_left ? pairs_.AddLeft(stamp, *std::move(image)) : pairs_.AddRight(stamp, *std::move(image));
  CountDropped(pairs_.TakeDropped(), "no image of the other camera with its stamp");
  if (pair) OnPair(stamp, std::move(pair->first), std::move(pair->second));
}

void StereoService::OnPair(Time stamp, ByteImage left, ByteImage right) {
  try {
    CheckPair(left, right);
  } catch (const std::invalid_argument& error) {
    return bus_.health().Reject<topics::RightImage>(error.what());
  }
  std::optional<StereoInfo> info;
  if (!camera_) {
    if (!left_info_ || !right_info_) {
      if (early_) CountDropped(1, "no camera_info received yet");
      early_ = Pair{stamp, std::move(left), std::move(right)};
      return;
    }
    const Result<StereoInfo> from = FromIdl(*left_info_, *right_info_);
    if (!from) return bus_.health().Reject<topics::RightCameraInfo>(from.error());
    info = *from;
  }
  const PinholeCamera& size = camera_ ? camera_->geometry.camera : info->geometry.camera;
  if (left.width() != size.width_px || left.height() != size.height_px) {
    return bus_.health().Reject<topics::LeftImage>("image is " + SizeText(left.width(), left.height()) +
                                                   ", its calibration is for " +
                                                   SizeText(size.width_px, size.height_px));
  }
  if (!Due(stamp)) return;
  taken_ = stamp;
  // Only now, after the size check: a camera_info with an absurd size would allocate absurd tables.
  if (!camera_) camera_ = MakeCamera(*info);
  Job job{stamp, std::move(left), std::move(right), camera_};
  bool replaced = false;
  {
    const std::lock_guard lock(mutex_);
    replaced = waiting_.has_value();
    waiting_ = std::move(job);
  }
  wake_.notify_one();
  if (replaced) CountDropped(1, "a newer pair arrived before it was matched");
}

bool StereoService::Due(Time stamp) const {
  constexpr double kEarly = 0.001;  // [s] tolerance for the cameras' timing
  return options_.rate <= 0.0 || !taken_ || Seconds(stamp - *taken_) + kEarly >= 1.0 / options_.rate;
}

void StereoService::CountDropped(std::size_t count, const char* reason) {
  for (std::size_t i = 0; i < count; ++i) bus_.health().Drop<topics::LeftImage>(reason);
}

void StereoService::Work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (wake_.wait(lock, stop, [this] { return waiting_.has_value(); })) {
    Job job = *std::move(waiting_);
    waiting_.reset();
    lock.unlock();
    try {
      Match(std::move(job));
    } catch (const std::exception& error) {  // OpenCV's matchers reject more than CheckPair does
      bus_.Post([this, what = std::string(error.what())] {
        bus_.health().Drop<topics::LeftImage>("matching failed: " + what);
      });
    }
    lock.lock();
  }
}

void StereoService::Match(Job job) {
  const Stopwatch stopwatch;
  const auto& [geometry, rectifier] = *job.camera;
  const ByteImage left = rectifier ? Rectify(*rectifier, Side::kLeft, job.left) : std::move(job.left);
  const ByteImage right = rectifier ? Rectify(*rectifier, Side::kRight, job.right) : std::move(job.right);
  DisparityMap disparity = matcher_->Match(left, right);
  const std::string why = WhyNoMatches(disparity, left, right, options_.matcher.max_disparity);
  if (!why.empty()) bus_.Post([this, why] { bus_.health().Drop<topics::LeftImage>(why); });
  if (options_.refine) {
    Refine(ToGray(left), ToGray(right), options_.refinement,
           static_cast<std::size_t>(options_.matcher.threads), disparity);
  }
  const PointCloud cloud = Triangulate(disparity, left, geometry, options_.triangulation);
  points_out_.Write(dds::ToIdl(job.stamp, cloud));
  if (disparity_out_.readers() > 0) {
    disparity_out_.Write(ToIdl(job.stamp, disparity, geometry, options_.matcher.max_disparity));
  }
  bus_.Post([this, duration = stopwatch.Milliseconds()] { bus_.health().Timed("pair", duration); });
  WatchRows(job.stamp, left, right);  // last: nobody waits for it
}

void StereoService::WatchRows(Time stamp, const ByteImage& left, const ByteImage& right) {
  if (rows_measured_ && stamp >= *rows_measured_ && stamp - *rows_measured_ < kBetweenRows) return;
  rows_measured_ = stamp;
  const auto rows = MeasureRowAlignment(ToGray(left), ToGray(right), options_.matcher.max_disparity);
  const auto news = rows ? rows_.Add(*rows) : std::nullopt;
  if (news) spdlog::warn("{}", *news);
}

}  // namespace thalweg::stereo
