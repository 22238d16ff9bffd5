#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <vector>

#include "common/base/angles.h"
#include "common/files/write_picture.h"
#include "common/scenario/models.h"
#include "common/scenario/scenario.h"
#include "common/service/command_line.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/core/stereo_rig.h"

namespace {

using namespace thalweg;

/// Left image, right image and depth side by side; depth runs from white at 0.5 m to black.
cv::Mat Montage(const simulator::StereoPair& pair) {
  const int width = pair.left.width_px;
  cv::Mat image(pair.left.height_px, 3 * width, CV_8UC3);
  const auto pixel_of = [](const simulator::RenderedImage& eye, std::size_t i) {
    return cv::Vec3b(eye.data[3 * i + 2], eye.data[3 * i + 1], eye.data[3 * i]);
  };
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto i = static_cast<std::size_t>(v * width + u);
      const float near = std::isnan(pair.depth[i]) ? 0.0F : std::min(1.0F, 0.5F / pair.depth[i]);
      image.at<cv::Vec3b>(v, u) = pixel_of(pair.left, i);
      image.at<cv::Vec3b>(v, u + width) = pixel_of(pair.right, i);
      image.at<cv::Vec3b>(v, u + 2 * width) =
          cv::Vec3b::all(static_cast<std::uint8_t>(255.0F * std::sqrt(near)));
    }
  }
  return image;
}

}  // namespace

/// Renders what the stereo camera sees from a position in a scenario's world, for a person to look at.
int main(int argc, char** argv) try {
  CLI::App app("Renders the stereo pair and the depth seen from a place in a world, as PNG",
               "thalweg-render-view");
  thalweg::AddVersion(app);
  std::string scenario_file = kDefaultScenario;
  std::string out = "view.png";
  std::vector<double> pose;
  app.add_option("--scenario", scenario_file, "Name under deploy/scenarios, or a file")
      ->capture_default_str();
  app.add_option("--out", out, "Image to write")->capture_default_str();
  app.add_option("--pose", pose, "x y z [m] yaw pitch [deg]; default: the scenario's start")->expected(5);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return ReportParseError(app, error, "render-view");
  }

  const Scenario scenario = LoadScenario(scenario_file);
  const simulator::World world = simulator::LoadWorld(scenario);
  const RobotModel robot = RobotFrom(scenario);
  RigidTransform T_WB = simulator::StartFrom(scenario, world, robot);
  if (!pose.empty()) {
    T_WB = MakeTransform(RotationFromYawPitch(pose[3] * kDegree, pose[4] * kDegree),
                         {pose[0], pose[1], pose[2]});
  }
  simulator::StereoRigModel model;
  model.color = true;
  simulator::StereoRig rig(model);
  WritePicture(out, Montage(rig.Capture(world, T_WB * robot.T_BC)));
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "render-view: " << error.what() << '\n';
  return EXIT_FAILURE;
}
