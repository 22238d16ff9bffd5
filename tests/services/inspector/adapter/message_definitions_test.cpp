#include "services/inspector/adapter/message_definitions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "services/inspector/core/schema.h"

namespace thalweg::inspector {
namespace {

using testing::HasSubstr;

class MessageDefinitionsTest : public testing::Test {
 protected:
  MessageDefinitionsTest() {
    std::filesystem::create_directories(folder_ / "my_robot/msg");
    Write("my_robot/msg/State.msg", "std_msgs/Header header\nWheel[2] wheels\n");
    Write("my_robot/msg/Wheel.msg", "float32 speed 0.0  # [m/s]\n");
  }
  ~MessageDefinitionsTest() override { std::filesystem::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  const std::filesystem::path folder_ = testing::TempDir() + "/msgs-" + std::to_string(getpid());
};

TEST_F(MessageDefinitionsTest, AFolderAddsTypesOfOnesOwn) {
  const auto text = MessageDefinition("my_robot/msg/State", {"/nowhere", folder_});
  ASSERT_TRUE(text) << text.error();
  const auto schema = Schema::Parse("my_robot/msg/State", *text);
  ASSERT_TRUE(schema) << schema.error();
  EXPECT_EQ(schema->NameOf(schema->message(0).fields[1].type), "my_robot/Wheel[2]");
}

TEST_F(MessageDefinitionsTest, OwnTypesAndStandardOnesNeedNoFolder) {
  EXPECT_TRUE(MessageDefinition("thalweg_msgs/msg/ExplorationStatus", {}));
  EXPECT_TRUE(MessageDefinition("sensor_msgs/msg/Imu", {}));
}

TEST_F(MessageDefinitionsTest, ATypeLeadsToNoOtherPlace) {
  Write("secret.msg", "int32 n\n");
  EXPECT_THAT(MessageDefinition("my_robot/../../secret", {folder_}).error(), HasSubstr("is not defined"));
  EXPECT_THAT(MessageDefinition("../secret", {folder_}).error(), HasSubstr("is not defined"));
}

TEST_F(MessageDefinitionsTest, TheFoldersOfTheEnvironmentComeFirst) {
  setenv("THALWEG_MSG_PATH", "/first:/second", 1);
  setenv("AMENT_PREFIX_PATH", "/prefix", 1);
  const std::vector<std::filesystem::path> folders = MessageFolders();
  unsetenv("THALWEG_MSG_PATH");
  unsetenv("AMENT_PREFIX_PATH");
  ASSERT_GE(folders.size(), 3U);
  EXPECT_EQ(folders[0], "/first");
  EXPECT_EQ(folders[1], "/second");
  EXPECT_EQ(folders[2], "/prefix/share");
}

}  // namespace
}  // namespace thalweg::inspector
