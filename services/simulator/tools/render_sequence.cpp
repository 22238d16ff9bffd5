#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "common/scenario/scenario.h"
#include "common/service/command_line.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/tools/flight.h"

namespace {

using namespace thalweg;
using namespace thalweg::simulator;

void Print(const Eigen::Matrix<double, 3, 4>& matrix, std::ostream& out) {
  out << std::setprecision(12);
  for (Eigen::Index i = 0; i < 12; ++i) out << matrix(i / 4, i % 4) << (i == 11 ? '\n' : ' ');
}

/// @param image  Outlives the matrix.
cv::Mat ToMat(RenderedImage& image) {
  return cv::Mat(image.height_px, image.width_px, CV_8UC1, image.data.data());
}

void Write(const simulator::World& world, const Flight& flight, double noise,
           const std::filesystem::path& folder) {
  StereoRigModel model = NoisyRig();
  model.noise_sigma = noise;
  StereoRig rig(model);
  const PinholeCamera& camera = model.camera;
  Eigen::Matrix<double, 3, 4> projection;
  projection << camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0;
  std::ostringstream calibration;
  Print(projection, calibration << "P0: ");
  projection(0, 3) = -camera.fx * model.baseline;
  Print(projection, calibration << "P1: ");
  WriteFile(folder / "calib.txt", calibration.str());
  std::ostringstream times;
  std::ostringstream poses;
  for (std::size_t i = 0; i < flight.T_WCs.size(); ++i) {
    StereoPair images = rig.Capture(world, flight.T_WCs[i]);
    std::ostringstream name;
    name << std::setfill('0') << std::setw(6) << i << ".png";
    WritePicture(folder / "image_0" / name.str(), ToMat(images.left));
    WritePicture(folder / "image_1" / name.str(), ToMat(images.right));
    times << std::setprecision(12) << Seconds(flight.StampOf(i).time_since_epoch()) << '\n';
    Print(flight.T_WCs[i].matrix().topRows<3>(), poses);
  }
  WriteFile(folder / "times.txt", times.str());
  WriteFile(folder / "poses.txt", poses.str());
}

}  // namespace

/// Renders a stereo sequence with exact ground truth in KITTI's layout, for thalweg odometry.
int main(int argc, char** argv) try {
  CLI::App app("Renders a flight through a world as a stereo sequence with exact truth, in KITTI's layout",
               "thalweg-render-sequence");
  AddVersion(app);
  std::string scenario = kDefaultScenario;
  std::string out;
  bool jerky = false;
  double length = 20.0;
  double noise = NoisyRig().noise_sigma;
  app.add_option("--scenario", scenario, "Name under deploy/scenarios, or a file")->capture_default_str();
  app.add_option("--out", out, "Folder to write")->required();
  app.add_flag("--jerky", jerky, "Stop and go, with shakes");
  app.add_option("--length", length, "[m]")->capture_default_str()->check(CLI::Range(0.1, 1e4));
  app.add_option("--noise", noise, "Sigma, gray values")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0));
  CLI11_PARSE(app, argc, argv);
  const simulator::World world = LoadWorld(LoadScenario(scenario));
  Write(world, FlyRounds(world, jerky ? Motion::kJerky : Motion::kSmooth, length), noise, out);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "render-sequence: " << error.what() << '\n';
  return EXIT_FAILURE;
}
