#include "services/visual_odometry/core/rotation_prediction.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <vector>

#include "services/visual_odometry/core/inverse_depth.h"

namespace thalweg::visual_odometry {
namespace {

constexpr int kMostRotationSteps = 20;
constexpr double kGrayHuber = 12.0;  // [gray values]
constexpr double kSettledRotation = 1e-5;

struct Sample {
  double value;
  double gradient_u;
  double gradient_v;
};

bool SampleAt(const cv::Mat& image, double u, double v, Sample& sample) {
  if (u < 1.0 || v < 1.0 || u >= image.cols - 2 || v >= image.rows - 2) return false;
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const double a = u - column;
  const double b = v - row;
  const std::uint8_t* const p = image.ptr<std::uint8_t>(row) + column;
  const std::uint8_t* const q = p + image.step;
  sample.value = (1 - b) * ((1 - a) * p[0] + a * p[1]) + b * ((1 - a) * q[0] + a * q[1]);
  sample.gradient_u = (1 - b) * (p[1] - p[0]) + b * (q[1] - q[0]);
  sample.gradient_v = (1 - a) * (q[0] - p[0]) + a * (q[1] - p[1]);
  return true;
}

struct Normal {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();  // rotation, brightness
  Eigen::Vector4d descent = Eigen::Vector4d::Zero();
  double cost = 0.0;
  int count = 0;
};

Normal Accumulate(const cv::Mat& before, const cv::Mat& after, const PinholeCamera& camera,
                  const Eigen::Matrix3d& R_AB, double brightness) {
  Normal normal;
  Sample sample{};
  for (int row = 0; row < before.rows; ++row) {
    for (int column = 0; column < before.cols; ++column) {
      const Eigen::Vector3d m = R_AB * camera.RayAtUnitDepth(column, row);
      if (m.z() <= 0.1) continue;
      const double w = 1.0 / m.z();
      if (!SampleAt(after, camera.fx * m.x() * w + camera.cx, camera.fy * m.y() * w + camera.cy, sample)) {
        continue;
      }
      const double residual = sample.value - before.at<std::uint8_t>(row, column) - brightness;
      const double weight = std::abs(residual) <= kGrayHuber ? 1.0 : kGrayHuber / std::abs(residual);
      const Eigen::Vector3d image_by_m(
          sample.gradient_u * camera.fx * w, sample.gradient_v * camera.fy * w,
          -(sample.gradient_u * camera.fx * m.x() + sample.gradient_v * camera.fy * m.y()) * w * w);
      Eigen::Vector4d jacobian;
      jacobian << m.cross(image_by_m), -1.0;  // d m = w x m
      normal.information += weight * jacobian * jacobian.transpose();
      normal.descent += weight * residual * jacobian;
      normal.cost += std::abs(residual);
      ++normal.count;
    }
  }
  return normal;
}

}  // namespace

std::optional<Eigen::Matrix3d> PredictRotation(const cv::Mat& before, const cv::Mat& after,
                                               const PinholeCamera& camera, const Eigen::Matrix3d& R_start) {
  Eigen::Matrix3d R_AB = R_start;
  double brightness = cv::mean(after)[0] - cv::mean(before)[0];
  for (int step = 0; step < kMostRotationSteps; ++step) {
    const Normal normal = Accumulate(before, after, camera, R_AB, brightness);
    if (normal.count < before.rows * before.cols / 4) return std::nullopt;
    const Eigen::LDLT<Eigen::Matrix4d> solver(normal.information);
    if (solver.info() != Eigen::Success || solver.vectorD().minCoeff() <= 1e-9) return std::nullopt;
    const Eigen::Vector4d move = -solver.solve(normal.descent);
    if (!move.allFinite()) return std::nullopt;
    R_AB = RotationFromVector(move.head<3>()) * R_AB;
    brightness += move[3];
    if (move.head<3>().norm() < kSettledRotation) break;
  }
  return R_AB;
}

Eigen::Matrix3d BestRotation(const cv::Mat& before, const cv::Mat& after, const PinholeCamera& camera,
                             const std::array<Eigen::Matrix3d, 2>& guesses) {
  Eigen::Matrix3d best = guesses.front();
  double least = RotationError(before, after, camera, best);
  for (const Eigen::Matrix3d& guess : guesses) {
    const auto aligned = PredictRotation(before, after, camera, guess);
    if (!aligned) continue;
    const double error = RotationError(before, after, camera, *aligned);
    if (error >= least) continue;
    least = error;
    best = *aligned;
  }
  return best;
}

double RotationError(const cv::Mat& before, const cv::Mat& after, const PinholeCamera& camera,
                     const Eigen::Matrix3d& R_AB) {
  const Normal normal = Accumulate(before, after, camera, R_AB, cv::mean(after)[0] - cv::mean(before)[0]);
  return normal.count < before.rows * before.cols / 4 ? std::numeric_limits<double>::infinity()
                                                      : normal.cost / normal.count;
}

PinholeCamera ScaledDown(const PinholeCamera& camera, int levels) {
  PinholeCamera small = camera;
  for (int level = 0; level < levels; ++level) {
    small.width_px = (small.width_px + 1) / 2;
    small.height_px = (small.height_px + 1) / 2;
  }
  const double scale = 1.0 / (1 << levels);
  small.fx *= scale;
  small.fy *= scale;
  small.cx *= scale;
  small.cy *= scale;
  return small;
}

}  // namespace thalweg::visual_odometry
