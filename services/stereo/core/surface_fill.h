#pragma once

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

struct SurfaceFillOptions {
  /// [of 255] Largest difference between neighbors on one surface, after blurring.
  int step = 2;
  int least_pixels = 150;           ///< Smallest surface to be filled.
  int least_matches = 30;           ///< Smallest number of matches on a surface.
  double least_share = 0.02;        ///< Smallest share of its pixels with a match.
  double tolerance = 1.0;           ///< [px] Largest distance of a match from a plane that it agrees with.
  double least_agreement = 0.3;     ///< Smallest share of matches that must agree.
  double overrule_agreement = 0.9;  ///< If more than this share agrees, the other matches are replaced.
  /// If fewer than this share of the pixels have a match, matches that disagree are replaced, too.
  double bare = 0.4;
  /// A second plane counts if it has more than this share of the first one's matches; gaps then get the
  /// farther of the two.
  double rival = 0.4;
  unsigned seed = 1;  ///< Seed of the random samples.
};

/// Fills the gaps on surfaces without texture, where only the rim and a few spots find a match, some of them
/// wrong. A region whose color changes little from pixel to pixel is taken as one surface, and its gaps get
/// the plane that most of its matches agree with (RANSAC).
void FillSurfaces(const ByteImage& image, const SurfaceFillOptions& options, float max_disparity,
                  DisparityMap& disparity);

}  // namespace thalweg::stereo
