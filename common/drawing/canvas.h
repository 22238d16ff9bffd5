#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace thalweg {

/// Colors of pages, as OpenCV orders them (blue, green, red).
namespace colors {
inline const cv::Scalar kPaper{255, 255, 255};
inline const cv::Scalar kPanel{246, 244, 242};
inline const cv::Scalar kInk{52, 42, 34};
inline const cv::Scalar kMuted{138, 126, 116};
inline const cv::Scalar kRule{226, 221, 216};
inline const cv::Scalar kAccent{148, 98, 24};
inline const cv::Scalar kGood{92, 138, 46};
inline const cv::Scalar kBad{48, 48, 196};
}  // namespace colors

/// A rectangle of the page, in its pixels.
struct Area {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

enum class Align { kLeft, kCenter, kRight };

/// A page to draw on, in pixels from its top left corner. Drawn at twice the size and finally scaled down, so
/// that lines and letters are smooth.
class Canvas {
 public:
  Canvas(int width_px, int height_px);

  void Fill(const Area& area, const cv::Scalar& color);
  void Frame(const Area& area, const cv::Scalar& color, double thickness);
  void Line(const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& color, double thickness);
  void Polyline(const std::vector<cv::Point2d>& points, const cv::Scalar& color, double thickness);
  /// Fills the area between the points and the horizontal line at `base`, blended with what is there.
  void FillBelow(const std::vector<cv::Point2d>& points, double base, const cv::Scalar& color,
                 double opacity);
  void Disc(const cv::Point2d& center, double radius, const cv::Scalar& color);
  /// Draws an image stretched over the area, with nearest-neighbor interpolation.
  /// @param image  8 bit, 3 channels.
  void Image(const Area& area, const cv::Mat& image);

  /// @param text  UTF-8.
  /// @param at    Left, center or right end of the baseline, depending on `align`.
  /// @param size  Height of a capital letter.
  void Text(const std::string& text, const cv::Point2d& at, double size, const cv::Scalar& color,
            Align align = Align::kLeft, bool strong = false);
  /// Reads from bottom to top, centered at `at`.
  void TextUpwards(const std::string& text, const cv::Point2d& at, double size, const cv::Scalar& color);
  /// A square of a color with its meaning to the right, for a legend.
  /// @param at  Middle of its left side.
  /// @return    x where the next may begin.
  double Swatch(const cv::Point2d& at, const cv::Scalar& color, const std::string& meaning);
  static double TextWidth(const std::string& text, double size, bool strong = false);

  cv::Mat Picture() const;

 private:
  cv::Mat big_;
};

}  // namespace thalweg
