#pragma once

#include <functional>

#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {

/// Sum of absolute differences over five windows: the score of a pixel and a disparity is that of the window
/// around the pixel plus the best two of the four equal windows around its corners, Eq. (3.27), (3.28), after
/// Hirschmüller, Innocent, Garibaldi, Real-Time Correlation-Based Stereo Vision with Reduced Border Errors,
/// IJCV 47, 2002. Running sums make the cost of a score independent of the window's size.
///
/// Beyond its border an image goes on with its border pixels.
class Sad5 : public Matcher {
 public:
  /// Throws std::invalid_argument naming the bad option.
  explicit Sad5(const MatcherOptions& options);

  /// Scores of the pixels of rows [begin, end) of prefiltered images, row by row: [column][d] with `stride`
  /// numbers a column. The row may be written to. Candidates that fall out of the right image have a score,
  /// too.
  using RowOfScores = std::function<void(int v, std::uint16_t* scores)>;
  void ScoreRows(const ByteImage& left, const ByteImage& right, int begin, int end,
                 const RowOfScores& take) const;

  int stride() const { return stride_; }
  int cut() const { return cut_; }  ///< max_difference, or what 16 bits allow.

 private:
  DisparityMap Find(const ByteImage& left, const ByteImage& right) override;

  MatcherOptions options_;
  int stride_;
  int cut_;
};

}  // namespace thalweg::stereo
