#include "common/dds/command_ledger.h"

#include <algorithm>

#include "common/dds/convert.h"

namespace thalweg::dds {

std::string SenderName(std::string_view name) {
  std::string printable(name.substr(0, kLongestSender));
  for (char& c : printable) {
    if (c < 0x20 || c > 0x7E) c = '?';
  }
  return printable;
}

CommandId IdOf(const thalweg_msgs::msg::OperatorCommand& command) {
  return {SenderName(command.sender()), command.id()};
}

thalweg_msgs::msg::CommandReply MakeReply(Time now, const std::string& service, const CommandId& id,
                                          bool accepted, const std::string& reason) {
  thalweg_msgs::msg::CommandReply reply;
  reply.header(MakeHeader(now, kMapFrame));
  reply.service(service);
  reply.sender(id.sender);
  reply.id(id.number);
  reply.accepted(accepted);
  reply.reason(reason);
  return reply;
}

bool CommandLedger::Begin(const CommandId& id) {
  if (Find(id) != nullptr) return false;
  if (entries_.size() == kRemembered) entries_.pop_front();
  entries_.push_back({.id = id});
  return true;
}

void CommandLedger::Finish(const CommandId& id, const thalweg_msgs::msg::CommandReply& reply) {
  const auto entry = std::ranges::find(entries_, id, &Entry::id);
  if (entry == entries_.end()) return;  // forgotten meanwhile
  entry->finished = true;
  entry->reply = reply;
}

const thalweg_msgs::msg::CommandReply* CommandLedger::ReplyTo(const CommandId& id) const {
  const Entry* const entry = Find(id);
  return entry != nullptr && entry->finished ? &entry->reply : nullptr;
}

const CommandLedger::Entry* CommandLedger::Find(const CommandId& id) const {
  const auto entry = std::ranges::find(entries_, id, &Entry::id);
  return entry == entries_.end() ? nullptr : &*entry;
}

}  // namespace thalweg::dds
