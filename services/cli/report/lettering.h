#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace thalweg::cli {

/// Antialiased text in pictures: DejaVu Sans, drawn by FreeType.
///
/// Text is UTF-8, so that m² and ° are letters like others; a letter that the font lacks is drawn as a box.
/// Threading: each thread has fonts of its own.
/// Errors: std::runtime_error naming the font that cannot be read, and the package that holds it.
namespace lettering {

/// [px] @param capital  [px] Height of a capital.
double WidthOf(const std::string& text, double capital, bool strong);

/// @param picture  8 bit, 3 channels. @param at  [px] Left end of the baseline. What lies outside of the
/// picture is left out.
void Draw(cv::Mat& picture, const std::string& text, const cv::Point2d& at, double capital,
          const cv::Scalar& color, bool strong);

}  // namespace lettering
}  // namespace thalweg::cli
