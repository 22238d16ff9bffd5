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

struct CalibrateArgs {
  std::filesystem::path folder;
  std::string board = stereo::ToText(stereo::Board());
  std::optional<double> square;  // [m]
  std::filesystem::path out = "calibration.yml";
  std::filesystem::path picture = "rectified.png";
  std::vector<std::filesystem::path> check;
  int max_disparity = 128;
};

int Check(const CalibrateArgs& args) {
  std::optional<stereo::Board> board;
  if (args.square) board = stereo::BoardFrom(args.board, *args.square);
  const stereo::CalibrationCheck check = stereo::CheckCalibration(
      stereo::ReadCalibration(args.check), stereo::PicturePairsIn(args.folder), board, args.max_disparity);
  std::cout << stereo::Describe(check) << '\n';
  return (check.rows || check.views > 0) && check.good() ? EXIT_SUCCESS : EXIT_FAILURE;
}

int Calibrate(const CalibrateArgs& args) {
  CheckWritable({args.out, args.picture});
  const stereo::Board board = stereo::BoardFrom(args.board, args.square.value());
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
  const auto args = std::make_shared<CalibrateArgs>();
  CLI::App* command =
      app.add_subcommand("calibrate", "Calibrate a stereo camera from pictures of a chessboard, or check it");
  command->add_option("folder", args->folder, "Folder with pairs left*.*, right*.* of the same name endings")
      ->required();
  command->add_option("--board", args->board, "Inner corners of the board, COLUMNSxROWS")
      ->capture_default_str();
  command->add_option("--square-m", args->square, "Side length of a square [m]");
  auto* const out = command->add_option("--out", args->out, "Where to write the calibration (OpenCV YAML)")
                        ->capture_default_str();
  auto* const picture =
      command->add_option("--picture", args->picture, "Where to write a rectified pair with scan lines")
          ->capture_default_str();
  auto* const check =
      command
          ->add_option("--check", args->check,
                       "Only say whether this calibration (YAML, or its INTRINSICS,EXTRINSICS) fits the "
                       "pictures: rows by pictures of anything, lengths by the board with --square-m")
          ->delimiter(',')
          ->expected(1, 2)
          ->allow_extra_args(false)
          ->excludes(out)
          ->excludes(picture);
  command
      ->add_option("--max-disparity", args->max_disparity, "--check: disparities below it are searched [px]")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024))
      ->needs(check);
  command->callback([args, check, &exit_code] {
    if (check->count() == 0 && !args->square) throw CLI::RequiredError("--square-m");
    exit_code = check->count() > 0 ? Check(*args) : Calibrate(*args);
  });
}

}  // namespace thalweg::cli
