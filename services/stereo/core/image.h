#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace thalweg::stereo {

/// An image: rows from the top, without padding, channels interleaved.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, int channels = 1, T value = T{})
      : width_(width),
        height_(height),
        channels_(channels),
        data_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                  static_cast<std::size_t>(channels),
              value) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  bool empty() const { return data_.empty(); }
  bool SameSizeAs(const auto& other) const { return width_ == other.width() && height_ == other.height(); }

  T* Row(int v) { return data_.data() + RowStart(v); }
  const T* Row(int v) const { return data_.data() + RowStart(v); }
  T& operator()(int u, int v) { return Row(v)[u * channels_]; }
  const T& operator()(int u, int v) const { return Row(v)[u * channels_]; }
  std::vector<T>& data() { return data_; }
  const std::vector<T>& data() const { return data_; }

  bool operator==(const Image&) const = default;

 private:
  std::size_t RowStart(int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) *
           static_cast<std::size_t>(channels_);
  }

  int width_ = 0;
  int height_ = 0;
  int channels_ = 1;
  std::vector<T> data_;
};

/// 1 channel = gray, 3 = red, green, blue.
using ByteImage = Image<std::uint8_t>;

/// Disparity d [px] of each pixel of the left image: the left pixel (u, v) shows what the right image shows
/// at (u - d, v). NaN = none.
using DisparityMap = Image<float>;
inline constexpr float kNoDisparity = std::numeric_limits<float>::quiet_NaN();

/// Converts to luma according to BT.601; returns a gray image unchanged.
ByteImage ToGray(const ByteImage& image);

}  // namespace thalweg::stereo
