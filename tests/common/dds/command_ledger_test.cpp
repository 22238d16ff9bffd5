#include "common/dds/command_ledger.h"

#include <gtest/gtest.h>

namespace thalweg::dds {
namespace {

TEST(CommandLedger, ACommandIsNewOnceAndItsReplyIsKept) {
  CommandLedger ledger;
  const CommandId id{"anna", 7};
  EXPECT_TRUE(ledger.Begin(id));
  EXPECT_EQ(ledger.ReplyTo(id), nullptr) << "not carried out yet";
  EXPECT_FALSE(ledger.Begin(id));
  ledger.Finish(id, MakeReply(Time{}, "explorer", id, true, "paused"));
  EXPECT_FALSE(ledger.Begin(id));
  ASSERT_NE(ledger.ReplyTo(id), nullptr);
  EXPECT_EQ(ledger.ReplyTo(id)->reason(), "paused");
  EXPECT_EQ(ledger.ReplyTo(id)->sender(), "anna");
  EXPECT_EQ(ledger.ReplyTo(id)->id(), 7U);
  EXPECT_TRUE(ledger.Begin({"bert", 7})) << "another sender's ids are others";
}

TEST(CommandLedger, ForgetsTheOldestAndNeverGrowsBeyondItsBound) {
  CommandLedger ledger;
  for (std::uint64_t n = 0; n <= CommandLedger::kRemembered; ++n) EXPECT_TRUE(ledger.Begin({"anna", n}));
  EXPECT_FALSE(ledger.Begin({"anna", 1}));
  EXPECT_TRUE(ledger.Begin({"anna", 0})) << "the oldest";
}

TEST(CommandLedger, ASendersNameIsClampedToPrintableCharacters) {
  thalweg_msgs::msg::OperatorCommand command;
  command.sender("a\nb\x1b[31m\xc3\xa4" + std::string(1000, 'x'));
  const CommandId id = IdOf(command);
  EXPECT_EQ(id.sender.size(), 64U);
  EXPECT_EQ(id.sender.substr(0, 10), "a?b?[31m??");
}

}  // namespace
}  // namespace thalweg::dds
