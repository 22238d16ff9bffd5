#include <cstdlib>
#include <iostream>
#include <memory>

#include "common/files/write_file.h"
#include "services/cli/command/command.h"
#include "services/stereo/adapter/calibration_file.h"
#include "services/stereo/adapter/image_files.h"
#include "services/stereo/evaluation/chessboard.h"

namespace thalweg::cli {
namespace {

struct Args {
  std::filesystem::path folder;
  std::string board = stereo::ToText(stereo::Board());
  double square = 0.0;
  std::filesystem::path out = "calibration.yml";
  std::filesystem::path picture = "rectified.png";
};

int Calibrate(const Args& args) {
  CheckWritable({args.out, args.picture});
  const stereo::Board board = stereo::BoardFrom(args.board, args.square);
  const stereo::PictureCalibration calibration = stereo::CalibrateFromPictures(
      stereo::PicturePairsIn(args.folder), board, [](const stereo::PicturePair& pair) {
        std::cout << pair.left.filename().string() << ": left out, the whole board is not in both pictures\n";
      });
  stereo::WriteCalibration(args.out, calibration.result);
  stereo::WriteImage(args.picture, calibration.first_pair);
  std::cout << stereo::Describe(calibration) << "\nwrote " << args.out.string() << " and "
            << args.picture.string() << '\n';
  return EXIT_SUCCESS;
}

}  // namespace

void AddCalibrate(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  CLI::App* command =
      app.add_subcommand("calibrate", "Calibrate a stereo camera from pictures of a chessboard");
  command->add_option("folder", args->folder, "Folder with pairs left*.*, right*.* of the same name endings")
      ->required();
  command->add_option("--board", args->board, "Inner corners of the board, COLUMNSxROWS")
      ->capture_default_str();
  command->add_option("--square-m", args->square, "Side length of a square [m]")->required();
  command->add_option("--out", args->out, "Where to write the calibration (OpenCV YAML)")
      ->capture_default_str();
  command->add_option("--picture", args->picture, "Where to write a rectified pair with scan lines")
      ->capture_default_str();
  command->callback([args, &exit_code] { exit_code = Calibrate(*args); });
}

}  // namespace thalweg::cli
