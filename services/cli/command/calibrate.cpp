#include <algorithm>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <set>
#include <stdexcept>

#include "services/cli/command/command.h"
#include "services/stereo/adapter/calibration_file.h"
#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/matcher.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;
using stereo::ByteImage;

constexpr int kFewest = 3;  // corners along a side: OpenCV finds no smaller boards
constexpr int kMost = 100;

struct Args {
  fs::path folder;
  std::string board;
  double square = 0.0;
  fs::path out = "calibration.yml";
  fs::path picture = "rectified.png";
};

struct FilePair {
  fs::path left, right;
};

/// left*.* and right*.* of the same ending, in order.
std::vector<FilePair> PairsIn(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw std::runtime_error(folder.string() + ": is no folder");
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.insert(entry.path());
  std::vector<FilePair> pairs;
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    if (!name.starts_with("left")) continue;
    const fs::path right = folder / ("right" + name.substr(4));
    if (files.contains(right)) pairs.push_back({file, right});
  }
  if (pairs.empty()) throw std::runtime_error(folder.string() + ": has no left*, right* pairs");
  return pairs;
}

std::string TextOf(const stereo::Board& board) {
  return std::to_string(board.columns) + "x" + std::to_string(board.rows);
}

stereo::Board BoardFrom(const Args& args) {
  stereo::Board board;
  board.square = args.square;
  if (!std::isfinite(args.square) || args.square <= 0.0) {
    throw std::runtime_error("--square-m is " + std::to_string(args.square) + ", must be a number > 0");
  }
  const char* const end = args.board.data() + args.board.size();
  const auto columns = std::from_chars(args.board.data(), end, board.columns);
  const bool has_x = columns.ec == std::errc() && columns.ptr != end && *columns.ptr == 'x';
  const auto rows = has_x ? std::from_chars(columns.ptr + 1, end, board.rows) : columns;
  if (!has_x || rows.ec != std::errc() || rows.ptr != end || board.columns < kFewest ||
      board.rows < kFewest || board.columns > kMost || board.rows > kMost) {
    throw std::runtime_error("--board is \"" + args.board +
                             "\", must be COLUMNSxROWS of inner corners, 3x3 to 100x100");
  }
  return board;
}

/// Side by side, with a line every few rows: what is on one line in the left image must be so in the right.
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

int Calibrate(const Args& args) {
  const stereo::Board board = BoardFrom(args);
  const std::vector<FilePair> pairs = PairsIn(args.folder);
  std::vector<stereo::BoardView> views;
  ByteImage first_left;
  ByteImage first_right;
  for (const FilePair& pair : pairs) {
    const ByteImage left = stereo::ToGray(stereo::ReadImage(pair.left));
    const ByteImage right = stereo::ToGray(stereo::ReadImage(pair.right));
    stereo::CheckPair(left, right);
    const auto in_left = stereo::FindBoard(left, board);
    const auto in_right = stereo::FindBoard(right, board);
    if (!in_left || !in_right) {
      std::cout << pair.left.filename().string() << ": the board is not seen whole, left out\n";
      continue;
    }
    if (first_left.empty()) {
      first_left = left;
      first_right = right;
    }
    if (!left.SameSizeAs(first_left)) {
      throw std::runtime_error(pair.left.string() + ": is of another size than the pairs before");
    }
    views.push_back({*in_left, *in_right});
  }
  const stereo::CalibrationResult result =
      stereo::Calibrate(views, board, first_left.width(), first_left.height());
  stereo::WriteCalibration(args.out, result);
  const StereoRectifier rectifier(result.calibration);
  stereo::WriteImage(args.picture, WithScanLines(stereo::Rectify(rectifier, Side::kLeft, first_left),
                                                 stereo::Rectify(rectifier, Side::kRight, first_right)));
  std::cout << std::fixed << std::setprecision(3) << views.size() << " of " << pairs.size()
            << " pairs; reprojection error " << result.reprojection_px
            << " px (root mean square), epipolar error " << result.epipolar_px << " px (median), "
            << result.epipolar_worst_px << " px (worst); baseline " << rectifier.geometry().baseline << " m\n"
            << "wrote " << args.out.string() << " and " << args.picture.string() << '\n';
  return EXIT_SUCCESS;
}

}  // namespace

void AddCalibrate(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  args->board = TextOf(stereo::Board());
  CLI::App* command =
      app.add_subcommand("calibrate", "Calibrate a stereo camera from pictures of a chessboard");
  command->add_option("folder", args->folder, "With left*.* and right*.* of the same endings")->required();
  command->add_option("--board", args->board, "Inner corners, COLUMNSxROWS")->capture_default_str();
  command->add_option("--square-m", args->square, "Side of a square [m]")->required();
  command->add_option("--out", args->out, "The calibration")->capture_default_str();
  command->add_option("--picture", args->picture, "A rectified pair with scan lines")->capture_default_str();
  command->callback([args, &exit_code] { exit_code = Calibrate(*args); });
}

}  // namespace thalweg::cli
