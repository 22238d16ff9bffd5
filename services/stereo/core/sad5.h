#pragma once

#include <functional>

#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {

/// Sum of absolute differences over five windows: the score of a pixel and a disparity is that of the window
/// around the pixel plus the best two of four equal windows centered on its corners, Eq. (3.27), (3.28),
/// after [Hirschmüller, Innocent, Garibaldi: Real-Time Correlation-Based Stereo Vision with Reduced Border
/// Errors, IJCV 47, 2002]. Running sums make the cost of a score independent of the window's size.
///
/// Outside the image, the border pixels are repeated.
class Sad5 : public Matcher {
 public:
  /// Throws std::invalid_argument naming the bad option.
  explicit Sad5(const MatcherOptions& options);

  /// Computes the scores of rows [begin, end) of prefiltered images and passes them to `take` row by row, as
  /// [column][d] with `stride` values per column. `take` may overwrite the row. Candidates outside the right
  /// image have scores, too.
  using RowOfScores = std::function<void(int v, std::uint16_t* scores)>;
  void ScoreRows(const ByteImage& left, const ByteImage& right, int begin, int end,
                 const RowOfScores& take) const;

  int stride() const { return stride_; }
  int cut() const { return cut_; }  ///< max_difference, or the largest cut for which scores fit in 16 bits.

 private:
  DisparityMap Find(const ByteImage& left, const ByteImage& right) override;

  MatcherOptions options_;
  int stride_;
  int cut_;
};

}  // namespace thalweg::stereo
