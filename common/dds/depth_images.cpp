#include "common/dds/depth_images.h"

#include <string>

#include "common/base/size_text.h"

namespace thalweg::dds {

std::optional<DepthImages::Cloud> DepthImages::Add(const sensor_msgs::msg::Image& message) {
  Result<StampedDepth> depth = DepthFromIdl(message, infinity_);
  if (depth) return Add(depth->stamp, std::move(depth->image));
  bus_.health().Reject<topics::DepthImage>(depth.error());
  return std::nullopt;
}

std::optional<DepthImages::Cloud> DepthImages::Add(const sensor_msgs::msg::CameraInfo& message) {
  const Result<StampedCamera> camera = FromIdl(message);
  if (camera) return Add(camera->stamp, camera->camera);
  bus_.health().Reject<topics::DepthCameraInfo>(camera.error());
  return std::nullopt;
}

std::optional<DepthImages::Cloud> DepthImages::Add(Time stamp, Half half) {
  if (halves_.ClearIfRestarted(stamp))
    bus_.health().Drop<topics::DepthImage>("time jumped back: earlier images discarded");
  const bool is_image = std::holds_alternative<DepthImage>(half);
  auto pair = is_image ? halves_.AddLeft(stamp, std::move(half)) : halves_.AddRight(stamp, std::move(half));
  for (std::size_t dropped = halves_.TakeDropped(); dropped > 0; --dropped) {
    bus_.health().Drop<topics::DepthImage>(std::string("no ") + topics::DepthCameraInfo::kName + " and " +
                                           topics::DepthImage::kName + " of the same stamp");
  }
  if (!pair) return std::nullopt;
  const DepthImage& image = std::get<DepthImage>(pair->first);
  const PinholeCamera& camera = std::get<PinholeCamera>(pair->second);
  if (image.width_px != camera.width_px || image.height_px != camera.height_px) {
    bus_.health().Reject<topics::DepthImage>("image is " + SizeText(image.width_px, image.height_px) +
                                             ", its " + topics::DepthCameraInfo::kName + " is for " +
                                             SizeText(camera.width_px, camera.height_px));
    return std::nullopt;
  }
  return Cloud{{stamp, CloudFrom(image, camera)}, camera};
}

}  // namespace thalweg::dds
