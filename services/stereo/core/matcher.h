#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "services/stereo/core/image.h"
#include "services/stereo/core/prefilter.h"
#include "services/stereo/core/surface_fill.h"

namespace thalweg::stereo {

/// Finds what each pixel of the left image corresponds to in the right one of a rectified pair.
/// Threading: one Match at a time; it may use several threads by itself.
class Matcher {
 public:
  virtual ~Matcher() = default;

  /// @return Disparities in [0, max_disparity) where one was found and passed all checks. None at all where
  /// the two look swapped. Throws std::invalid_argument, naming the sizes, when the images differ in size or
  /// kind or are empty.
  DisparityMap Match(const ByteImage& left, const ByteImage& right);

 protected:
  explicit Matcher(int max_disparity) : max_disparity_(max_disparity) {}

 private:
  /// The images have passed the checks.
  virtual DisparityMap Find(const ByteImage& left, const ByteImage& right) = 0;

  int max_disparity_;
};

/// What may be the matter when (next to) nothing was matched, for people; empty where enough was.
std::string WhyNoMatches(const DisparityMap& disparity, const ByteImage& left, const ByteImage& right,
                         int max_disparity);
/// Share of the pixels with a match.
double Density(const DisparityMap& disparity);

/// Eq. (n) are those of the thesis that the README names.
struct Sad5Options {
  PrefilterOptions prefilter;
  int window = 11;            ///< [px] Odd, 7 to 21: side of each of the five windows.
  int max_difference = 8;     ///< [filtered values] Larger ones count as this; 1 to 255.
  double uniqueness = 0.015;  ///< Least C_d = (C2 - C1) / C1, Eq. (3.29).
  int left_right = 2;         ///< [px] Most by which left and right may differ; < 0: no check.
  bool subpixel = true;
  int speckle_pixels = 60;    ///< Smaller regions of similar disparity are removed; 0: none.
  double speckle_step = 1.5;  ///< [px] Between neighbours of one region.
};

/// Penalties are in units of the matching cost of one pixel.
struct SemiGlobalOptions {
  int census_weight = 3;          ///< Of each differing bit of 62, in quarters.
  int max_difference = 20;        ///< [grey values] Larger ones count as this.
  int slope_penalty = 30;         ///< Of a step by 1 px between neighbours.
  int jump_penalty = 90;          ///< Of a larger one.
  int jump_penalty_at_edge = 40;  ///< The same where the image has an edge.
  int edge = 12;                  ///< [grey values] Neighbours that differ by more.
  double uniqueness = 0.0;        ///< These as for SAD5.
  int left_right = 1;
  int speckle_pixels = 60;
  double speckle_step = 1.0;
  bool fill_surfaces = true;
  SurfaceFillOptions surfaces;
};

struct MatcherOptions {
  int max_disparity = 64;  ///< [px] Disparities below it are searched; 1 to 256.
  int threads = 0;         ///< 0 = one a core.
  Sad5Options sad5;
  SemiGlobalOptions best;
};

/// The engine of whoever does not choose one.
inline constexpr auto kBestEngine = "best";

/// What MakeMatcher knows: sad5-dog, sad5-log, sad5-bilateral, sad5-none, opencv-bm, opencv-sgbm, best.
std::span<const std::string_view> EngineNames();

/// Throws std::invalid_argument naming an unknown engine (and those there are) or the bad option.
std::unique_ptr<Matcher> MakeMatcher(std::string_view engine, const MatcherOptions& options);

/// Throws as Match says.
void CheckPair(const ByteImage& left, const ByteImage& right);

}  // namespace thalweg::stereo
