#pragma once

#include <optional>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// Pixels that count in an evaluation: those that are not 0. All masks have the size of the left image.
struct EvaluationMasks {
  ByteImage non_occluded;          ///< Visible to both cameras.
  ByteImage near_discontinuities;  ///< Non-occluded and near a disparity jump.
  ByteImage all;                   ///< With known ground truth.
};

/// Derives masks from the ground truth of both images, for data sets that provide none. Non-occluded are the
/// pixels whose two ground truths agree within 1 px. Near a discontinuity are those within 4 px (a window of
/// 9, as in the classic evaluation [Scharstein & Szeliski, IJCV 2002, Sec. 5.1]) of a jump by more than 2 px.
/// @param truth_right  Ground truth of the right image's pixels. Without it, a pixel counts as occluded if
///   its place in the right image lies outside that image, or if a pixel of the left ground truth that is
///   nearer by more than 1 px falls on the same place.
EvaluationMasks MasksFrom(const DisparityMap& truth, const std::optional<DisparityMap>& truth_right);

/// Fills each gap with the smaller of the two disparities beside it in its row, i.e. with the farther
/// surface; at the image border with the only one; in a row without any match with 0.
DisparityMap FillGaps(const DisparityMap& disparity);

/// Shares, 0 to 1, of pixels whose disparity is wrong by more than a threshold; a gap counts as wrong. NaN
/// where there is no pixel to evaluate.
struct Evaluation {
  double bad_non_occluded = 0.0;
  double bad_near_discontinuities = 0.0;
  double bad_all = 0.0;
  double density = 0.0;      ///< Share of the whole image's pixels with a match, before gaps are filled.
  double bad_matched = 0.0;  ///< Among the pixels with a match and known ground truth.
};

/// Evaluates a disparity map; gaps are filled for the first three shares.
/// @param threshold  [px]
Evaluation Evaluate(const DisparityMap& disparity, const DisparityMap& truth, const EvaluationMasks& masks,
                    float threshold = 1.0F);

}  // namespace thalweg::stereo
