#include "services/stereo/adapter/calibration_file.h"

#include <initializer_list>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <stdexcept>
#include <string>

#include "common/files/write_file.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;

cv::FileStorage Open(const fs::path& file) {
  cv::FileStorage storage;
  try {
    if (fs::is_regular_file(file)) storage.open(file.string(), cv::FileStorage::READ);
  } catch (const cv::Exception& error) {
    throw std::runtime_error(file.string() + ": is not YAML that OpenCV can read: " + error.err);
  }
  if (!storage.isOpened()) throw std::runtime_error(file.string() + ": cannot be read");
  return storage;
}

/// Reads fields from one file, or from several that complement each other; its exceptions name the files.
class Reader {
 public:
  explicit Reader(const std::vector<fs::path>& files) {
    for (const fs::path& file : files) {
      name_ += (name_.empty() ? "" : ", ") + file.string();
      storages_.push_back(Open(file));
    }
  }

  [[noreturn]] void Fail(const std::string& what) const { throw std::runtime_error(name_ + ": " + what); }
  bool Has(const std::string& name) const { return !Find(name).empty(); }
  int Integer(const std::string& name) const {
    const cv::FileNode node = Find(name);
    if (!node.isInt()) Fail(name + " is missing or not an integer");
    return static_cast<int>(node);
  }
  /// The first of these matrices that is present.
  /// @param hint  Appended to the error if none is.
  cv::Mat Matrix(std::initializer_list<const char*> names, const char* hint) const {
    for (const char* const name : names) {
      const cv::FileNode node = Find(name);
      if (node.empty()) continue;
      cv::Mat matrix;
      try {
        node >> matrix;
      } catch (const cv::Exception& error) {
        Fail(std::string(name) + " is not a matrix: " + error.err);
      }
      if (matrix.empty() || matrix.channels() != 1) Fail(std::string(name) + " is not a matrix");
      matrix.convertTo(matrix, CV_64F);
      return matrix;
    }
    Fail(std::string(*names.begin()) + " is missing" + hint);
  }
  cv::Mat Matrix(std::initializer_list<const char*> names, const char* hint, int rows, int columns) const {
    cv::Mat matrix = Matrix(names, hint);
    if (static_cast<int>(matrix.total()) != rows * columns) {
      Fail(std::string(*names.begin()) + " is " + std::to_string(matrix.rows) + " x " +
           std::to_string(matrix.cols) + ", must be " + std::to_string(rows) + " x " +
           std::to_string(columns));
    }
    return matrix.reshape(1, rows);
  }

 private:
  cv::FileNode Find(const std::string& name) const {
    for (const cv::FileStorage& storage : storages_) {
      if (const cv::FileNode node = storage[name]; !node.empty()) return node;
    }
    return {};
  }

  std::string name_;
  std::vector<cv::FileStorage> storages_;
};

constexpr auto kIntrinsicsHint =
    ": OpenCV's stereo_calib writes it to intrinsics.yml; give both files, or join them in one";
constexpr auto kExtrinsicsHint =
    ": OpenCV's stereo_calib writes it to extrinsics.yml; give both files, or join them in one";

RawCamera CameraFrom(const Reader& reader, std::initializer_list<const char*> k, const char* d,
                     const ImageSize& size) {
  RawCamera camera{size.width_px, size.height_px, {}, {}};
  cv::cv2eigen(reader.Matrix(k, kIntrinsicsHint, 3, 3), camera.K);
  const cv::Mat distortion = reader.Matrix({d}, kIntrinsicsHint);
  camera.distortion.assign(distortion.begin<double>(), distortion.end<double>());
  return camera;
}

cv::Mat MatrixOf(const Eigen::MatrixXd& m) {
  cv::Mat out;
  cv::eigen2cv(m, out);
  return out;
}

}  // namespace

StereoCalibration ReadCalibration(const std::vector<fs::path>& files,
                                  const std::optional<ImageSize>& images) {
  const Reader reader(files);
  ImageSize size;
  if (reader.Has("image_width") || reader.Has("image_height")) {
    size = {reader.Integer("image_width"), reader.Integer("image_height")};
  } else if (images) {
    size = *images;
  } else {
    reader.Fail(
        "image_width and image_height are missing: OpenCV's stereo_calib does not write them, add those of "
        "the images");
  }
  StereoCalibration calibration;
  calibration.left = CameraFrom(reader, {"M1", "K1"}, "D1", size);
  calibration.right = CameraFrom(reader, {"M2", "K2"}, "D2", size);
  Eigen::Matrix3d R_RL;
  Eigen::MatrixXd t_RL;
  cv::cv2eigen(reader.Matrix({"R"}, kExtrinsicsHint, 3, 3), R_RL);
  cv::cv2eigen(reader.Matrix({"T"}, kExtrinsicsHint, 3, 1), t_RL);
  calibration.T_RL = MakeTransform(R_RL, t_RL);
  if (const auto mistake = MistakeIn(calibration)) reader.Fail(*mistake);
  return calibration;
}

void WriteCalibration(const fs::path& file, const CalibrationResult& result) {
  cv::FileStorage out(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const StereoCalibration& calibration = result.calibration;
  const RawCamera& left = calibration.left;
  const RawCamera& right = calibration.right;
  out << "image_width" << left.width_px << "image_height" << left.height_px;
  out << "M1" << MatrixOf(left.K) << "D1" << cv::Mat(left.distortion, true).reshape(1, 1);
  out << "M2" << MatrixOf(right.K) << "D2" << cv::Mat(right.distortion, true).reshape(1, 1);
  out << "R" << MatrixOf(calibration.T_RL.linear()) << "T" << MatrixOf(calibration.T_RL.translation());
  out << "reprojection_error_px" << result.reprojection_px << "epipolar_error_px" << result.epipolar_px;
  WriteFile(file, out.releaseAndGetString());
}

}  // namespace thalweg::stereo
