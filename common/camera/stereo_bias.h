#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/stereo_geometry.h"

namespace thalweg {

/// What a rectified stereo camera does wrong in every image, however good the match: the right camera has
/// turned since it was calibrated, or its distortion was modeled badly. As if the right image were bent:
///   u_right = u_right_true + c^T (1, x^2),   x = (u_right - cx) / fx,   v_right = v_left + row.
/// So disparities come out too small by c^T (1, x^2). A yaw of a radians alone is c = fx a (1, 1).
using DisparityBias = Eigen::Vector2d;  ///< c [px]

/// (1, x^2) at this column of the right image [px].
inline Eigen::Vector2d BiasBasis(const PinholeCamera& camera, double u_right) {
  const double x = (u_right - camera.cx) / camera.fx;
  return {1.0, x * x};
}

/// Root mean square of c^T (1, x^2) over the image's columns, for the mean `moment` of c c^T [px^2].
double OffsetInImage(const PinholeCamera& camera, const Eigen::Matrix2d& moment);  ///< [px]

/// What is believed about a calibration.
struct CalibrationFinding {
  DisparityBias disparity_px = DisparityBias::Zero();            ///< The mean of c
  Eigen::Vector2d disparity_sigma_px = Eigen::Vector2d::Zero();  ///< and its standard deviations.
  double row_px = 0.0;                                           ///< The mean of v_right - v_left
  double row_sigma_px = 0.0;                                     ///< and its standard deviation.
  double off_probability = 0.0;  ///< Probability that disparities or rows are off.
  double offset_px = 0.0;        ///< By how much, over the image: rows and disparities.
  double left_px = 0.0;          ///< Likewise of disparities, after the correction.
};

/// Judges from evidence that comes with time whether a calibration holds, and by how much it is off if not.
///
/// Three hypotheses are weighed by Bayes' rule [Kass, Raftery, Bayes Factors, JASA 90(430), 1995]: both
/// coefficients are good, N(0, good_sigma^2); the second is off, N(0, off_sigma^2), by wrong distortion; both
/// are, since a camera that turns changes both. Let P be the diagonal matrix of the prior variances of one
/// hypothesis, L the information from all evidence and l = L c_measured. Then the posterior is
/// N((L + P^-1)^-1 l, (L + P^-1)^-1), and the logarithm of the evidence for it, up to a constant,
///   (l^T (L + P^-1)^-1 l - ln det(I + L P)) / 2.
/// What is corrected is the posterior mean of coefficients that are off, times the probability of that: what
/// is not significantly different from zero is not corrected, but its uncertainty remains. Rows are judged
/// likewise.
///
/// Threading: one thread.
class StereoBiasMonitor {
 public:
  struct Options {
    /// [px] Standard deviations of the coefficients of a good calibration, and of one that is off.
    Eigen::Vector2d good_sigma_px{0.1, 0.8};
    Eigen::Vector2d off_sigma_px{1.0, 2.0};
    double off_prior = 0.02;  ///< Probability of either way to be off, before any evidence.
    /// [px] Standard deviation of an error of the disparities that does not average out: slanted surfaces
    /// beside the path, and what (1, x^2) does not model. From a recorded street, whose x^2 comes out at 1.1
    /// px.
    double lasting_sigma_px = 0.008;
    double good_row_sigma_px = 0.15;  ///< [px] Standard deviation of the rows of a good calibration,
    double off_row_sigma_px = 1.0;    ///< [px] and of one that is off.
    double row_sigma_px = 0.1;        ///< [px] Standard deviation of the median row offset of one image pair,
    double lasting_row_sigma_px = 0.05;  ///< [px] and the part of it that does not average out.
    int least_rows = 20;                 ///< Number of points below which a pair says nothing about rows.
    /// Number of additions of evidence after which old evidence has lost most of its weight, so that a camera
    /// that moves later is noticed.
    double memory = 500.0;
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit StereoBiasMonitor(const Options& options);

  /// @param measured     c as measured, by evidence that is independent of all before.
  /// @param information  Its inverse covariance [1/px^2]; may be singular.
  /// @param with_known_motion  [1/px^2] Information about c[0] if the motion were known; >= information(0,
  /// 0).
  ///   What lasts of the disparities' errors can look like a motion, too, so that it is larger in c by the
  ///   ratio of both: N = with_known_motion, measured has the covariance L^-1 + (lasting_sigma N L^-1)^2.
  void AddDisparities(const DisparityBias& measured, const Eigen::Matrix2d& information,
                      double with_known_motion);
  /// @param offsets  [px] v_right - v_left of the points of one image pair, without any correction.
  void AddRows(std::vector<double> offsets);

  /// What is to be added to disparities: c^T (1, x^2). Close to 0 unless the calibration is off.
  const DisparityBias& correction() const { return correction_; }
  double row_correction() const { return row_correction_; }  ///< [px] v_right - v_left, likewise.
  const DisparityBias& mean() const { return mean_; }        ///< [px] Estimate of c
  const Eigen::Matrix2d& second_moment() const { return second_moment_; }  ///< [px^2] and of c c^T.
  /// Mean of e e^T for the error e of the correction [px^2].
  Eigen::Matrix2d ErrorMoment() const;

  CalibrationFinding Finding(const PinholeCamera& camera) const;

 private:
  void JudgeDisparities();
  void JudgeRows();

  Options options_;
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d information_vector_ = Eigen::Vector2d::Zero();
  double with_known_motion_ = 0.0;
  double row_information_ = 0.0;
  double row_information_vector_ = 0.0;

  DisparityBias correction_ = DisparityBias::Zero();
  DisparityBias mean_ = DisparityBias::Zero();
  Eigen::Matrix2d second_moment_ = Eigen::Matrix2d::Zero();
  double off_probability_ = 0.0;
  double row_correction_ = 0.0;
  double row_ = 0.0;
  double row_sigma_ = 0.0;
  double row_off_probability_ = 0.0;
};

}  // namespace thalweg
