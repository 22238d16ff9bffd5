#include "common/drawing/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/drawing/lettering.h"

namespace thalweg {
namespace {

constexpr int kZoom = 2;
constexpr int kShift = 4;  // OpenCV takes points in sixteenths of a pixel.

cv::Point Fine(const cv::Point2d& p) {
  constexpr double kScale = kZoom * (1 << kShift);
  return {cvRound(p.x * kScale), cvRound(p.y * kScale)};
}

int Thick(double thickness) {
  return std::max(1, cvRound(thickness * kZoom));
}

cv::Rect Pixels(const Area& area) {
  return {cv::Point(cvRound(area.x * kZoom), cvRound(area.y * kZoom)),
          cv::Point(cvRound(area.right() * kZoom), cvRound(area.bottom() * kZoom))};
}

}  // namespace

Canvas::Canvas(int width_px, int height_px)
    : big_(height_px * kZoom, width_px * kZoom, CV_8UC3, colors::kPaper) {}

void Canvas::Fill(const Area& area, const cv::Scalar& color) {
  cv::rectangle(big_, Pixels(area), color, cv::FILLED);
}

void Canvas::Frame(const Area& area, const cv::Scalar& color, double thickness) {
  cv::rectangle(big_, Pixels(area), color, Thick(thickness));
}

void Canvas::Line(const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& color, double thickness) {
  cv::line(big_, Fine(from), Fine(to), color, Thick(thickness), cv::LINE_AA, kShift);
}

void Canvas::Polyline(const std::vector<cv::Point2d>& points, const cv::Scalar& color, double thickness) {
  std::vector<cv::Point> fine;
  for (const cv::Point2d& p : points) fine.push_back(Fine(p));
  cv::polylines(big_, fine, false, color, Thick(thickness), cv::LINE_AA, kShift);
}

void Canvas::FillBelow(const std::vector<cv::Point2d>& points, double base, const cv::Scalar& color,
                       double opacity) {
  if (points.size() < 2) return;
  std::vector<cv::Point> outline;
  for (const cv::Point2d& p : points) outline.push_back(Fine(p));
  outline.push_back(Fine({points.back().x, base}));
  outline.push_back(Fine({points.front().x, base}));
  cv::Mat over = big_.clone();
  cv::fillPoly(over, std::vector<std::vector<cv::Point>>{outline}, color, cv::LINE_AA, kShift);
  cv::addWeighted(over, opacity, big_, 1.0 - opacity, 0.0, big_);
}

void Canvas::Disc(const cv::Point2d& center, double radius, const cv::Scalar& color) {
  cv::circle(big_, Fine(center), cvRound(radius * kZoom * (1 << kShift)), color, cv::FILLED, cv::LINE_AA,
             kShift);
}

void Canvas::Image(const Area& area, const cv::Mat& image) {
  const cv::Rect place = Pixels(area) & cv::Rect(0, 0, big_.cols, big_.rows);
  if (place.empty()) return;
  cv::resize(image, big_(place), place.size(), 0.0, 0.0, cv::INTER_NEAREST);
}

double Canvas::Swatch(const cv::Point2d& at, const cv::Scalar& color, const std::string& meaning) {
  constexpr double kSide = 13.0;
  constexpr double kText = 10.0;
  constexpr double kGap = 8.0;    // before the text
  constexpr double kNext = 30.0;  // behind it
  const Area square{at.x, at.y - 0.5 * kSide, kSide, kSide};
  Fill(square, color);
  Frame(square, colors::kMuted, 1.0);
  Text(meaning, {square.right() + kGap, at.y + 0.5 * kText}, kText, colors::kInk);
  return square.right() + kGap + TextWidth(meaning, kText) + kNext;
}

double Canvas::TextWidth(const std::string& text, double size, bool strong) {
  return lettering::WidthOf(text, size * kZoom, strong) / kZoom;
}

void Canvas::Text(const std::string& text, const cv::Point2d& at, double size, const cv::Scalar& color,
                  Align align, bool strong) {
  cv::Point2d from = at;
  if (align == Align::kCenter) from.x -= 0.5 * TextWidth(text, size, strong);
  if (align == Align::kRight) from.x -= TextWidth(text, size, strong);
  lettering::Draw(big_, text, from * kZoom, size * kZoom, color, strong);
}

void Canvas::TextUpwards(const std::string& text, const cv::Point2d& at, double size,
                         const cv::Scalar& color) {
  Canvas strip(cvCeil(TextWidth(text, size)) + 8, cvCeil(2.0 * size));
  strip.Text(text, {4.0, 1.5 * size}, size, color);
  cv::Mat turned;
  cv::rotate(strip.big_, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect place(cvRound(at.x * kZoom) - turned.cols / 2, cvRound(at.y * kZoom) - turned.rows / 2,
                       turned.cols, turned.rows);
  if ((place & cv::Rect(0, 0, big_.cols, big_.rows)) != place) return;
  cv::Mat part = big_(place);
  cv::min(part, turned, part);  // dark letters on light paper
}

cv::Mat Canvas::Picture() const {
  cv::Mat picture;
  cv::resize(big_, picture, {}, 1.0 / kZoom, 1.0 / kZoom, cv::INTER_AREA);
  return picture;
}

}  // namespace thalweg
