#pragma once

#include <Eigen/Core>
#include <deque>

namespace thalweg::controller {

/// A point that follows another one as its mean over the last `window` seconds. Its velocity is the mean
/// velocity, its acceleration the mean acceleration, and none is greater than the other point's. The
/// acceleration a of the other one may jump: that of the mean changes by at most 2 |a| / window per second.
/// The mean is half a window late, and cuts a curve that is passed at the lateral acceleration a by a
/// window^2 / 24.
class Smoother {
 public:
  /// @param window  [s] > 0.
  explicit Smoother(double window) : window_(window) {}

  /// Both points stand at p_W.
  void Restart(const Eigen::Vector3d& p_W);
  /// The other point has moved straight to p_W. @param dt  [s] >= 0. @pre Restart has been called.
  void Move(const Eigen::Vector3d& p_W, double dt);

  Eigen::Vector3d position() const;
  Eigen::Vector3d velocity() const;  ///< [m/s]
  /// Whether the mean has arrived at the other point, and both stand.
  bool stands() const;

 private:
  struct Knot {
    double time;  ///< [s]
    Eigen::Vector3d p_W;
  };
  double begin() const { return knots_.back().time - window_; }
  /// Where the other point was when the window begins, between the first two knots.
  Eigen::Vector3d AtBegin() const;

  double window_;
  std::deque<Knot> knots_;  ///< Oldest first; the first is not later than the window's beginning.
};

}  // namespace thalweg::controller
