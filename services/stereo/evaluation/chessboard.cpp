#include "services/stereo/evaluation/chessboard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>

#include "common/base/median.h"
#include "common/base/size_text.h"
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

constexpr double kMostScaleError = 0.01;

/// A board's corners [m] in C, and their mean disparity [px].
struct Triangulated {
  std::vector<Eigen::Vector3d> points_C;
  double disparity = 0.0;
};

Triangulated TriangulateBoard(const StereoRectifier& rectifier, const BoardView& view) {
  const auto& [camera, baseline] = rectifier.geometry();
  Triangulated board;
  for (std::size_t i = 0; i < view.left.size(); ++i) {
    const Eigen::Vector2d p = rectifier.RectifyPoint(Side::kLeft, view.left[i].cast<double>());
    const Eigen::Vector2d q = rectifier.RectifyPoint(Side::kRight, view.right[i].cast<double>());
    const double d = p.x() - q.x();
    board.points_C.push_back(
        camera.fx * baseline / d *
        Eigen::Vector3d((p.x() - camera.cx) / camera.fx, (p.y() - camera.cy) / camera.fy, 1.0));
    board.disparity += d / static_cast<double>(view.left.size());
  }
  return board;
}

/// Median length of the squares' sides over the true one.
double ScaleOf(const Triangulated& triangulated, const Board& board) {
  std::vector<double> scales;
  const auto at = [&](int column, int row) {
    return triangulated.points_C[static_cast<std::size_t>(row * board.columns + column)];
  };
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      if (column > 0) scales.push_back((at(column, row) - at(column - 1, row)).norm() / board.square);
      if (row > 0) scales.push_back((at(column, row) - at(column, row - 1)).norm() / board.square);
    }
  }
  return Median(scales);
}

/// Each of the model's numbers, as the median of all.
std::optional<RowAlignment> MedianOf(const std::vector<RowAlignment>& all) {
  if (all.empty()) return std::nullopt;
  const auto median = [&](auto number) {
    std::vector<double> values;
    for (const RowAlignment& rows : all) values.push_back(number(rows));
    return Median(values);
  };
  RowAlignment rows;
  for (const RowAlignment& one : all) rows.corners += one.corners;
  rows.offset_px = median([](const RowAlignment& one) { return one.offset_px; });
  rows.tilt_px = median([](const RowAlignment& one) { return one.tilt_px; });
  rows.slant_px = median([](const RowAlignment& one) { return one.slant_px; });
  for (int k = 0; k < 9; ++k) {
    rows.covariance_px2(k / 3, k % 3) =
        median([k](const RowAlignment& one) { return one.covariance_px2(k / 3, k % 3); });
  }
  return rows;
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

bool CalibrationCheck::good() const {
  const bool rows_agree = !rows || rows->CertainPx() <= kMostRowDifference;
  return rows_agree && std::abs(scale - 1.0) <= kMostScaleError;
}

CalibrationCheck CheckCalibration(const StereoCalibration& calibration, const std::vector<PicturePair>& pairs,
                                  const std::optional<Board>& board, int max_disparity) {
  const StereoRectifier rectifier(calibration);
  CalibrationCheck check;
  check.pairs = pairs.size();
  std::vector<RowAlignment> rows;
  std::vector<double> scales;
  std::vector<double> missing_px;
  for (const PicturePair& pair : pairs) {
    const ByteImage left = ToGray(ReadImage(pair.left));
    const ByteImage right = ToGray(ReadImage(pair.right));
    CheckPair(left, right);
    if (left.width() != calibration.left.width_px || left.height() != calibration.left.height_px) {
      throw std::runtime_error(fmt::format("{}: is {}, its calibration is for {}", pair.left.string(),
                                           SizeText(left.width(), left.height()),
                                           SizeText(calibration.left.width_px, calibration.left.height_px)));
    }
    const auto measured = MeasureRowAlignment(Rectify(rectifier, Side::kLeft, left),
                                              Rectify(rectifier, Side::kRight, right), max_disparity);
    if (measured) rows.push_back(*measured);
    if (!board) continue;
    const auto in_left = FindBoard(left, *board);
    const auto in_right = FindBoard(right, *board);
    if (!in_left || !in_right) continue;
    const Triangulated triangulated = TriangulateBoard(rectifier, {*in_left, *in_right});
    scales.push_back(ScaleOf(triangulated, *board));
    missing_px.push_back(triangulated.disparity * (scales.back() - 1.0));
  }
  check.rows = MedianOf(rows);
  check.views = scales.size();
  if (scales.empty()) return check;
  check.scale = Median(scales);
  check.disparity_off_px = Median(missing_px);
  return check;
}

std::string Describe(const CalibrationCheck& check) {
  std::string text = fmt::format("{} pairs: ", check.pairs);
  text += check.rows ? Describe(*check.rows) : "too few corners are in both images to compare rows";
  if (check.views > 0) {
    text += fmt::format(
        "\n{} views of the board: its squares measure {:+.2f} %, as if disparities were off by {:+.2f} px",
        check.views, 100.0 * (check.scale - 1.0), -check.disparity_off_px);
  }
  const bool measured = check.rows || check.views > 0;
  if (!measured) return text;
  return text + (check.good() ? "\nthe calibration is right" : "\ncalibrate again");
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
