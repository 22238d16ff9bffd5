#include "services/stereo/core/sad5.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/base/require.h"
#include "services/stereo/core/checks.h"

namespace thalweg::stereo {
namespace {

constexpr int kWindows = 3;  // added up in a score
constexpr int kSad5Band = 48;

/// Copies a row with `before` copies of its first pixel and `after` of its last.
void PadRow(const std::uint8_t* row, int width, int before, int after, std::uint8_t* out) {
  std::fill_n(out, before, row[0]);
  std::copy_n(row, width, out + before);
  std::fill_n(out + before + width, after, row[width - 1]);
}

/// The rows of a pair, padded, the right one reversed as the kernels read it.
class PaddedRows {
 public:
  PaddedRows(int width, int border, int stride)
      : width_(width),
        border_(border),
        stride_(stride),
        left_(static_cast<std::size_t>(width + 2 * border)),
        right_(static_cast<std::size_t>(width + 2 * border + stride)) {}

  void Take(const std::uint8_t* left, const std::uint8_t* right) {
    PadRow(left, width_, border_, border_, left_.data());
    PadRow(right, width_, border_ + stride_, border_, right_.data());
    std::reverse(right_.begin(), right_.end());
  }
  const std::uint8_t* left() const { return left_.data(); }
  /// Pointer to index by d minus the padded column.
  const std::uint8_t* right() const { return right_.data() + (width_ + 2 * border_ - 1); }

 private:
  int width_, border_, stride_;
  std::vector<std::uint8_t> left_;
  std::vector<std::uint8_t> right_;
};

}  // namespace

Sad5::Sad5(const MatcherOptions& options)
    : Matcher(options.max_disparity), options_(options), stride_(StrideFor(options.max_disparity)) {
  const Sad5Options& sad5 = options.sad5;
  Require(sad5.window >= 7 && sad5.window <= 21 && sad5.window % 2 == 1,
          "window is " + std::to_string(sad5.window) + ", must be odd and from 7 to 21");
  Require(sad5.max_difference >= 1 && sad5.max_difference <= 255,
          "max_difference is " + std::to_string(sad5.max_difference) + ", must be 1 to 255");
  cut_ = std::min(sad5.max_difference, (kNever - 1) / (kWindows * sad5.window * sad5.window));
}

void Sad5::ScoreRows(const ByteImage& left, const ByteImage& right, int begin, int end,
                     const RowOfScores& take) const {
  const Kernels& kernels = BestKernels();
  const int width = left.width();
  const int radius = options_.sad5.window / 2;
  const int window = options_.sad5.window;
  const int sum_columns = width + 4 * radius;     // from -2 radius
  const int window_columns = width + 2 * radius;  // from -radius
  const auto stride = static_cast<std::size_t>(stride_);
  std::vector<std::uint16_t> sums(stride * static_cast<std::size_t>(sum_columns), 0);
  std::vector<std::uint16_t> scores(stride * static_cast<std::size_t>(width));
  // Window sums of the last 2 radius + 1 rows; row v is stored at v mod window.
  std::vector<std::vector<std::uint16_t>> windows(
      static_cast<std::size_t>(window),
      std::vector<std::uint16_t>(stride * static_cast<std::size_t>(window_columns)));
  std::vector<PaddedRows> rows(static_cast<std::size_t>(window) + 1, PaddedRows(width, 2 * radius, stride_));
  const auto at = [](auto& ring, int v) -> auto& {
    return ring[static_cast<std::size_t>(v + 4 * static_cast<int>(ring.size())) % ring.size()];
  };
  const int first = begin - 2 * radius;
  for (int v = first; v < end + 2 * radius; ++v) {
    PaddedRows& in = at(rows, v);
    const int source = std::clamp(v, 0, left.height() - 1);
    in.Take(left.Row(source), right.Row(source));
    const PaddedRows* const out = v - window >= first ? &at(rows, v - window) : nullptr;
    kernels.add_differences(in.left(), in.right(), out == nullptr ? nullptr : out->left(),
                            out == nullptr ? nullptr : out->right(), sum_columns, stride_,
                            static_cast<std::uint8_t>(cut_), sums.data());
    const int middle = v - radius;  // center row of the windows that are now complete
    if (middle < begin - radius) continue;
    kernels.sum_windows(sums.data(), window_columns, window, stride_, at(windows, middle).data());
    const int row = middle - radius;
    if (row < begin) continue;
    kernels.add_supports(at(windows, row - radius).data(), at(windows, row).data(),
                         at(windows, row + radius).data(), width, radius, stride_, scores.data());
    take(row, scores.data());
  }
}

DisparityMap Sad5::Find(const ByteImage& left, const ByteImage& right) {
  const Sad5Options& sad5 = options_.sad5;
  ByteImage filtered[2];
  ParallelFor(
      2, 1, [&](std::size_t i) { filtered[i] = Filter(ToGray(i == 0 ? left : right), sad5.prefilter); },
      static_cast<std::size_t>(options_.threads));
  const int width = left.width();
  DisparityMap disparity(width, left.height());
  const RowChecks checks{sad5.uniqueness, sad5.left_right, sad5.subpixel};
  const auto count = static_cast<std::size_t>(width);
  const std::size_t with_padding = count + static_cast<std::size_t>(stride_);
  const auto rows = [&](int begin, int end) {
    std::vector<Choice> choices(count);
    std::vector<std::uint16_t> right_cost(with_padding);
    std::vector<std::uint16_t> right_d(with_padding);
    const RightBest best{right_cost.data(), right_d.data()};
    ScoreRows(filtered[0], filtered[1], begin, end, [&](int v, std::uint16_t* scores) {
      BestKernels().choose(scores, width, options_.max_disparity, stride_, choices.data(), best);
      CheckRow(checks, choices, best, disparity.Row(v));
    });
  };
  // Each band has start-up work of its own, so bands are few and large; a single thread takes all rows as
  // one.
  const int bands = options_.threads == 1 ? 1 : (left.height() + kSad5Band - 1) / kSad5Band;
  ParallelFor(
      static_cast<std::size_t>(bands), 1,
      [&](std::size_t band) {
        const int i = static_cast<int>(band);
        rows(left.height() * i / bands, left.height() * (i + 1) / bands);
      },
      static_cast<std::size_t>(options_.threads));
  RemoveSmallRegions(disparity, sad5.speckle_pixels, static_cast<float>(sad5.speckle_step),
                     sad5.corners_connect ? Connectivity::kEight : Connectivity::kFour);
  return disparity;
}

}  // namespace thalweg::stereo
