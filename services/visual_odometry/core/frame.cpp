#include "services/visual_odometry/core/frame.h"

#include <algorithm>

namespace thalweg::visual_odometry {
namespace {

/// Number of halvings after which the width is at most `target_px`.
int HalvingsTo(int width_px, int target_px) {
  int halvings = 0;
  while (width_px > target_px) {
    width_px = (width_px + 1) / 2;
    ++halvings;
  }
  return halvings;
}

}  // namespace

Levels Levels::For(int width_px) {
  Levels levels;
  levels.search = HalvingsTo(width_px, 400);
  levels.stereo = std::max(0, levels.search - 1);
  levels.small = HalvingsTo(width_px, 100);
  levels.count = std::max(levels.search, levels.small) + 1;
  return levels;
}

Frame MakeFrame(const StereoImages& images, const Levels& levels) {
  Frame frame;
  frame.stamp = images.stamp;
  frame.left = MakePyramid(images.left, levels.count);
  frame.right = MakePyramid(images.right, levels.stereo + 1);
  frame.search = WithoutLight(frame.left[static_cast<std::size_t>(levels.search)]);
  return frame;
}

}  // namespace thalweg::visual_odometry
