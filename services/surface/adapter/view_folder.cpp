#include "services/surface/adapter/view_folder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>

#include "common/base/size_text.h"
#include "common/base/text.h"
#include "common/geometry/plausible.h"

namespace thalweg::surface {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIntrinsics = "camera-intrinsics.txt";
constexpr std::string_view kPose = ".pose.txt";
constexpr std::string_view kDepth = ".depth.png";
constexpr std::string_view kDisparity = ".disparity.pfm";
/// For depths any baseline will do: the disparities are only a way to write them down.
constexpr double kDepthBaseline = 0.1;
constexpr double kFarthestPose = 1e4;  // [m] Beyond, single precision has no millimeters.
constexpr double kWidestView = 20.0;   // [focal lengths] Wider or higher is no pinhole camera's image.

std::string KilometersText(double meters) {
  return NumberText(meters / 1000.0) + " km";
}

[[noreturn]] void Fail(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

/// The file of a view.
std::string Beside(const std::string& view, std::string_view kind) {
  return view + std::string(kind);
}

/// Reads exactly `Count` finite numbers.
template <std::size_t Count>
std::array<double, Count> NumbersIn(const fs::path& file) {
  std::ifstream in(file);
  if (!in) Fail(file, "cannot be read");
  std::array<double, Count> numbers{};
  std::string word;
  for (std::size_t i = 0; i < Count; ++i) {
    if (!(in >> word))
      Fail(file, "has " + std::to_string(i) + " numbers, must have " + std::to_string(Count));
    std::istringstream text(word);
    if (!(text >> numbers[i]) || !text.eof() || !std::isfinite(numbers[i])) {
      Fail(file, '"' + CleanText(word) + "\" is not a number");
    }
  }
  if (in >> word) Fail(file, "has more than " + std::to_string(Count) + " numbers");
  return numbers;
}

cv::Mat ImageIn(const fs::path& file, int type, const std::string& kind) {
  cv::Mat image;
  try {
    image = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    Fail(file, "its size is invalid or too large");
  }
  if (image.empty()) Fail(file, "is not a readable image");
  if (image.type() != type) Fail(file, "must be " + kind);
  return image;
}

/// Intrinsics of another size of the images are a mistake that is easily made, and seen in nothing else.
void CheckIntrinsics(const PinholeCamera& camera, const fs::path& file) {
  const std::string images = "images of " + SizeText(camera.width_px, camera.height_px);
  // That of an image half or twice as large is a quarter of the size or more away.
  const auto is_central = [](double c, int size) { return std::abs(c - 0.5 * (size - 1)) <= 0.2 * size; };
  if (!is_central(camera.cx, camera.width_px) || !is_central(camera.cy, camera.height_px))
    Fail(file, "the principal point (" + NumberText(camera.cx) + ", " + NumberText(camera.cy) +
                   ") is far from the middle of " + images + "; are these of another size?");
  if (camera.width_px > kWidestView * camera.fx || camera.height_px > kWidestView * camera.fy)
    Fail(file, "the focal lengths " + NumberText(camera.fx) + ", " + NumberText(camera.fy) +
                   " px are too short for " + images);
}

RigidTransform PoseIn(const fs::path& file) {
  const std::array<double, 16> numbers = NumbersIn<16>(file);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> T(numbers.data());
  const bool bottom = (T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-6;
  if (!bottom || !IsRotation(T.topLeftCorner<3, 3>())) Fail(file, "is not a rotation and a translation");
  if (!(T.topRightCorner<3, 1>().norm() <= kFarthestPose))
    Fail(file, "is farther than " + KilometersText(kFarthestPose) + " from the origin");
  // Rounded numbers are no exact rotation.
  const Eigen::Quaterniond q = Eigen::Quaterniond(Eigen::Matrix3d(T.topLeftCorner<3, 3>())).normalized();
  return MakeTransform(q.toRotationMatrix(), T.topRightCorner<3, 1>());
}

}  // namespace

ViewFolder ViewFolder::Open(const fs::path& folder) {
  if (!fs::is_directory(folder)) Fail(folder, "is not a folder");
  ViewFolder views;
  views.folder_ = folder;
  bool needs_baseline = false;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::string name = entry.path().filename().string();
    for (const std::string_view kind : {kDepth, kDisparity}) {
      if (!name.ends_with(kind)) continue;
      const std::string pose = Beside(name.substr(0, name.size() - kind.size()), kPose);
      if (!fs::exists(folder / pose)) Fail(entry.path(), "has no " + pose + " beside it");
    }
    if (!name.ends_with(kPose)) continue;
    name.resize(name.size() - kPose.size());
    const bool disparity = fs::exists(folder / Beside(name, kDisparity));
    if (disparity && fs::exists(folder / Beside(name, kDepth)))
      Fail(entry.path(),
           "has both " + Beside(name, kDepth) + " and " + Beside(name, kDisparity) + " beside it");
    if (!disparity && !fs::exists(folder / Beside(name, kDepth))) {
      Fail(entry.path(),
           "has neither " + Beside(name, kDepth) + " nor " + Beside(name, kDisparity) + " beside it");
    }
    needs_baseline = needs_baseline || disparity;
    views.names_.push_back(std::move(name));
  }
  if (views.names_.empty()) Fail(folder, "has no view: no file NAME.pose.txt");
  std::sort(views.names_.begin(), views.names_.end());
  const fs::path intrinsics = folder / kIntrinsics;
  const std::array<double, 9> K = NumbersIn<9>(intrinsics);
  if (K[1] != 0.0 || K[3] != 0.0 || K[6] != 0.0 || K[7] != 0.0 || K[8] != 1.0) {
    Fail(intrinsics, "must be fx 0 cx, 0 fy cy, 0 0 1");
  }
  views.camera_ = {.width_px = 1, .height_px = 1, .fx = K[0], .fy = K[4], .cx = K[2], .cy = K[5]};
  if (const auto mistake = MistakeIn(views.camera_)) Fail(intrinsics, *mistake);
  views.camera_.width_px = views.camera_.height_px = 0;  // those of the first image
  views.baseline_ = kDepthBaseline;
  if (needs_baseline) {
    views.baseline_ = NumbersIn<1>(folder / "baseline.txt")[0];
    if (!(views.baseline_ > 0.0 && views.baseline_ <= kFarthest))
      Fail(folder / "baseline.txt", "must be above 0 and at most " + KilometersText(kFarthest));
  }
  return views;
}

View ViewFolder::Load(std::size_t index) {
  const std::string& name = names_[index];
  const fs::path disparity_file = folder_ / Beside(name, kDisparity);
  const bool is_disparity = fs::exists(disparity_file);
  const fs::path file = is_disparity ? disparity_file : folder_ / Beside(name, kDepth);
  const cv::Mat image =
      is_disparity ? ImageIn(file, CV_32FC1, "a PFM of one channel") : ImageIn(file, CV_16UC1, "16-bit gray");
  const auto check_size = [&](const fs::path& of, const cv::Mat& other) {
    if (other.cols == camera_.width_px && other.rows == camera_.height_px) return;
    Fail(of, "is " + SizeText(other.cols, other.rows) + ", the images before are " +
                 SizeText(camera_.width_px, camera_.height_px));
  };
  if (camera_.width_px == 0) {
    camera_.width_px = image.cols;
    camera_.height_px = image.rows;
    CheckIntrinsics(camera_, folder_ / kIntrinsics);
  }
  check_size(file, image);

  View view{.rig = {camera_, baseline_}, .disparities = {}, .colors = {}};
  view.T_WC = PoseIn(folder_ / Beside(name, kPose));
  if (is_disparity) {
    view.disparities.assign(image.begin<float>(), image.end<float>());
  } else {
    DepthImage depth{camera_.width_px, camera_.height_px, {}};
    for (auto mm = image.begin<std::uint16_t>(); mm != image.end<std::uint16_t>(); ++mm) {
      depth.depths.push_back(*mm == 65535 ? 0.0F : 1e-3F * static_cast<float>(*mm));
    }
    view.disparities = DisparitiesOf(depth, view.rig);
  }
  const fs::path color_file = folder_ / (name + ".color.png");
  if (fs::exists(color_file)) {
    const cv::Mat colors = ImageIn(color_file, CV_8UC3, "8-bit color");
    check_size(color_file, colors);
    for (auto bgr = colors.begin<cv::Vec3b>(); bgr != colors.end<cv::Vec3b>(); ++bgr) {
      view.colors.push_back({(*bgr)[2], (*bgr)[1], (*bgr)[0]});
    }
  }
  if (const auto mistake = MistakeIn(view)) Fail(file, *mistake);
  return view;
}

}  // namespace thalweg::surface
