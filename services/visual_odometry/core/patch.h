#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace thalweg::visual_odometry {

/// Grey images of half the size each, level 0 first. Pixel (u, v) of level n lies at (u, v) * 2^n of level 0,
/// as cv::pyrDown puts it.
using Pyramid = std::vector<cv::Mat>;

/// @param image  CV_8UC1. Level 0 is smoothed a little, so that interpolation does no harm.
Pyramid MakePyramid(const cv::Mat& image, int levels);

/// The image minus its surroundings, around 128 [CV_8UC1]: for comparisons that light shall not disturb.
cv::Mat WithoutLight(const cv::Mat& image);

/// What a point looks like, ready to be found in another image.
///
/// Inverse-compositional alignment [Baker, Matthews, Lucas-Kanade 20 Years On, IJCV 56, 2004] of the position
/// alone; brightness may change by an offset and contrast by a factor.
class Patch {
 public:
  static constexpr int kRadius = 4;
  static constexpr int kSize = 2 * kRadius + 1;
  static constexpr int kPixels = kSize * kSize;

  /// Cuts the patch out of `image` as the other image will show it.
  /// @param to_image  Offsets in the other image to offsets in this one.
  /// @return  Nothing when it reaches beyond the image or shows no texture in two directions.
  static std::optional<Patch> Cut(const cv::Mat& image, const Eigen::Vector2f& center,
                                  const Eigen::Matrix2f& to_image);

  struct Match {
    Eigen::Vector2f position;  ///< [px]
    float correlation = 0.0F;  ///< Normalised, -1 to 1.
  };
  /// Walks from `start` to where the image shows the patch.
  /// @return  Nothing when it leaves the image, or goes further than `reach` [px], or does not settle.
  std::optional<Match> Find(const cv::Mat& image, const Eigen::Vector2f& start, float reach) const;
  /// The same along the row only.
  std::optional<Match> FindAlongRow(const cv::Mat& image, const Eigen::Vector2f& start, float reach) const;

 private:
  template <bool kAlongRow>
  std::optional<Match> Walk(const cv::Mat& image, const Eigen::Vector2f& start, float reach) const;

  /// Takes out of a gradient what an offset of brightness or a factor of contrast would explain as well.
  void Orthogonalise(std::array<float, kPixels>& gradient) const;

  std::array<float, kPixels> value_;       ///< Minus their mean.
  std::array<float, kPixels> gradient_u_;  ///< Orthogonal to a constant and to value_, as the next one.
  std::array<float, kPixels> gradient_v_;
  Eigen::Matrix2f information_;  ///< Sum of the gradients' outer products.
  float energy_ = 0.0F;          ///< Sum of value_ squared.
};

/// 8 x 8 pixels compared by the sum of absolute differences (SAD), whole pixels, on images WithoutLight.
class SearchPatch {
 public:
  static constexpr int kSize = 8;

  static std::optional<SearchPatch> Cut(const cv::Mat& image, const Eigen::Vector2f& center,
                                        const Eigen::Matrix2f& to_image);

  struct Match {
    Eigen::Vector2f position;  ///< [px] to a fraction, by a parabola through the neighbours.
    int difference = 0;        ///< SAD of the best.
    int rival = 0;             ///< SAD of the best that is not its neighbour.
  };
  /// The best place within the rectangle of centres; nothing when no patch fits the image there.
  std::optional<Match> Search(const cv::Mat& image, const cv::Rect& centers) const;

 private:
  alignas(16) std::array<std::uint8_t, kSize * kSize> value_;
};

}  // namespace thalweg::visual_odometry
