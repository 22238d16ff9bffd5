#include "services/stereo/core/census.h"

#include <algorithm>
#include <array>

#include "common/base/parallel.h"
#include "services/stereo/core/kernels.h"

namespace thalweg::stereo {
namespace {

constexpr int kColumns = 4;  // on either side
constexpr int kRows = 3;     // above and below
constexpr int kCensusBand = 8;
constexpr int kTriedRows = 24;
constexpr double kClearlyLess = 0.85;
constexpr std::uint8_t kOneABit = 4;  // a weight of match_cost that counts each differing bit as 1

/// The rows of an image, padded on both sides by the reach of the census.
class Padded {
 public:
  explicit Padded(const ByteImage& image) : image_(image) {}

  std::vector<std::uint8_t> Row(int v) const {
    const int width = image_.width();
    const std::uint8_t* const from = image_.Row(std::clamp(v, 0, image_.height() - 1));
    std::vector<std::uint8_t> to(static_cast<std::size_t>(width + 2 * kColumns + kLanes), from[width - 1]);
    std::fill_n(to.begin(), kColumns, from[0]);
    std::copy_n(from, width, to.begin() + kColumns);
    return to;
  }

 private:
  const ByteImage& image_;
};

/// Calls take(v, bits) for each of the rows [begin, end).
template <class Take>
void CensusOfRows(const ByteImage& image, int begin, int end, Take&& take) {
  const Padded padded(image);
  std::array<std::vector<std::uint8_t>, 2 * kRows + 1> rows;
  for (int i = 0; i < 2 * kRows; ++i) rows[static_cast<std::size_t>(i + 1)] = padded.Row(begin - kRows + i);
  for (int v = begin; v < end; ++v) {
    std::rotate(rows.begin(), rows.begin() + 1, rows.end());
    rows.back() = padded.Row(v + kRows);
    std::array<const std::uint8_t*, 2 * kRows + 1> pointers{};
    for (std::size_t i = 0; i < rows.size(); ++i) pointers[i] = rows[i].data() + kColumns;
    take(v, pointers.data());
  }
}

std::vector<std::uint64_t> CensusOfRow(const ByteImage& image, int v) {
  std::vector<std::uint64_t> bits(static_cast<std::size_t>(image.width()));
  CensusOfRows(image, v, v + 1, [&](int, const std::uint8_t* const* rows) {
    BestKernels().census(rows, image.width(), bits.data());
  });
  return bits;
}

/// Sum, over a row, of the smallest Hamming distance between a pixel and those of the other row at
/// disparities below `max_disparity`.
double FewestBits(const std::vector<std::uint64_t>& row, const std::vector<std::uint64_t>& other,
                  const std::vector<std::uint8_t>& gray, int max_disparity) {
  const std::size_t width = row.size();
  const auto stride = static_cast<std::size_t>(StrideFor(max_disparity));
  const auto backwards = Backwards(other.data(), width, stride);
  std::vector<std::uint8_t> costs(width * stride);
  BestKernels().match_cost(row.data(), backwards.data() + width - 1, gray.data(), gray.data() + width - 1,
                           static_cast<int>(width), static_cast<int>(stride), kOneABit, 0, costs.data());
  double sum = 0.0;
  for (std::size_t u = 0; u < width; ++u) {
    const auto begin = costs.begin() + static_cast<std::ptrdiff_t>(u * stride);
    const auto candidates =
        static_cast<std::ptrdiff_t>(std::min(u + 1, static_cast<std::size_t>(max_disparity)));
    sum += *std::min_element(begin, begin + candidates);
  }
  return sum;
}

}  // namespace

Image<std::uint64_t> CensusOf(const ByteImage& image, std::size_t threads) {
  Image<std::uint64_t> census(image.width(), image.height());
  const int bands = (image.height() + kCensusBand - 1) / kCensusBand;
  ParallelFor(
      static_cast<std::size_t>(bands), 1,
      [&](std::size_t band) {
        const int begin = static_cast<int>(band) * kCensusBand;
        CensusOfRows(image, begin, std::min(begin + kCensusBand, image.height()),
                     [&](int v, const std::uint8_t* const* rows) {
                       BestKernels().census(rows, image.width(), census.Row(v));
                     });
      },
      threads);
  return census;
}

bool LookSwapped(const ByteImage& left, const ByteImage& right, int max_disparity) {
  const std::vector<std::uint8_t> gray(static_cast<std::size_t>(2 * left.width() + StrideFor(max_disparity)));
  double as_given = 0.0;
  double swapped = 0.0;
  const int rows = std::min(left.height(), kTriedRows);
  for (int i = 0; i < rows; ++i) {
    const int v = static_cast<int>((2L * i + 1) * left.height() / (2L * rows));
    const auto left_bits = CensusOfRow(left, v);
    const auto right_bits = CensusOfRow(right, v);
    as_given += FewestBits(left_bits, right_bits, gray, max_disparity);
    // With the images exchanged, the right camera takes the place of the left one.
    swapped += FewestBits(right_bits, left_bits, gray, max_disparity);
  }
  return swapped < kClearlyLess * as_given;
}

}  // namespace thalweg::stereo
