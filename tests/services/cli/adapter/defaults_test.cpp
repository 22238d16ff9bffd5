#include "services/cli/adapter/defaults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "common/service/service.h"
#include "services/controller/adapter/options.h"
#include "services/explorer/adapter/options.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/adapter/options.h"
#include "tests/support/places.h"
#include "tests/support/recording_visitor.h"

namespace thalweg::cli {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using testing::HasSubstr;

constexpr double kPrecision = 1e-6;  // seven digits are shown

/// The names of all fields absent from `message`, except those that contain a message.
std::vector<std::string> AbsentFrom(const Message& message, const std::string& path = "") {
  std::vector<std::string> absent;
  for (int k = 0; k < message.GetDescriptor()->field_count(); ++k) {
    const FieldDescriptor* const field = message.GetDescriptor()->field(k);
    if (!field->has_presence()) continue;  // of a vector
    const std::string name = path + field->name();
    if (!message.GetReflection()->HasField(message, field)) {
      absent.push_back(name);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      const std::vector<std::string> inner =
          AbsentFrom(message.GetReflection()->GetMessage(message, field), name + ".");
      absent.insert(absent.end(), inner.begin(), inner.end());
    }
  }
  return absent;
}

TEST(WithDefaults, LeavesAbsentOnlyWhatARunDecides) {
  EXPECT_EQ(AbsentFrom(WithDefaults(Scenario())),
            (std::vector<std::string>{"title", "world.file", "world.bounds_min_m", "world.bounds_max_m",
                                      "simulator.start_position_m", "visual_odometry.start_position_m",
                                      "visual_odometry.start_yaw_deg", "stereo.calibration_file"}));
}

/// The paths of all fields of a scenario, except those that contain a message other than a vector.
std::vector<std::string> FieldsOf(const google::protobuf::Descriptor* type, const std::string& path = "") {
  std::vector<std::string> fields;
  for (int k = 0; k < type->field_count(); ++k) {
    const FieldDescriptor* const field = type->field(k);
    const std::string name = path + field->name();
    const bool block = field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE &&
                       field->message_type() != Vector3::descriptor();
    if (!block) {
      fields.push_back(name);
    } else if (!field->is_repeated()) {
      for (std::string& inner : FieldsOf(field->message_type(), name + '.')) fields.push_back(inner);
    }
  }
  return fields;
}

TEST(VisitScenario, BindsEveryFieldOfTheSchemaOnceButForThoseThatCodeReadsByHand) {
  test::RecordingVisitor visitor;
  VisitScenario(visitor, Scenario());
  std::vector<std::string> bound = visitor.fields();
  for (const char* by_hand :
       {"title", "world.file", "world.bounds_min_m", "world.bounds_max_m", "simulator.start_position_m",
        "visual_odometry.start_position_m", "visual_odometry.start_yaw_deg", "stereo.calibration_file"}) {
    bound.emplace_back(by_hand);
  }
  EXPECT_THAT(bound, testing::UnorderedElementsAreArray(FieldsOf(Scenario::descriptor())));
}

TEST(WithDefaults, SaysWhereDepthAndPosesComeFrom) {
  const std::string text = CommentedText(WithDefaults(Scenario()), Scenario());
  EXPECT_THAT(text, HasSubstr("depth_source: DEPTH_SENSOR  # default\n"));
  EXPECT_THAT(text, HasSubstr("odometry_source: SIMULATOR  # default\n"));
  const Scenario camera = LoadScenario("kitchen_camera");
  EXPECT_THAT(
      CommentedText(WithDefaults(camera), camera),
      testing::AllOf(HasSubstr("depth_source: STEREO\n"), HasSubstr("odometry_source: VISUAL_ODOMETRY\n")));
}

TEST(WithDefaults, KeepsWhatIsGiven) {
  const Scenario given = LoadScenario("flat");
  Scenario full = WithDefaults(given);
  EXPECT_EQ(WithDefaults(full).SerializeAsString(), full.SerializeAsString());
  full.MergeFrom(given);
  EXPECT_EQ(full.SerializeAsString(), WithDefaults(given).SerializeAsString());
}

TEST(WithDefaults, ContradictsNothing) {
  EXPECT_NO_THROW(CheckScenario(WithDefaults(Scenario())));
}

TEST(WithDefaults, ChangesNothingForTheMapper) {
  const mapper::MapperOptions bare = mapper::OptionsFrom(Scenario(), ".");
  const mapper::MapperOptions full = mapper::OptionsFrom(WithDefaults(Scenario()), ".");
  EXPECT_DOUBLE_EQ(full.map.voxel_size, bare.map.voxel_size);
  EXPECT_DOUBLE_EQ(full.map.max_range, bare.map.max_range);
  EXPECT_DOUBLE_EQ(full.map.min_range, bare.map.min_range);
  EXPECT_EQ(full.map.log_odds_hit, bare.map.log_odds_hit);
  EXPECT_EQ(full.map.log_odds_miss, bare.map.log_odds_miss);
  EXPECT_EQ(full.map.log_odds_min, bare.map.log_odds_min);
  EXPECT_EQ(full.map.log_odds_max, bare.map.log_odds_max);
  EXPECT_EQ(full.map.protect, bare.map.protect);
  EXPECT_EQ(full.map.fill, bare.map.fill);
  EXPECT_EQ(full.map.exact_rays, bare.map.exact_rays);
  EXPECT_DOUBLE_EQ(full.map.fill_max_gap, bare.map.fill_max_gap);
  EXPECT_DOUBLE_EQ(full.map.shadow, bare.map.shadow);
  EXPECT_EQ(full.checkpoint_period, bare.checkpoint_period);
  EXPECT_TRUE(full.T_BC.isApprox(bare.T_BC));
}

TEST(WithDefaults, ChangesNothingForTheExplorer) {
  const explorer::Explorer::Options bare = explorer::OptionsFrom(Scenario());
  const explorer::Explorer::Options full = explorer::OptionsFrom(WithDefaults(Scenario()));
  EXPECT_DOUBLE_EQ(full.voxel_size, bare.voxel_size);
  EXPECT_EQ(full.bounds.has_value(), bare.bounds.has_value());
  EXPECT_DOUBLE_EQ(full.safety_margin, bare.safety_margin);
  EXPECT_DOUBLE_EQ(full.frontier.min_area, bare.frontier.min_area);
  EXPECT_DOUBLE_EQ(full.frontier.extent, bare.frontier.extent);
  EXPECT_EQ(full.memory.looks, bare.memory.looks);
  EXPECT_EQ(full.memory.expiry, bare.memory.expiry);
  EXPECT_DOUBLE_EQ(full.look_range, bare.look_range);
  EXPECT_DOUBLE_EQ(full.min_measured_share, bare.min_measured_share);
  EXPECT_DOUBLE_EQ(full.max_missed_share, bare.max_missed_share);
  EXPECT_DOUBLE_EQ(full.doubt.max_log_odds, bare.doubt.max_log_odds);
  EXPECT_DOUBLE_EQ(full.doubt.weight, bare.doubt.weight);
  EXPECT_DOUBLE_EQ(full.look_around_min_area, bare.look_around_min_area);
  EXPECT_DOUBLE_EQ(full.comfort.distance, bare.comfort.distance);
  EXPECT_EQ(full.time_budget, bare.time_budget);
  EXPECT_DOUBLE_EQ(full.distance_budget, bare.distance_budget);
  EXPECT_EQ(full.strategy.name, bare.strategy.name);
  EXPECT_DOUBLE_EQ(full.sensor_range, bare.sensor_range) << "as the mapper's own default";
  EXPECT_DOUBLE_EQ(full.robot.radius, bare.robot.radius);
  EXPECT_EQ(full.camera.width_px, bare.camera.width_px);
  EXPECT_EQ(full.camera.height_px, bare.camera.height_px);
  EXPECT_NEAR(full.camera.fx, bare.camera.fx, bare.camera.fx * kPrecision);
}

TEST(WithDefaults, ChangesNothingForTheController) {
  const controller::ControllerOptions bare = controller::OptionsFrom(Scenario());
  const controller::ControllerOptions full = controller::OptionsFrom(WithDefaults(Scenario()));
  EXPECT_DOUBLE_EQ(full.rate, bare.rate);
  EXPECT_DOUBLE_EQ(full.follower.silence, bare.follower.silence);
  EXPECT_DOUBLE_EQ(full.follower.robot.max_speed, bare.follower.robot.max_speed);
  EXPECT_DOUBLE_EQ(full.follower.robot.max_acceleration, bare.follower.robot.max_acceleration);
  EXPECT_NEAR(full.follower.robot.max_turn_rate, bare.follower.robot.max_turn_rate, kPrecision);
  EXPECT_DOUBLE_EQ(full.follower.position_tolerance, bare.follower.position_tolerance);
  EXPECT_NEAR(full.follower.angle_tolerance, bare.follower.angle_tolerance, kPrecision);
}

TEST(WithDefaults, ChangesNothingForTheSimulator) {
  const auto options_of = [](const Scenario& scenario) {
    return simulator::OptionsFrom(scenario, simulator::LoadWorld(scenario));
  };
  Scenario given;
  given.mutable_world()->set_file(test::SourceFolder() + "/deploy/worlds/tiny.obj");
  given.mutable_stereo_camera()->set_enabled(true);
  const simulator::SimulatorOptions bare = options_of(given);
  const simulator::SimulatorOptions full = options_of(WithDefaults(given));
  EXPECT_TRUE(full.T_WB_start.isApprox(bare.T_WB_start));
  EXPECT_DOUBLE_EQ(full.time_scale, bare.time_scale);
  EXPECT_DOUBLE_EQ(full.odometry_rate, bare.odometry_rate);
  EXPECT_EQ(full.noise_seed, bare.noise_seed);
  EXPECT_DOUBLE_EQ(full.depth_sensor.rate, bare.depth_sensor.rate);
  EXPECT_DOUBLE_EQ(full.depth_sensor.max_range, bare.depth_sensor.max_range);
  EXPECT_DOUBLE_EQ(full.depth_sensor.disparity_noise_px, bare.depth_sensor.disparity_noise_px);
  EXPECT_DOUBLE_EQ(full.depth_sensor.baseline, bare.depth_sensor.baseline);
  EXPECT_EQ(full.depth_sensor.no_return_is_free, bare.depth_sensor.no_return_is_free);
  ASSERT_TRUE(full.stereo_camera && bare.stereo_camera);
  EXPECT_EQ(full.stereo_camera->camera.width_px, bare.stereo_camera->camera.width_px);
  EXPECT_EQ(full.stereo_camera->camera.height_px, bare.stereo_camera->camera.height_px);
  EXPECT_NEAR(full.stereo_camera->camera.fx, bare.stereo_camera->camera.fx,
              bare.stereo_camera->camera.fx * kPrecision);
  EXPECT_DOUBLE_EQ(full.stereo_camera->baseline, bare.stereo_camera->baseline);
  EXPECT_DOUBLE_EQ(full.stereo_camera->rate, bare.stereo_camera->rate);
  EXPECT_DOUBLE_EQ(full.stereo_camera->noise_sigma, bare.stereo_camera->noise_sigma);
  EXPECT_FALSE(WithDefaults(Scenario()).stereo_camera().enabled());
}

TEST(WithDefaults, ChangesNothingForTheNetwork) {
  const dds::BusOptions bare = BusOptionsFrom(Scenario(), {}, "mapper");
  const dds::BusOptions full = BusOptionsFrom(WithDefaults(Scenario()), {}, "mapper");
  EXPECT_EQ(full.domain, bare.domain);
  EXPECT_EQ(full.shared_memory, bare.shared_memory);
  EXPECT_EQ(full.segment_mb, bare.segment_mb);
  EXPECT_EQ(full.network_interface, bare.network_interface);
  EXPECT_EQ(full.discovery_server, bare.discovery_server);
  EXPECT_EQ(full.peers, bare.peers);
  EXPECT_EQ(full.clock, bare.clock);
}

TEST(CommentedText, IsLoadedAgainAndMarksTheDefaults) {
  const Scenario given = LoadScenario("flat", {"mapper.voxel_size_m=0.05", "title=a \"b\" # c"});
  const Scenario full = WithDefaults(given);
  const std::string text = CommentedText(full, given);
  EXPECT_THAT(text, HasSubstr("  voxel_size_m: 0.05\n"));
  EXPECT_THAT(text, HasSubstr("  min_range_m: 0.05  # default\n"));
  EXPECT_THAT(text, HasSubstr("  log_odds_hit: 0.85  # default\n"));
  EXPECT_THAT(text, HasSubstr("  camera_position_m {  # default\n    x: 0\n    y: 0\n    z: 0\n  }\n"));
  EXPECT_THAT(text, HasSubstr("  start_position_m {\n    x: 2.8\n"));
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("defaults-" + std::to_string(getpid()) + ".txtpb");
  std::ofstream(file) << text;
  EXPECT_EQ(LoadScenario(file.string()).SerializeAsString(), full.SerializeAsString());
  std::filesystem::remove(file);
}

/// A sample in a document: its command, without the program's path, and what it prints.
struct Sample {
  std::string command;
  std::string output;
};

/// The first sample of a document that runs `thalweg`.
Sample SampleIn(const std::filesystem::path& file) {
  constexpr std::string_view kPrompt = "$ build/bin/thalweg ";
  std::ifstream document(file);
  Sample sample;
  std::string begin;
  while (std::getline(document, begin) && begin != "```") continue;
  for (std::string line; std::getline(document, line) && line != "```";) {
    if (line.starts_with(kPrompt)) {
      if (!sample.command.empty()) break;
      sample.command = line.substr(kPrompt.size());
    } else if (!sample.command.empty()) {
      sample.output += (sample.output.empty() ? "" : "\n") + line;
    }
  }
  return sample;
}

TEST(ReadmeOfTheScenario, ShowsWhatMistakesLookLike) {
  const Sample sample = SampleIn(std::filesystem::path(test::SourceFolder()) / "common/scenario/README.md");
  std::istringstream words(sample.command);
  std::vector<std::string> overrides;
  for (std::string word, before; words >> word; before = word) {
    if (before == "--set") overrides.push_back(word);
  }
  ASSERT_EQ(overrides.size(), 2U) << sample.command;
  try {
    LoadScenario("tiny", overrides, {.with_defaults = WithDefaults});
    ADD_FAILURE() << "there are mistakes";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string("thalweg: ") + error.what(), sample.output);
  }
}

}  // namespace
}  // namespace thalweg::cli
