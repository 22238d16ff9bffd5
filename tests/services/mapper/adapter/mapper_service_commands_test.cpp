#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "services/mapper/adapter/mapper_service.h"
#include "tests/services/mapper/support/mapper_service_fixture.h"

namespace thalweg::mapper {
namespace {

namespace topics = dds::topics;
using test::At;
using test::MapperServiceTest;
using test::SpinTogether;
using thalweg::test::BusOptionsForTest;

TEST_P(MapperServiceTest, AnOperatorsCommandSavesTheMapOnceAndIsAnsweredWhenItIsOnDisk) {
  Start();
  dds::Bus operator_bus(BusOptionsForTest("operator"));
  const auto commands = operator_bus.Advertise<topics::OperatorCommands>();
  std::map<std::uint32_t, std::vector<thalweg_msgs::msg::CommandReply>> replies;  // by id
  bool on_disk = false;  // when command 3 was answered
  operator_bus.Subscribe<topics::CommandReplies>([&](const auto& reply) {
    if (reply.id() == 3 && replies[3].empty()) on_disk = std::filesystem::exists(folder_.path() / "map.ply");
    replies[reply.id()].push_back(reply);
  });
  Scan(1.0);
  thalweg_msgs::msg::OperatorCommand command;
  command.header(dds::MakeHeader(At(1.0), dds::kMapFrame));
  command.sender("test");
  const auto send = [&](std::uint32_t id, thalweg_msgs::msg::CommandKind kind) {
    command.id(id);
    command.kind(kind);
    commands.Write(command);
  };
  // Until both directions have matched, a sender repeats its command.
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] {
    send(1, thalweg_msgs::msg::COMMAND_SAVE_MAP);
    return !replies[1].empty();
  }));
  std::filesystem::remove(folder_.path() / "map.ply");
  send(2, thalweg_msgs::msg::COMMAND_PAUSE);  // for the explorer
  send(3, thalweg_msgs::msg::COMMAND_SAVE_MAP);
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] { return replies[3].size() == 1; }));
  EXPECT_TRUE(on_disk);
  EXPECT_TRUE(replies[2].empty());
  EXPECT_EQ(replies[3][0].service(), "mapper");
  EXPECT_TRUE(replies[3][0].accepted()) << replies[3][0].reason();
  octomap::OcTree tree(1.0);
  ASSERT_TRUE(tree.readBinary((folder_.path() / "map.bt").string()));
  EXPECT_GT(tree.getNumLeafNodes(), 100U);
  std::filesystem::remove(folder_.path() / "map.ply");
  commands.Write(command);
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] { return replies[3].size() == 2; }));
  EXPECT_EQ(replies[3][1].reason(), replies[3][0].reason());
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "map.ply")) << "it was not saved again";
}

TEST_P(MapperServiceTest, CommandsToSaveThatComeTogetherAreAllAnswered) {
  Start();
  dds::Bus operator_bus(BusOptionsForTest("operator"));
  const auto commands = operator_bus.Advertise<topics::OperatorCommands>();
  std::map<std::uint32_t, bool> accepted;  // by id
  std::string refusal;
  operator_bus.Subscribe<topics::CommandReplies>([&](const auto& reply) {
    accepted[reply.id()] = reply.accepted();
    if (!reply.accepted()) refusal = reply.reason();
  });
  Scan(1.0);
  thalweg_msgs::msg::OperatorCommand command;
  command.header(dds::MakeHeader(At(1.0), dds::kMapFrame));
  command.sender("test");
  command.kind(thalweg_msgs::msg::COMMAND_SAVE_MAP);
  command.id(1);
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] {
    commands.Write(command);
    return accepted.contains(1);
  }));
  constexpr std::uint32_t kMany = 60;
  for (std::uint32_t id = 2; id < 2 + kMany; ++id) {
    command.id(id);
    commands.Write(command);
  }
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] { return accepted.size() == 1 + kMany; }));
  EXPECT_TRUE(accepted[2]);
  if (!refusal.empty()) {
    EXPECT_EQ(refusal, "too many wait for the map to be saved");
  }
}

}  // namespace
}  // namespace thalweg::mapper
