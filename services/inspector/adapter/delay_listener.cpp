#include "services/inspector/adapter/delay_listener.h"

#include <set>
#include <stdexcept>

#include "common/base/text.h"
#include "common/dds/convert.h"
#include "services/inspector/adapter/machine.h"

namespace thalweg::inspector {
namespace {

FieldPath StampOf(const OpenTopic& topic) {
  auto stamp = FieldPath::Parse(topic.schema, "header.stamp");
  if (!stamp) throw std::runtime_error(topic.info.name + " has no header, so its delay is not known");
  return *std::move(stamp);
}

std::optional<FieldPath> ServiceOf(const Schema& schema) {
  auto service = FieldPath::Parse(schema, "service");
  const bool is_text =
      service && service->type().arity == Arity::kOne && service->type().kind == Kind::kString;
  return is_text ? std::optional(*std::move(service)) : std::nullopt;
}

}  // namespace

DelayListener::DelayListener(dds::Bus& bus, const OpenTopic& topic, std::size_t most_messages,
                             bool machine_clock)
    : bus_(bus),
      stamp_(StampOf(topic)),
      service_(ServiceOf(topic.schema)),
      delay_(most_messages, machine_clock),
      listener_(bus, topic,
                [this](const Value& message, const dds::RawSample& sample) { OnMessage(message, sample); }) {
  bus.SubscribeBytes(dds::InfoOf<dds::topics::Clock>(), [this](const dds::RawSample& sample) {
    const auto message = dds::Decode<dds::topics::Clock>(sample.bytes);
    const auto time = message ? dds::FromIdl(message->clock()) : Result<Time>(Error{"not decoded"});
    if (time) delay_.SetRunTime(*time);
  });
}

void DelayListener::OnMessage(const Value& message, const dds::RawSample& sample) {
  const auto stamp = stamp_.In(message);
  if (stamp) delay_.Add(StampIn(*stamp), sample.reception_stamp, [&] { return SenderOf(message); });
}

std::string DelayListener::SenderOf(const Value& message) const {
  if (service_) {
    const auto service = service_->In(message);
    if (service && !service->text().empty()) return CleanText(service->text());
  }
  const std::set<std::string> writers = WritersOf(listener_.topic().info.name, bus_.Graph());
  return (writers.size() > 1 ? "one of " : "") + Joined(writers);
}

std::optional<std::string> DelayListener::Report() {
  return report_.Text(OtherHostsOf(listener_.topic().info.name, bus_.Graph(), OwnHost()));
}

}  // namespace thalweg::inspector
