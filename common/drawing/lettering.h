#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace thalweg {

/// Antialiased text in pictures: DejaVu Sans, rendered by FreeType.
///
/// Text is UTF-8, so that m² and ° are ordinary letters; a letter that the font lacks is drawn as a box.
/// Threading: each thread uses fonts of its own.
/// Errors: std::runtime_error naming the font that cannot be read and the package that contains it.
namespace lettering {

/// [px] Width of the text.
/// @param capital  [px] Height of a capital letter.
double WidthOf(const std::string& text, double capital, bool strong);

/// Draws text; parts outside the picture are clipped.
/// @param picture  8 bit, 3 channels.
/// @param at       [px] Left end of the baseline.
void Draw(cv::Mat& picture, const std::string& text, const cv::Point2d& at, double capital,
          const cv::Scalar& color, bool strong);

}  // namespace lettering
}  // namespace thalweg
