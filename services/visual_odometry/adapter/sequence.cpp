#include "services/visual_odometry/adapter/sequence.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <sstream>
#include <stdexcept>

#include "common/base/size_text.h"

namespace thalweg::visual_odometry {
namespace {

namespace fs = std::filesystem;

constexpr double kKittiRate = 10.0;                   // [Hz]
const Duration kLongestTruthGap = FromSeconds(0.11);  // two frames of EuRoC's cameras
const std::set<std::string> kImageNames = {".png", ".jpg", ".jpeg", ".pgm"};

[[noreturn]] void Fail(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

std::vector<fs::path> ImagesIn(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && kImageNames.contains(entry.path().extension().string())) {
      images.push_back(entry.path());
    }
  }
  std::sort(images.begin(), images.end());
  if (images.empty()) Fail(folder, "has no images (.png, .jpg, .pgm)");
  return images;
}

/// Pairs the images of both folders by name.
std::vector<std::pair<fs::path, fs::path>> PairsIn(const fs::path& left, const fs::path& right) {
  std::vector<std::pair<fs::path, fs::path>> pairs;
  for (const fs::path& image : ImagesIn(left)) {
    const fs::path partner = right / image.filename();
    if (!fs::exists(partner)) Fail(image, "has no partner " + partner.string());
    pairs.emplace_back(image, partner);
  }
  const std::size_t count = ImagesIn(right).size();
  if (count != pairs.size()) {
    Fail(right, "has " + std::to_string(count) + " images, " + left.string() + " has " +
                    std::to_string(pairs.size()));
  }
  return pairs;
}

cv::Size SizeOf(const fs::path& file) {
  const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (image.empty()) Fail(file, "is not an image that can be read");
  return image.size();
}

using Projection = std::array<double, 12>;

struct ProjectionLine {
  std::string name;  ///< "P0", or empty.
  Projection values;
};

std::vector<ProjectionLine> ReadKittiCalibration(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) Fail(file, "cannot be read");
  std::vector<ProjectionLine> lines;
  std::string text;
  for (int number = 1; std::getline(stream, text); ++number) {
    std::istringstream words(text);
    ProjectionLine line;
    std::string word;
    std::vector<double> values;
    while (words >> word) {
      if (values.empty() && line.name.empty() && word.back() == ':') {
        line.name = word.substr(0, word.size() - 1);
        continue;
      }
      double value = 0.0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
        Fail(file.string() + ':' + std::to_string(number), "\"" + word + "\" is not a finite number");
      }
      values.push_back(value);
    }
    // Other lines, such as Tr of the laser
    if (values.empty() || (!line.name.empty() && line.name.front() != 'P')) continue;
    if (values.size() != line.values.size()) {
      Fail(file.string() + ':' + std::to_string(number),
           "has " + std::to_string(values.size()) + " numbers, a projection matrix has 12");
    }
    std::copy(values.begin(), values.end(), line.values.begin());
    lines.push_back(line);
  }
  return lines;
}

const Projection& ProjectionOf(const std::vector<ProjectionLine>& lines, const std::string& name,
                               std::size_t index, const fs::path& file) {
  for (const ProjectionLine& line : lines) {
    if (line.name == name) return line.values;
  }
  if (index >= lines.size() || !lines[index].name.empty()) Fail(file, "has no projection matrix " + name);
  return lines[index].values;
}

StereoGeometry GeometryFrom(const Projection& left, const Projection& right, const cv::Size& size,
                            const fs::path& file) {
  StereoGeometry geometry;
  geometry.camera = {size.width, size.height, left[0], left[5], left[2], left[6]};
  const PinholeCamera& camera = geometry.camera;
  if (camera.fx <= 0.0 || camera.fy <= 0.0) Fail(file, "focal lengths must be > 0");
  if (camera.cx <= 0.0 || camera.cy <= 0.0 || camera.cx >= size.width || camera.cy >= size.height) {
    Fail(file, "the principal point (" + std::to_string(camera.cx) + ", " + std::to_string(camera.cy) +
                   ") lies outside the images of " + SizeText(size.width, size.height));
  }
  for (const std::size_t k : {0U, 2U, 5U, 6U}) {
    if (std::abs(left[k] - right[k]) > 1e-3 * std::abs(left[k])) {
      Fail(file, "the two cameras differ: the images are not rectified");
    }
  }
  geometry.baseline = (left[3] - right[3]) / camera.fx;
  if (geometry.baseline <= 0.0) {
    Fail(file, "the baseline is " + std::to_string(geometry.baseline) + " m, must be > 0: are they swapped?");
  }
  return geometry;
}

std::vector<double> ReadTimes(const fs::path& file, std::size_t count) {
  std::ifstream stream(file);
  std::vector<double> times;
  std::string text;
  for (int number = 1; std::getline(stream, text) && !text.empty(); ++number) {
    if (text.back() == '\r') text.pop_back();
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value) || value < 0.0) {
      Fail(file.string() + ':' + std::to_string(number), "\"" + text + "\" is not a time");
    }
    if (!times.empty() && value <= times.back()) {
      Fail(file.string() + ':' + std::to_string(number), "is not later than the previous line");
    }
    times.push_back(value);
  }
  if (times.size() != count) {
    Fail(file,
         "has " + std::to_string(times.size()) + " lines, there are " + std::to_string(count) + " images");
  }
  return times;
}

/// The first of these paths that exists.
fs::path FirstOf(const std::vector<fs::path>& candidates, const std::string& what) {
  for (const fs::path& path : candidates) {
    if (fs::exists(path)) return path;
  }
  Fail(candidates.front(), what + " is missing");
}

struct EurocCamera {
  RawCamera camera;
  RigidTransform T_BS;
};

/// The numbers of a list in the file. Throws naming file and field.
std::vector<double> NumbersOf(const cv::FileNode& node, const fs::path& file, const std::string& field,
                              std::size_t count) {
  if (!node.isSeq()) Fail(file, field + " is missing");
  std::vector<double> numbers;
  for (const cv::FileNode& item : node) {
    if (!item.isReal() && !item.isInt()) Fail(file, field + " contains something that is not a number");
    numbers.push_back(static_cast<double>(item));
    if (!std::isfinite(numbers.back())) Fail(file, field + " contains a non-finite number");
  }
  if (numbers.size() < count) {
    Fail(file,
         field + " has " + std::to_string(numbers.size()) + " numbers, must have " + std::to_string(count));
  }
  return numbers;
}

/// OpenCV's parser requires a first line "%YAML:1.0", which EuRoC's later releases lack.
std::string YamlText(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) Fail(file, "cannot be read");
  std::stringstream text;
  text << stream.rdbuf();
  return text.str().starts_with("%YAML") ? text.str() : "%YAML:1.0\n" + text.str();
}

EurocCamera ReadEurocCamera(const fs::path& file) {
  cv::FileStorage storage;
  try {
    storage.open(YamlText(file), cv::FileStorage::READ | cv::FileStorage::MEMORY);
  } catch (const cv::Exception& error) {
    Fail(file, "is not YAML: " + error.err);  // its text includes the line
  }
  EurocCamera result;
  const auto size = NumbersOf(storage["resolution"], file, "resolution", 2);
  const auto intrinsics = NumbersOf(storage["intrinsics"], file, "intrinsics", 4);
  const auto distortion = NumbersOf(storage["distortion_coefficients"], file, "distortion_coefficients", 4);
  const auto pose = NumbersOf(storage["T_BS"]["data"], file, "T_BS.data", 16);
  std::string model;
  if (!storage["distortion_model"].empty()) storage["distortion_model"] >> model;
  if (!model.empty() && model != "radial-tangential" && model != "radtan") {
    Fail(file, "distortion_model is \"" + model + "\", must be radial-tangential");
  }
  result.camera.width_px = static_cast<int>(size[0]);
  result.camera.height_px = static_cast<int>(size[1]);
  result.camera.K << intrinsics[0], 0.0, intrinsics[2], 0.0, intrinsics[1], intrinsics[3], 0.0, 0.0, 1.0;
  result.camera.distortion = distortion;
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  for (std::size_t row = 0; row < 3; ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    for (std::size_t column = 0; column < 3; ++column) {
      R(r, static_cast<Eigen::Index>(column)) = pose[4 * row + column];
    }
    t[r] = pose[4 * row + 3];
  }
  if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-2) Fail(file, "T_BS is not a rotation");
  result.T_BS = MakeTransform(Eigen::Quaterniond(R).normalized().toRotationMatrix(), t);
  return result;
}

Time StampFromName(const fs::path& image) {
  const std::string name = image.stem().string();
  std::int64_t ns = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), ns);
  if (error != std::errc() || end != name.data() + name.size() || ns < 0) {
    Fail(image, "the name is not a time in nanoseconds");
  }
  return Time(Duration(ns));
}

}  // namespace

Sequence Sequence::Open(const fs::path& folder) {
  if (!fs::is_directory(folder)) Fail(folder, "is not a folder");
  const std::array<std::pair<const char*, const char*>, 3> names = {
      {{"image_l", "image_r"}, {"image_0", "image_1"}, {"image_2", "image_3"}}};
  for (const auto& [left, right] : names) {
    if (fs::is_directory(folder / left)) return OpenKitti(folder, left, right);
  }
  for (const fs::path& root : {folder, folder / "mav0"}) {
    if (fs::is_directory(root / "cam0")) return OpenEuroc(root);
  }
  Fail(folder, "contains neither image_l or image_0 (KITTI) nor cam0 (EuRoC)");
}

Sequence Sequence::OpenKitti(const fs::path& folder, const std::string& left, const std::string& right) {
  Sequence sequence;
  sequence.layout_ = "KITTI";
  if (!fs::is_directory(folder / right)) Fail(folder / right, "is missing");
  const auto pairs = PairsIn(folder / left, folder / right);
  sequence.raw_size_ = SizeOf(pairs.front().first);
  const fs::path calibration = folder / "calib.txt";
  const auto lines = ReadKittiCalibration(calibration);
  const bool color = left == "image_2";
  sequence.geometry_ =
      GeometryFrom(ProjectionOf(lines, color ? "P2" : "P0", 0, calibration),
                   ProjectionOf(lines, color ? "P3" : "P1", 1, calibration), sequence.raw_size_, calibration);
  std::vector<double> times;
  const fs::path times_file = folder / "times.txt";
  if (fs::exists(times_file)) times = ReadTimes(times_file, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double seconds = times.empty() ? static_cast<double>(i) / kKittiRate : times[i];
    sequence.frames_.push_back({Time(FromSeconds(seconds)), pairs[i].first, pairs[i].second});
  }
  const fs::path poses_file = folder / "poses.txt";
  if (fs::exists(poses_file)) {
    const std::vector<RigidTransform> poses = ReadKittiPoses(poses_file);
    if (poses.size() != pairs.size()) {
      Fail(poses_file, "has " + std::to_string(poses.size()) + " poses, there are " +
                           std::to_string(pairs.size()) + " images");
    }
    std::vector<TimedPose> timed;
    for (std::size_t i = 0; i < poses.size(); ++i) timed.push_back({sequence.frames_[i].stamp, poses[i]});
    sequence.truth_.emplace(std::move(timed), Duration(0));
  }
  return sequence;
}

Sequence Sequence::OpenEuroc(const fs::path& folder) {
  Sequence sequence;
  sequence.layout_ = "EuRoC";
  std::array<fs::path, 2> images;
  std::array<EurocCamera, 2> cameras;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const fs::path own = folder / ("cam" + std::to_string(eye));
    if (!fs::is_directory(own)) Fail(own, "is missing");
    images[eye] = fs::is_directory(own / "data") ? own / "data" : own;
    const fs::path file =
        FirstOf({folder / ("cam" + std::to_string(eye) + ".yaml"), own / "sensor.yaml"}, "the calibration");
    cameras[eye] = ReadEurocCamera(file);
    const cv::Size size = SizeOf(ImagesIn(images[eye]).front());
    const RawCamera& camera = cameras[eye].camera;
    if (size != cv::Size(camera.width_px, camera.height_px)) {
      Fail(file, "resolution is " + SizeText(camera.width_px, camera.height_px) + ", the images are " +
                     SizeText(size.width, size.height));
    }
    sequence.raw_size_ = size;
  }
  try {
    sequence.rectifier_.emplace(
        StereoCalibration{cameras[0].camera, cameras[1].camera, cameras[1].T_BS.inverse() * cameras[0].T_BS});
  } catch (const std::invalid_argument& error) {
    Fail(folder, error.what());
  }
  sequence.geometry_ = sequence.rectifier_->geometry();
  sequence.T_BC_ = cameras[0].T_BS *
                   MakeTransform(sequence.rectifier_->R_rectified_raw().transpose(), Eigen::Vector3d::Zero());
  for (const auto& [left, right] : PairsIn(images[0], images[1])) {
    sequence.frames_.push_back({StampFromName(left), left, right});
  }
  for (const fs::path& truth :
       {folder / "groundtruth.csv", folder / "state_groundtruth_estimate0" / "data.csv"}) {
    if (!fs::exists(truth)) continue;
    sequence.truth_.emplace(ReadEurocTruth(truth), kLongestTruthGap);
    break;
  }
  return sequence;
}

cv::Mat Sequence::LoadImage(const fs::path& file) const {
  cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (image.empty()) Fail(file, "is not an image that can be read");
  if (image.size() != raw_size_) {
    Fail(file, "is " + SizeText(image.cols, image.rows) + ", the first image is " +
                   SizeText(raw_size_.width, raw_size_.height));
  }
  return image;
}

StereoImages Sequence::Load(std::size_t index) const {
  const Entry& entry = frames_[index];
  StereoImages images{entry.stamp, LoadImage(entry.left), LoadImage(entry.right)};
  if (rectifier_) {
    images.left = rectifier_->Rectify(Side::kLeft, images.left);
    images.right = rectifier_->Rectify(Side::kRight, images.right);
  }
  return images;
}

std::optional<RigidTransform> Sequence::TruthAt(std::size_t index) const {
  if (!truth_) return std::nullopt;
  const auto T_WB = truth_->At(frames_[index].stamp);
  if (!T_WB) return std::nullopt;
  return *T_WB * T_BC_;
}

}  // namespace thalweg::visual_odometry
