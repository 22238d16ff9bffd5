#pragma once

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

struct SurfaceFillOptions {
  int step = 2;                     ///< [of 255] Neighbours on one surface differ by no more, once blurred.
  int least_pixels = 150;           ///< Of a surface.
  int least_matches = 30;           ///< On it.
  double least_share = 0.02;        ///< Of its pixels that have a match.
  double tolerance = 1.0;           ///< [px] Of a match from the plane that it agrees with.
  double least_agreement = 0.3;     ///< Share of the matches that must agree.
  double overrule_agreement = 0.9;  ///< When that many do, the others are taken for wrong.
  /// Where a smaller share of the pixels has a match, those that disagree are taken for wrong, too.
  double bare = 0.4;
  /// A second plane counts when it has this share of the first's matches: gaps get the farther of the two.
  double rival = 0.4;
  unsigned seed = 1;  ///< Of the samples.
};

/// Where a surface has no texture only its rim and a few spots find a match, and wrong ones among them. This
/// fills the gaps of what looks like one even surface (a region whose colour changes little from pixel to
/// pixel) with the plane that most of its matches agree on (RANSAC).
void FillSurfaces(const ByteImage& image, const SurfaceFillOptions& options, float max_disparity,
                  DisparityMap& disparity);

}  // namespace thalweg::stereo
