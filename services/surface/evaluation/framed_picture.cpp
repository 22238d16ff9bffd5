#include "services/surface/evaluation/framed_picture.h"

#include "common/drawing/canvas.h"

namespace thalweg::surface {
namespace {

constexpr int kAbove = 44;  // [px]
constexpr int kBelow = 40;  // [px]
constexpr double kLeft = 16.0;
constexpr double kTitle = 12.0;  // [px] Height of a capital letter.

}  // namespace

cv::Mat Framed(const cv::Mat& picture, const std::string& title, const std::vector<Meaning>& legend) {
  Canvas canvas(picture.cols, picture.rows + kAbove + kBelow);
  canvas.Text(title, {kLeft, 0.5 * (kAbove + kTitle)}, kTitle, colors::kInk, Align::kLeft, true);
  canvas.Image({0.0, kAbove, static_cast<double>(picture.cols), static_cast<double>(picture.rows)}, picture);
  double x = kLeft;
  for (const auto& [color, text] : legend) {
    x = canvas.Swatch({x, kAbove + picture.rows + 0.5 * kBelow}, cv::Scalar(color.b, color.g, color.r), text);
  }
  return canvas.Picture();
}

}  // namespace thalweg::surface
