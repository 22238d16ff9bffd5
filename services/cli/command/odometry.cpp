#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "common/files/tum.h"
#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/cli/command/command.h"
#include "services/cli/command/number_range.h"
#include "services/cli/report/trajectory_picture.h"
#include "services/visual_odometry/evaluation/sequence_evaluation.h"

namespace thalweg::cli {
namespace {

namespace vo = visual_odometry;

struct OdometryArgs {
  std::string sequence;
  std::filesystem::path out;
  std::filesystem::path json;
  std::filesystem::path picture;
  vo::SequenceOptions options;
  std::vector<double> bend{0.0, 0.0, 0.0};
};

int Odometry(OdometryArgs args) {
  args.options.bend = {args.bend[0], args.bend[1]};
  args.options.bend_rows = args.bend[2];
  const std::filesystem::path picture =
      args.picture.empty() ? args.out.parent_path() / "trajectory.png" : args.picture;
  CheckWritable({args.out, args.json, picture});
  const vo::Sequence sequence = vo::Sequence::Open(args.sequence);
  const vo::SequenceEvaluation evaluation =
      vo::Evaluate(sequence, args.options, [](const std::string& remark) { std::cout << remark << '\n'; });
  const std::vector<std::string> lines = vo::Describe(evaluation);
  for (const std::string& line : lines) std::cout << line << '\n';
  for (const std::string& line : vo::DescribeByLength(evaluation)) std::cout << "  " << line << '\n';
  if (!args.out.empty()) WriteFile(args.out, TumText(evaluation.trajectory));
  if (!args.json.empty()) WriteFile(args.json, vo::ToJson(evaluation).dump(2) + '\n');
  const std::string title = std::filesystem::absolute(args.sequence).lexically_normal().filename().string();
  const auto [estimated, truth] = vo::PathsOf(evaluation);
  WritePicture(picture, Draw({title, lines, estimated, truth}));
  std::cout << "picture: " << picture.string() << '\n';
  return EXIT_SUCCESS;
}

}  // namespace

void AddOdometry(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<OdometryArgs>();
  const std::string purpose =
      "Run visual odometry on a stereo sequence (KITTI or EuRoC) and compare it with ground truth";
  CLI::App* command = app.add_subcommand("odometry", purpose);
  command->add_option("sequence", args->sequence, "Folder of the sequence")->required();
  command->add_option("--out", args->out, "Where to write the trajectory (TUM format)");
  command->add_option("--json", args->json, "Where to write the results as JSON");
  command->add_option("--picture", args->picture,
                      "Where to draw the trajectory; default: trajectory.png beside --out");
  command->add_option("--first", args->options.first, "Frame to begin with")->capture_default_str();
  command->add_option("--frames", args->options.most, "Number of frames to use; default: all");
  command
      ->add_option("--bend-px", args->bend,
                   "Bend right images as a camera does that is badly calibrated: disparities too small by "
                   "B0 + B2 x^2, rows too large by R, with x = (u - cx) / f")
      ->expected(3)
      ->type_name("B0 B2 R");
  command
      ->add_option("--truth-sigma-m", args->options.truth_sigma,
                   "Standard deviation of the true positions, which the 95 % ellipsoids allow for")
      ->check(NumberFrom(0.0, 1e9));
  command
      ->add_option("--most-places", args->options.estimator.places.most_places,
                   "Places kept to be recognized later; 0 = none")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command->callback([args, &exit_code] { exit_code = Odometry(*args); });
}

}  // namespace thalweg::cli
