#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "services/stereo/core/image.h"
#include "services/stereo/core/prefilter.h"
#include "services/stereo/core/surface_fill.h"

namespace thalweg::stereo {

/// Finds, for each pixel of the left image of a rectified pair, the corresponding pixel in the right image.
///
/// Threading: one Match at a time, which may use several threads itself.
class Matcher {
 public:
  virtual ~Matcher() = default;

  /// Matches a pair. Throws std::invalid_argument naming the sizes if the images are empty or differ in size
  /// or type.
  /// @return Disparities in [0, max_disparity) where one was found and passed all checks; none at all if the
  ///   images appear to be swapped.
  DisparityMap Match(const ByteImage& left, const ByteImage& right);

 protected:
  explicit Matcher(int max_disparity) : max_disparity_(max_disparity) {}

 private:
  /// Matches images that have passed the checks.
  virtual DisparityMap Find(const ByteImage& left, const ByteImage& right) = 0;

  int max_disparity_;
};

/// Explains, for people, why hardly anything was matched; empty if enough was.
std::string WhyNoMatches(const DisparityMap& disparity, const ByteImage& left, const ByteImage& right,
                         int max_disparity);
/// Share of pixels with a match.
double Density(const DisparityMap& disparity);

/// Equation numbers (n) refer to the thesis cited in the README. For engine sad5-thesis some are fixed:
/// AsTheThesisPrints.
struct Sad5Options {
  PrefilterOptions prefilter;
  int window = 11;            ///< [px] Odd, 7 to 21: edge of each of the five windows.
  int max_difference = 8;     ///< [filtered values] Larger differences are truncated to this; 1 to 255.
  double uniqueness = 0.015;  ///< Smallest accepted C_d = (C2 - C1) / C1, Eq. (3.29).
  int left_right = 2;         ///< [px] Largest accepted difference between left and right; < 0: no check.
  bool subpixel = true;
  int speckle_pixels = 60;       ///< Smaller regions of similar disparity are removed; 0: none.
  double speckle_step = 1.5;     ///< [px] Largest difference between neighbors in one region.
  bool corners_connect = false;  ///< Whether pixels that share only a corner are neighbors in a region.
};

/// Penalties are in units of the matching cost of one pixel.
struct SemiGlobalOptions {
  int census_weight = 3;          ///< Cost of each of the 62 bits that differs, in quarters.
  int max_difference = 20;        ///< [gray values] Larger differences are truncated to this.
  int slope_penalty = 30;         ///< For a disparity step by 1 px between neighbors.
  int jump_penalty = 90;          ///< For a larger step.
  int jump_penalty_at_edge = 40;  ///< For a larger step where the image has an edge.
  int edge = 12;                  ///< [gray values] Larger differences between neighbors are edges.
  double uniqueness = 0.0;        ///< This and the following as for SAD5.
  int left_right = 1;
  int speckle_pixels = Sad5Options{}.speckle_pixels;
  double speckle_step = 1.0;
  bool fill_surfaces = true;
  SurfaceFillOptions surfaces;
};

/// The usual ones, except for what is here.
struct OpenCvOptions {
  int block_window = 11;       ///< [px] Edge of the window of opencv-bm, odd.
  int semi_global_window = 5;  ///< [px] The same of opencv-sgbm.
};

struct MatcherOptions {
  int max_disparity = 64;  ///< [px] Disparities below it are searched; 1 to 256.
  int threads = 0;         ///< 0 = one per core.
  Sad5Options sad5;
  SemiGlobalOptions best;
  OpenCvOptions opencv;
};

/// The default engine.
inline constexpr auto kBestEngine = "best";

/// The engines that MakeMatcher accepts: sad5-dog, sad5-log, sad5-bilateral, sad5-none, sad5-thesis,
/// opencv-bm, opencv-sgbm, best.
std::span<const std::string_view> EngineNames();

/// Throws std::invalid_argument naming the bad option, or an unknown engine and the valid ones.
std::unique_ptr<Matcher> MakeMatcher(std::string_view engine, const MatcherOptions& options);

/// Throws as described for Match.
void CheckPair(const ByteImage& left, const ByteImage& right);

}  // namespace thalweg::stereo
