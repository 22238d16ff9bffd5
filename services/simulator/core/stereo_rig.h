#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/pinhole_camera.h"
#include "common/geometry/rigid_transform.h"
#include "common/geometry/robot_model.h"
#include "services/simulator/core/world.h"

namespace thalweg::simulator {

/// Two identical cameras side by side, rectified: the right one lies `baseline` along the left one's x axis.
struct StereoRigModel {
  PinholeCamera camera = PinholeCamera::FromFieldOfView(512, 384, 1.1519173063162575);  ///< 66 deg
  double baseline = DepthSensorModel{}.baseline;                                        ///< [m]
  double rate = 10.0;                                                                   ///< [Hz]
  double noise_sigma = 0.0;  ///< [gray values of 255] Gaussian, on each channel of each pixel.
  bool color = false;        ///< Whether images are rgb8 instead of mono8.
  /// n x n rays are cast in each pixel that an edge or a fine texture crosses, as anti-aliasing.
  int edge_samples = 2;
};

/// Rows run from the top; channels are interleaved: 1 = gray, 3 = red, green, blue.
struct RenderedImage {
  int width_px = 0;
  int height_px = 0;
  int channels = 1;
  std::vector<std::uint8_t> data;
};

struct StereoPair {
  RenderedImage left;
  RenderedImage right;
  std::vector<float> depth;  ///< [m] z at the left image's pixel centers, row-major; NaN = no surface.
};

/// Renders what a stereo camera sees. Surfaces are diffuse and the lights are fixed in W, so that a point
/// looks the same from everywhere and to both cameras, as stereo matching assumes.
class StereoRig {
 public:
  /// Throws std::invalid_argument when a size is not positive.
  /// @param threads  Number of threads that share the rows; 0 = one per core. Images do not depend on it.
  explicit StereoRig(const StereoRigModel& model, std::uint32_t noise_seed = 1, std::size_t threads = 0);

  /// @param T_WC  Pose of the left camera.
  StereoPair Capture(const World& world, const RigidTransform& T_WC);

  const StereoRigModel& model() const { return model_; }

 private:
  StereoRigModel model_;
  std::uint32_t seed_;
  std::size_t threads_;
  std::uint32_t captures_ = 0;
};

}  // namespace thalweg::simulator
