#include "services/inspector/adapter/topic_listener.h"

#include "services/inspector/core/cdr.h"

namespace thalweg::inspector {

TopicListener::TopicListener(dds::Bus& bus, OpenTopic topic, Handler handler)
    : topic_(std::move(topic)), handler_(std::move(handler)) {
  bus.SubscribeBytes(topic_.info, [this](const dds::RawSample& sample) { OnSample(sample); });
}

void TopicListener::OnSample(const dds::RawSample& sample) {
  ++received_;
  const auto message = DecodeCdr(topic_.schema, sample.bytes);
  if (message) return handler_(*message, sample);
  ++malformed_;
  last_error_ = topic_.info.name + ": " + message.error();
}

}  // namespace thalweg::inspector
