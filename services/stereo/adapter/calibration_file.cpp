#include "services/stereo/adapter/calibration_file.h"

#include <initializer_list>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <stdexcept>
#include <string>

namespace thalweg::stereo {
namespace {

/// Reads one file's fields; what it throws names the file.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {
    try {
      if (std::filesystem::is_regular_file(file)) storage_.open(file.string(), cv::FileStorage::READ);
    } catch (const cv::Exception& error) {
      Fail("is no YAML that OpenCV can read: " + error.err);
    }
    if (!storage_.isOpened()) Fail("no file that can be read");
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw std::runtime_error(file_.string() + ": " + what);
  }
  int Integer(const std::string& name) const {
    const cv::FileNode node = storage_[name];
    if (!node.isInt()) Fail(name + " is missing or no whole number");
    return static_cast<int>(node);
  }
  /// The first of these that is there.
  cv::Mat Matrix(std::initializer_list<const char*> names) const {
    for (const char* const name : names) {
      const cv::FileNode node = storage_[name];
      if (node.empty()) continue;
      cv::Mat matrix;
      try {
        node >> matrix;
      } catch (const cv::Exception& error) {
        Fail(std::string(name) + " is no matrix: " + error.err);
      }
      if (matrix.empty()) Fail(std::string(name) + " is no matrix");
      matrix.convertTo(matrix, CV_64F);
      return matrix;
    }
    Fail(std::string(*names.begin()) + " is missing");
  }
  cv::Mat Matrix(std::initializer_list<const char*> names, int rows, int columns) const {
    cv::Mat matrix = Matrix(names);
    if (static_cast<int>(matrix.total()) != rows * columns || matrix.channels() != 1) {
      Fail(std::string(*names.begin()) + " is " + std::to_string(matrix.rows) + " x " +
           std::to_string(matrix.cols) + ", must be " + std::to_string(rows) + " x " +
           std::to_string(columns));
    }
    return matrix.reshape(1, rows);
  }

 private:
  std::filesystem::path file_;
  cv::FileStorage storage_;
};

RawCamera CameraFrom(const Reader& reader, std::initializer_list<const char*> k, const char* d) {
  RawCamera camera;
  cv::cv2eigen(reader.Matrix(k, 3, 3), camera.K);
  const cv::Mat distortion = reader.Matrix({d});
  camera.distortion.assign(distortion.begin<double>(), distortion.end<double>());
  return camera;
}

cv::Mat MatrixOf(const Eigen::MatrixXd& m) {
  cv::Mat out;
  cv::eigen2cv(m, out);
  return out;
}

}  // namespace

StereoCalibration ReadCalibration(const std::filesystem::path& file) {
  const Reader reader(file);
  StereoCalibration calibration;
  calibration.width_px = reader.Integer("image_width");
  calibration.height_px = reader.Integer("image_height");
  calibration.left = CameraFrom(reader, {"M1", "K1"}, "D1");
  calibration.right = CameraFrom(reader, {"M2", "K2"}, "D2");
  cv::cv2eigen(reader.Matrix({"R"}, 3, 3), calibration.R);
  Eigen::MatrixXd t;
  cv::cv2eigen(reader.Matrix({"T"}, 3, 1), t);
  calibration.T = t;
  if (const auto mistake = MistakeIn(calibration)) reader.Fail(*mistake);
  return calibration;
}

void WriteCalibration(const std::filesystem::path& file, const CalibrationResult& result) {
  cv::FileStorage out(file.string(), cv::FileStorage::WRITE | cv::FileStorage::FORMAT_YAML);
  if (!out.isOpened()) throw std::runtime_error(file.string() + ": cannot be written");
  const StereoCalibration& calibration = result.calibration;
  out << "image_width" << calibration.width_px << "image_height" << calibration.height_px;
  out << "M1" << MatrixOf(calibration.left.K) << "D1"
      << cv::Mat(calibration.left.distortion, true).reshape(1, 1);
  out << "M2" << MatrixOf(calibration.right.K) << "D2"
      << cv::Mat(calibration.right.distortion, true).reshape(1, 1);
  out << "R" << MatrixOf(calibration.R) << "T" << MatrixOf(calibration.T);
  out << "reprojection_error_px" << result.reprojection_px << "epipolar_error_px" << result.epipolar_px;
}

}  // namespace thalweg::stereo
