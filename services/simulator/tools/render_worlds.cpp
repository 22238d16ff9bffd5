#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/base/angles.h"
#include "common/base/parallel.h"
#include "common/files/write_picture.h"
#include "common/geometry/triangle.h"
#include "common/service/command_line.h"
#include "services/simulator/adapter/load_mesh.h"

namespace {

using namespace thalweg;
using simulator::World;

constexpr int kTileWidth = 400;      // [px]
constexpr int kTileHeight = 330;     // [px]
constexpr int kTitle = 34;           // [px] at the top of a tile
constexpr int kFiner = 3;            // n x n rays per pixel
constexpr double kFootprint = 0.5;   // [m] leaves out detail of surfaces that is finer than this
constexpr double kWallDepth = 0.12;  // [m] of wall inside the bounds, removed on the viewer's side
const cv::Vec3b kPaper(255, 255, 255);
const cv::Vec3b kSection(62, 52, 46);

/// Oblique view of a world from outside and above, in parallel projection; everything above a height and the
/// nearest walls are cut away.
class Cutaway {
 public:
  /// @param cut  [m] Height in W above which the world is cut away.
  Cutaway(const World& world, double cut) : world_(world), box_(world.bounds()) {
    box_.min() += Eigen::Vector3d::Constant(kWallDepth);
    box_.max() -= Eigen::Vector3d::Constant(kWallDepth);
    box_.min().z() = world.bounds().min().z();
    box_.max().z() = std::min(cut, box_.max().z());
    const double yaw = 118.0 * kDegree;
    const double pitch = -52.0 * kDegree;
    forward_ = {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
    right_ = forward_.cross(Eigen::Vector3d::UnitZ()).normalized();
    up_ = right_.cross(forward_);
  }

  cv::Mat Render(int width, int height) const {
    Eigen::AlignedBox2d seen;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p = box_.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      seen.extend(Eigen::Vector2d(right_.dot(p), up_.dot(p)));
    }
    const double meters = 1.03 * std::max(seen.sizes().x() / width, seen.sizes().y() / height) / kFiner;
    cv::Mat fine(height * kFiner, width * kFiner, CV_8UC3);
    ParallelFor(static_cast<std::size_t>(fine.rows), 8, [&](std::size_t row) {
      for (int column = 0; column < fine.cols; ++column) {
        const double x = seen.center().x() + (column + 0.5 - 0.5 * fine.cols) * meters;
        const double y = seen.center().y() - (static_cast<double>(row) + 0.5 - 0.5 * fine.rows) * meters;
        fine.at<cv::Vec3b>(static_cast<int>(row), column) = Look(x * right_ + y * up_, meters);
      }
    });
    cv::Mat image;
    cv::resize(fine, image, {width, height}, 0, 0, cv::INTER_AREA);
    return image;
  }

 private:
  /// Where the line of sight through p enters the box. The line is parallel to no axis.
  std::optional<Eigen::Vector3d> Entry(const Eigen::Vector3d& p) const {
    const Eigen::Array3d a = (box_.min() - p).array() / forward_.array();
    const Eigen::Array3d b = (box_.max() - p).array() / forward_.array();
    const double enter = a.min(b).maxCoeff();
    if (enter > a.max(b).minCoeff()) return std::nullopt;
    return p + enter * forward_;
  }

  /// Whether the ray began inside a solid of the mesh.
  bool ShowsItsBack(const simulator::Hit& hit) const {
    const Triangle triangle = simulator::TriangleOf(world_.mesh(), hit.triangle);
    return (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).dot(forward_) > 0.0;
  }

  cv::Vec3b Look(const Eigen::Vector3d& p, double footprint) const {
    const auto from = Entry(p);
    const auto hit = from ? world_.CastRay(*from, forward_, 100.0) : std::nullopt;
    if (!hit || !world_.bounds().contains(*from + (hit->distance - 1e-3) * forward_)) return kPaper;
    if (hit->at_rest_W ? world_.DistanceToSurface(*from, 1.0) <= 0.0 : ShowsItsBack(*hit)) return kSection;
    static const Eigen::Vector3d light = Eigen::Vector3d(-0.75, -0.35, 1.0).normalized();
    const double shade = 0.75 + 0.5 * std::max(0.0, hit->normal_W.dot(light));
    const Rgb color = world_.ColorAt(*hit, std::max(footprint, kFootprint));
    const auto channel = [&](std::uint8_t value) { return cv::saturate_cast<std::uint8_t>(shade * value); };
    return {channel(color.b), channel(color.g), channel(color.r)};
  }

  const World& world_;
  Eigen::AlignedBox3d box_;
  Eigen::Vector3d forward_, right_, up_;
};

struct Tile {
  std::string scenario;
  double cut = 1e9;  ///< [m]
};

/// Parses "garage" or "hall:2.3".
Tile TileFrom(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return {text};
  try {
    return {text.substr(0, colon), std::stod(text.substr(colon + 1))};
  } catch (const std::exception&) {
    throw std::runtime_error(text + ": must be SCENARIO or SCENARIO:HEIGHT");
  }
}

void Draw(const Tile& tile, cv::Mat area) {
  const Scenario scenario = LoadScenario(tile.scenario);
  const World world = simulator::LoadWorld(scenario);
  const Cutaway view(world, std::min(tile.cut, world.bounds().max().z() - 0.35));
  view.Render(area.cols, area.rows - kTitle).copyTo(area.rowRange(kTitle, area.rows));
  cv::putText(area, std::filesystem::path(tile.scenario).stem().string(), {14, 26}, cv::FONT_HERSHEY_DUPLEX,
              0.7, {52, 42, 34}, 1, cv::LINE_AA);
}

}  // namespace

/// Renders worlds from outside, cut open, side by side, for a person to look at.
int main(int argc, char** argv) try {
  CLI::App app("Renders worlds obliquely from above, their upper parts cut off, as one PNG",
               "thalweg-render-worlds");
  thalweg::AddVersion(app);
  std::vector<std::string> names;
  std::string out = "worlds.png";
  int columns = 4;
  app.add_option("scenario", names,
                 "Names under deploy/scenarios, or files; NAME:HEIGHT cuts at that height [m]")
      ->required();
  app.add_option("--out", out, "Image to write")->capture_default_str();
  app.add_option("--columns", columns, "Pictures side by side")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return ReportParseError(app, error, "render-worlds");
  }
  const int count = static_cast<int>(names.size());
  const int across = std::min(columns, count);
  cv::Mat image((count + across - 1) / across * kTileHeight, across * kTileWidth, CV_8UC3,
                cv::Scalar::all(255));
  for (int k = 0; k < count; ++k) {
    Draw(TileFrom(names[static_cast<std::size_t>(k)]),
         image(cv::Rect(k % across * kTileWidth, k / across * kTileHeight, kTileWidth, kTileHeight)));
  }
  WritePicture(out, image);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "render-worlds: " << error.what() << '\n';
  return EXIT_FAILURE;
}
