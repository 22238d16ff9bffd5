#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace thalweg::visual_odometry {

/// Grayscale images, each half the size of the one before, level 0 first. Pixel (u, v) of level n lies at (u,
/// v) * 2^n of level 0, as in cv::pyrDown.
using Pyramid = std::vector<cv::Mat>;

/// @param image  CV_8UC1. Level 0 is smoothed slightly, so that interpolation does little harm.
Pyramid MakePyramid(const cv::Mat& image, int levels);

/// The image minus its local mean, offset by 128 [CV_8UC1], for comparisons that are insensitive to lighting.
cv::Mat WithoutLight(const cv::Mat& image);

/// The appearance of a point, prepared for finding it in another image.
///
/// Inverse-compositional alignment [Baker, Matthews, Lucas-Kanade 20 Years On, IJCV 56, 2004] of the position
/// only; brightness may change by an offset and contrast by a factor.
class Patch {
 public:
  static constexpr int kRadius = 4;
  static constexpr int kSize = 2 * kRadius + 1;
  static constexpr int kPixels = kSize * kSize;

  /// Cuts the patch out of `image`, warped to how the other image will show it.
  /// @param to_image  Maps offsets in the other image to offsets in this one.
  /// @return Nothing if the patch extends beyond the image or lacks texture in one direction.
  static std::optional<Patch> Cut(const cv::Mat& image, const Eigen::Vector2f& center,
                                  const Eigen::Matrix2f& to_image);

  struct Match {
    Eigen::Vector2f position;  ///< [px]
    float correlation = 0.0F;  ///< Normalized, -1 to 1.
  };
  /// Aligns the patch iteratively, beginning at `start`.
  /// @return Nothing if it leaves the image, moves farther than `reach` [px] or does not converge.
  std::optional<Match> Find(const cv::Mat& image, const Eigen::Vector2f& start, float reach) const;
  /// As Find, but moves along the row only.
  std::optional<Match> FindAlongRow(const cv::Mat& image, const Eigen::Vector2f& start, float reach) const;

 private:
  template <bool kAlongRow>
  std::optional<Match> Walk(const cv::Mat& image, const Eigen::Vector2f& start, float reach) const;

  /// Removes from a gradient the part that a brightness offset or contrast factor would explain equally well.
  void Orthogonalise(std::array<float, kPixels>& gradient) const;

  std::array<float, kPixels> value_;       ///< Gray values minus their mean.
  std::array<float, kPixels> gradient_u_;  ///< Orthogonal to a constant and to value_; likewise gradient_v_.
  std::array<float, kPixels> gradient_v_;
  Eigen::Matrix2f information_;  ///< Sum of the outer products of the gradients.
  float energy_ = 0.0F;          ///< Sum of squares of value_.
};

/// A patch of 8 x 8 pixels, compared by the sum of absolute differences (SAD) at whole pixels, on images
/// WithoutLight.
class SearchPatch {
 public:
  static constexpr int kSize = 8;

  static std::optional<SearchPatch> Cut(const cv::Mat& image, const Eigen::Vector2f& center,
                                        const Eigen::Matrix2f& to_image);

  struct Match {
    Eigen::Vector2f position;  ///< [px] With subpixel accuracy, by a parabola through the neighboring SADs.
    int difference = 0;        ///< SAD of the best position.
    int rival = 0;             ///< SAD of the best position that is not close to it.
  };
  /// Finds the best position among the given patch centers; nothing if the patch fits the image at none of
  /// them.
  std::optional<Match> Search(const cv::Mat& image, const cv::Rect& centers) const;

 private:
  alignas(16) std::array<std::uint8_t, kSize * kSize> value_;
};

}  // namespace thalweg::visual_odometry
