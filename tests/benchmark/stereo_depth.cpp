// Depth error of stereo by range, on rendered pairs of a scenario's world with known ground truth. Prints a
// table and draws a chart.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/base/median.h"
#include "services/cli/report/chart.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/adapter/options.h"
#include "services/simulator/core/reachable.h"
#include "services/simulator/core/stereo_rig.h"
#include "services/stereo/adapter/options.h"

namespace thalweg {
namespace {

constexpr double kBin = 0.5;          // [m]
constexpr double kGross = 3.0;        // [px] of disparity
constexpr std::size_t kLeast = 2000;  // smallest number of pixels in a bin that is reported

struct Bin {
  std::vector<double> errors;  // [m], of pixels with a match
  std::size_t pixels = 0;
  std::size_t gross = 0;
};

stereo::ByteImage ToImage(const simulator::RenderedImage& rendered) {
  stereo::ByteImage image(rendered.width_px, rendered.height_px);
  image.data() = rendered.data;
  return image;
}

std::vector<Bin> Measure(const Scenario& scenario, const stereo::StereoOptions& options, int views,
                         double noise) {
  const simulator::World world = simulator::LoadWorld(scenario);
  const simulator::SimulatorOptions simulated = simulator::OptionsFrom(scenario, world);
  const RobotModel& robot = simulated.robot;
  const RigidTransform& T_WB_start = simulated.T_WB_start;
  if (!simulated.stereo_camera) throw std::invalid_argument("the scenario has no stereo_camera");
  simulator::StereoRigModel model = *simulated.stereo_camera;
  model.noise_sigma = noise;
  simulator::StereoRig rig(model);
  const int max_disparity = options.matcher.max_disparity;
  const auto matcher = stereo::MakeMatcher(options.engine, options.matcher);
  const double scale = model.camera.fx * model.baseline;
  std::vector<Bin> bins(12);
  for (int i = 0; i < views; ++i) {
    const RigidTransform T_WB = simulator::RandomStart(world, T_WB_start.translation(), robot, 0.4,
                                                       static_cast<std::uint32_t>(i + 1));
    const simulator::StereoPair pair = rig.Capture(world, T_WB * robot.T_BC);
    const stereo::ByteImage left = ToImage(pair.left);
    const stereo::ByteImage right = ToImage(pair.right);
    stereo::DisparityMap disparity = matcher->Match(left, right);
    if (options.refine) stereo::Refine(left, right, options.refinement, 0, disparity);
    for (std::size_t k = 0; k < pair.depth.size(); ++k) {
      const double z = pair.depth[k];
      const double d = disparity.data()[k];
      if (std::isnan(z) || z >= kBin * static_cast<double>(bins.size()) || scale / z >= max_disparity) {
        continue;
      }
      Bin& bin = bins[static_cast<std::size_t>(z / kBin)];
      ++bin.pixels;
      if (!(d > 0.0)) continue;
      bin.errors.push_back(std::abs(scale / d - z));
      bin.gross += std::abs(d - scale / z) > kGross ? 1 : 0;
    }
  }
  return bins;
}

void Draw(const std::vector<Bin>& bins, const std::string& engine, const std::string& file) {
  Canvas canvas(900, 340);
  canvas.Fill({0, 0, 900, 340}, colors::kPaper);
  cli::Chart error{engine + ": median error of depth", "range [m]", "error [m]", 0.0, 0.0, {{}}};
  cli::Chart gross{engine + ": gross errors (> 3 px)", "range [m]", "share of matches [%]", 1.0, 0.0, {{}}};
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const Bin& bin = bins[i];
    if (bin.errors.size() < kLeast) continue;
    const double middle = (static_cast<double>(i) + 0.5) * kBin;
    error.series[0].points.emplace_back(middle, Median(bin.errors));
    gross.series[0].points.emplace_back(
        middle, 100.0 * static_cast<double>(bin.gross) / static_cast<double>(bin.errors.size()));
    error.y_max = std::max(error.y_max, 1.1 * error.series[0].points.back().y);
    gross.y_max = std::max(gross.y_max, 1.1 * gross.series[0].points.back().y);
    error.x_max = gross.x_max = middle + kBin;
  }
  cli::DrawChart(canvas, {20, 20, 410, 300}, error);
  cli::DrawChart(canvas, {470, 20, 410, 300}, gross);
  cv::imwrite(file, canvas.Picture());
}

}  // namespace
}  // namespace thalweg

int main(int argc, char** argv) try {
  std::string scenario = "kitchen_stereo";
  std::string engine;
  std::string out = "depth_error.png";
  int views = 20;
  double noise = 2.0;
  bool matched_only = false;
  bool fill = false;
  CLI::App app("Error of depth from stereo by range");
  app.add_option("--scenario", scenario, "Its world, its cameras, its stereo service")->capture_default_str();
  app.add_option("--engine", engine, "Another one than the scenario's");
  app.add_option("--views", views, "Random places")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--noise", noise, "Sigma of the images' noise [gray values]")->capture_default_str();
  app.add_option("--out", out, "Picture")->capture_default_str();
  app.add_flag("--matched-only", matched_only, "Leave disparities as they were matched, not refined");
  app.add_flag("--fill", fill, "Guess planes over surfaces without texture");
  CLI11_PARSE(app, argc, argv);
  const thalweg::Scenario loaded = thalweg::LoadScenario(scenario);
  thalweg::stereo::StereoOptions options = thalweg::stereo::OptionsFrom(loaded);
  if (!engine.empty()) options.engine = engine;
  if (matched_only) options.refine = false;
  if (fill) options.matcher.best.fill_surfaces = true;
  const auto bins = thalweg::Measure(loaded, options, views, noise);
  std::printf("range [m]    pixels  density %%  median error [m]  gross %% of matches\n");
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const thalweg::Bin& bin = bins[i];
    if (bin.errors.size() < thalweg::kLeast) continue;
    const auto matched = static_cast<double>(bin.errors.size());
    std::printf("%3.1f to %3.1f %9zu %9.1f %15.4f %15.2f\n", static_cast<double>(i) * thalweg::kBin,
                static_cast<double>(i + 1) * thalweg::kBin, bin.pixels,
                100.0 * matched / static_cast<double>(bin.pixels), thalweg::Median(bin.errors),
                100.0 * static_cast<double>(bin.gross) / matched);
  }
  thalweg::Draw(bins, options.engine, out);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "bench_stereo_depth: " << error.what() << '\n';
  return EXIT_FAILURE;
}
