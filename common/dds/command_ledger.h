#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "common/base/time.h"
#include "common/dds/topics.h"

namespace thalweg::dds {

/// The longest OperatorCommand::sender that is kept.
inline constexpr std::size_t kLongestSender = 64;

/// A sender's name as a service keeps and repeats it, since it goes to the log: at most kLongestSender bytes,
/// of which those that are not printable ASCII are replaced by "?".
std::string SenderName(std::string_view name);

/// Which command: the number is the sender's own.
struct CommandId {
  std::string sender;  ///< A SenderName.
  std::uint64_t number = 0;
  bool operator==(const CommandId&) const = default;
};
CommandId IdOf(const thalweg_msgs::msg::OperatorCommand& command);

thalweg_msgs::msg::CommandReply MakeReply(Time now, const std::string& service, const CommandId& id,
                                          bool accepted, const std::string& reason);

/// Remembers the last commands and their replies: a command that is sent again, because its reply was lost or
/// is late, is answered again but not carried out again.
///
/// Threading: one thread.
class CommandLedger {
 public:
  static constexpr std::size_t kRemembered = 256;

  /// Whether the command is new. From then on it is not.
  bool Begin(const CommandId& id);
  void Finish(const CommandId& id, const thalweg_msgs::msg::CommandReply& reply);
  /// Null for a command that is still being carried out.
  const thalweg_msgs::msg::CommandReply* ReplyTo(const CommandId& id) const;

 private:
  struct Entry {
    CommandId id;
    bool finished = false;
    thalweg_msgs::msg::CommandReply reply = {};
  };
  const Entry* Find(const CommandId& id) const;
  std::deque<Entry> entries_;
};

}  // namespace thalweg::dds
