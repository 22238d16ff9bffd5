#include "services/stereo/evaluation/chessboard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>

#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;

constexpr int kFewest = 3;  // corners along a side; OpenCV finds no smaller boards
constexpr int kMost = 100;

/// Places the images side by side with a line every few rows, on which corresponding points must lie in both.
ByteImage WithScanLines(const ByteImage& left, const ByteImage& right) {
  constexpr int kSpacing = 24;
  ByteImage out(2 * left.width(), left.height(), 3);
  for (int v = 0; v < left.height(); ++v) {
    for (int u = 0; u < out.width(); ++u) {
      const std::uint8_t gray = u < left.width() ? left(u, v) : right(u - left.width(), v);
      std::uint8_t* const pixel = &out(u, v);
      std::fill_n(pixel, 3, gray);
      if (v % kSpacing == kSpacing / 2) pixel[1] = 255;
    }
  }
  return out;
}

}  // namespace

std::string ToText(const Board& board) {
  return fmt::format("{}x{}", board.columns, board.rows);
}

Board BoardFrom(const std::string& text, double square) {
  Board board;
  board.square = square;
  if (!std::isfinite(square) || square <= 0.0) {
    throw std::runtime_error(fmt::format("--square-m is {:g}, must be a number > 0", square));
  }
  const char* const end = text.data() + text.size();
  const auto columns = std::from_chars(text.data(), end, board.columns);
  const bool has_x = columns.ec == std::errc() && columns.ptr != end && *columns.ptr == 'x';
  const auto rows = has_x ? std::from_chars(columns.ptr + 1, end, board.rows) : columns;
  if (!has_x || rows.ec != std::errc() || rows.ptr != end || board.columns < kFewest ||
      board.rows < kFewest || board.columns > kMost || board.rows > kMost) {
    throw std::runtime_error("--board is \"" + text +
                             "\", must be COLUMNSxROWS of inner corners, 3x3 to 100x100");
  }
  return board;
}

std::vector<PicturePair> PicturePairsIn(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw std::runtime_error(folder.string() + ": is not a folder");
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.insert(entry.path());
  std::vector<PicturePair> pairs;
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    if (!name.starts_with("left")) continue;
    const fs::path right = folder / ("right" + name.substr(4));
    if (files.contains(right)) pairs.push_back({file, right});
  }
  if (pairs.empty()) throw std::runtime_error(folder.string() + ": has no left*, right* pairs");
  return pairs;
}

PictureCalibration CalibrateFromPictures(const std::vector<PicturePair>& pairs, const Board& board,
                                         const std::function<void(const PicturePair&)>& left_out) {
  PictureCalibration out;
  out.pairs = pairs.size();
  std::vector<BoardView> views;
  ByteImage first_left;
  ByteImage first_right;
  for (const PicturePair& pair : pairs) {
    const ByteImage left = ToGray(ReadImage(pair.left));
    const ByteImage right = ToGray(ReadImage(pair.right));
    CheckPair(left, right);
    const auto in_left = FindBoard(left, board);
    const auto in_right = FindBoard(right, board);
    if (!in_left || !in_right) {
      left_out(pair);
      continue;
    }
    if (first_left.empty()) {
      first_left = left;
      first_right = right;
    }
    if (!left.SameSizeAs(first_left)) {
      throw std::runtime_error(pair.left.string() + ": its size differs from that of the pairs before");
    }
    views.push_back({*in_left, *in_right});
  }
  out.views = views.size();
  out.result = Calibrate(views, board, first_left.width(), first_left.height());
  const StereoRectifier rectifier(out.result.calibration);
  out.rectified = rectifier.geometry();
  out.first_pair = WithScanLines(Rectify(rectifier, Side::kLeft, first_left),
                                 Rectify(rectifier, Side::kRight, first_right));
  return out;
}

std::string Describe(const PictureCalibration& calibration) {
  const CalibrationResult& result = calibration.result;
  return fmt::format(
      "{} of {} pairs; reprojection error {:.3f} px (root mean square), epipolar error {:.3f} px (median), "
      "{:.3f} px (worst); baseline {:.3f} m",
      calibration.views, calibration.pairs, result.reprojection_px, result.epipolar_px,
      result.epipolar_worst_px, calibration.rectified.baseline);
}

}  // namespace thalweg::stereo
