#pragma once

#include <optional>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// Which pixels count: not 0. All of the size of the left image.
struct EvaluationMasks {
  ByteImage non_occluded;          ///< Seen by both cameras.
  ByteImage near_discontinuities;  ///< Non-occluded and near a jump of disparity.
  ByteImage all;                   ///< Of known truth.
};

/// Masks from the truth of both images, where none are given: non-occluded are the pixels whose two truths
/// agree within 1 px; near a discontinuity is what lies within 4 px (a window of 9, as in the classic
/// evaluation [Scharstein & Szeliski, IJCV 2002, Sec. 5.1]) of a jump by more than 2 px.
/// @param truth_right  Of the right image's pixels. Without it a pixel counts as occluded where a nearer one
/// of the
///                     left truth, by more than 1 px, falls on its place in the right image, or beyond that.
EvaluationMasks MasksFrom(const DisparityMap& truth, const std::optional<DisparityMap>& truth_right);

/// Fills each gap with the lower of the two neighbours along its row, the farther surface; at the image's
/// border with the only one; a row without any with 0.
DisparityMap FillGaps(const DisparityMap& disparity);

/// Shares, 0 to 1, of pixels whose disparity is wrong by more than a threshold; a gap is wrong. NaN where
/// there is no pixel to judge by.
struct Evaluation {
  double bad_non_occluded = 0.0;
  double bad_near_discontinuities = 0.0;
  double bad_all = 0.0;
  double density = 0.0;      ///< Of the whole image: pixels with a match before gaps are filled.
  double bad_matched = 0.0;  ///< Of the pixels with a match and known truth.
};

/// Gaps are filled for the first three. @param threshold  [px]
Evaluation Evaluate(const DisparityMap& disparity, const DisparityMap& truth, const EvaluationMasks& masks,
                    float threshold = 1.0F);

}  // namespace thalweg::stereo
