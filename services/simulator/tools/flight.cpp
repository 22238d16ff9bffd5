#include "services/simulator/tools/flight.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/geometry/polyline.h"

namespace thalweg::simulator {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kClearance = 0.35;  // [m]
constexpr double kSpeed = 0.5;       // [m/s]

struct Ellipse {
  Eigen::Vector3d center;
  double a = 0.0;
  double b = 0.0;

  Eigen::Vector3d At(double angle) const {
    return center + Eigen::Vector3d(a * std::cos(angle), b * std::sin(angle), 0.0);
  }
  double Heading(double angle) const { return std::atan2(b * std::cos(angle), -a * std::sin(angle)); }
  double Girth() const {  // Ramanujan's first approximation
    return std::numbers::pi * (3.0 * (a + b) - std::sqrt((3.0 * a + b) * (a + 3.0 * b)));
  }
};

bool IsClear(const World& world, const Ellipse& ellipse) {
  constexpr int kSamples = 120;
  Eigen::Vector3d last = ellipse.At(0.0);
  for (int k = 1; k <= kSamples; ++k) {
    const Eigen::Vector3d p = ellipse.At(kTwoPi * k / kSamples);
    if (world.DistanceToSurface(p, 1.0) < kClearance || !world.InSight(last, p)) return false;
    last = p;
  }
  return true;
}

Ellipse LargestEllipse(const World& world) {
  const Eigen::Vector3d low = world.bounds().min();
  const Eigen::Vector3d size = world.bounds().sizes();
  Ellipse best;
  for (int i = 1; i < 8; ++i) {
    for (int j = 1; j < 8; ++j) {
      const Eigen::Vector3d center =
          low + Eigen::Vector3d(i / 8.0 * size.x(), j / 8.0 * size.y(), 0.55 * size.z());
      for (double a = 0.4; a < 0.5 * size.x(); a += 0.2) {
        for (double b = 0.4; b < 0.5 * size.y(); b += 0.2) {
          const Ellipse candidate{center, a, b};
          if (candidate.Girth() > best.Girth() && IsClear(world, candidate)) best = candidate;
        }
      }
    }
  }
  if (best.a == 0.0) throw std::runtime_error("no round fits into this world");
  return best;
}

}  // namespace

double Flight::Length() const {
  return PathLength(T_WCs);
}

Time Flight::StampOf(std::size_t frame) const {
  return Time(std::chrono::seconds(1)) + FromSeconds(static_cast<double>(frame) / rate);
}

Flight FlyRounds(const World& world, Motion motion, double length) {
  const Ellipse ellipse = LargestEllipse(world);
  Flight flight;
  double angle = 0.0;
  double traveled = 0.0;
  double time = 0.0;
  while (traveled < length) {
    const bool jerky = motion == Motion::kJerky;
    double yaw = ellipse.Heading(angle) + 0.35 * std::sin(kTwoPi * 0.11 * time);
    double pitch = 0.12 * std::sin(kTwoPi * 0.17 * time);
    double roll = 0.0;
    Eigen::Vector3d p = ellipse.At(angle) + Eigen::Vector3d(0, 0, 0.15 * std::sin(kTwoPi * 0.09 * time));
    double speed = kSpeed;
    if (jerky) {
      yaw += 0.05 * std::sin(kTwoPi * 2.3 * time) * std::sin(kTwoPi * 0.21 * time);
      pitch += 0.04 * std::sin(kTwoPi * 3.1 * time) * std::sin(kTwoPi * 0.27 * time);
      roll += 0.04 * std::sin(kTwoPi * 2.7 * time) * std::cos(kTwoPi * 0.19 * time);
      p += 0.004 * Eigen::Vector3d(std::sin(kTwoPi * 4.1 * time), std::sin(kTwoPi * 3.7 * time),
                                   std::sin(kTwoPi * 4.7 * time));
      speed = kSpeed * 2.0 * std::max(0.0, std::sin(kTwoPi * 0.25 * time));  // moves for 2 s, rests for 2 s
    }
    const Eigen::Matrix3d R_WB = RotationFromYawPitch(yaw, pitch) *
                                 Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()).toRotationMatrix();
    flight.T_WCs.push_back(MakeTransform(R_WB * BodyFromOptical(), p));
    const double per_angle = Eigen::Vector2d(ellipse.a * std::sin(angle), ellipse.b * std::cos(angle)).norm();
    const double step = speed / flight.rate;
    angle += step / per_angle;
    traveled += step;
    time += 1.0 / flight.rate;
  }
  return flight;
}

StereoRigModel NoisyRig() {
  StereoRigModel model;
  model.noise_sigma = 2.0;
  return model;
}

}  // namespace thalweg::simulator
