#pragma once

#include <memory>

#include "services/stereo/core/kernels.h"
#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {

/// Semi-global matching [Hirschmüller: Stereo Processing by Semiglobal Matching and Mutual Information, TPAMI
/// 30(2), 2008] along eight paths, with 8-bit path costs.
///
/// The matching cost is the Hamming distance of the census transform [Zabih & Woodfill, 1994] in a 9 x 7
/// window plus a truncated difference of gray values, as in AD-Census [Mei et al., 2011]. A disparity jump
/// costs less across an image edge. The disparities of the right view come from the same sums. Finally,
/// surfaces without texture are filled, see surface_fill.h.
class SemiGlobal : public Matcher {
 public:
  /// Throws std::invalid_argument naming the bad option.
  explicit SemiGlobal(const MatcherOptions& options);

 private:
  DisparityMap Find(const ByteImage& left, const ByteImage& right) override;

  template <class T>
  struct Buffer {
    std::unique_ptr<T[]> data;  // NOLINT(modernize-avoid-c-arrays): not set to 0, for it is large
    std::size_t size = 0;
    T* Get(std::size_t count) {
      if (size < count) {
        data = std::make_unique_for_overwrite<T[]>(count);  // NOLINT(modernize-avoid-c-arrays)
        size = count;
      }
      return data.get();
    }
  };

  void ComputeCosts(const ByteImage& left, const ByteImage& right, std::uint8_t* costs) const;
  /// One pass over the image, downward or upward, along four of the paths.
  void Aggregate(const ByteImage& image, const std::uint8_t* costs, bool downward, bool add,
                 std::uint16_t* sums) const;
  DisparityMap Choose(int width, int height, std::uint16_t* sums, const std::uint16_t* more) const;

  MatcherOptions options_;
  std::size_t stride_;
  Buffer<std::uint8_t> costs_;  ///< [row][column][d]
  Buffer<std::uint16_t> sums_;  ///< The same.
  Buffer<std::uint16_t> more_sums_;
};

}  // namespace thalweg::stereo
