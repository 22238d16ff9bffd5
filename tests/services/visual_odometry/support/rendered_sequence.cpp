#include "tests/services/visual_odometry/support/rendered_sequence.h"

namespace thalweg::visual_odometry::test {

StereoGeometry GeometryOf(const simulator::StereoRigModel& model) {
  return {model.camera, model.baseline};
}

StereoImages Render(simulator::StereoRig& rig, const simulator::World& world, const Flight& flight,
                    std::size_t frame) {
  simulator::StereoPair pair = rig.Capture(world, flight.T_WCs[frame]);
  const auto to_mat = [](simulator::RenderedImage& image) {
    return cv::Mat(image.height_px, image.width_px, CV_8UC1, image.data.data()).clone();
  };
  return {flight.StampOf(frame), to_mat(pair.left), to_mat(pair.right)};
}

}  // namespace thalweg::visual_odometry::test
