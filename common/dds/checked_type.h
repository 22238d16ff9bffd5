#pragma once

#include <algorithm>
#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/dds/bytes_type.h"
#include "common/dds/type_support.h"

namespace thalweg::dds {

/// Wraps a generated type support and makes it safe against malformed messages: the generated one lets
/// exceptions propagate into Fast DDS, and a sample that cannot be decoded stays in the reader's history
/// forever.
///
/// Threading: deserialize only on the thread that takes samples; everything else on any thread.
class CheckedType : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

  explicit CheckedType(TypeSupport generated) : generated_(std::move(generated)) {
    setName(generated_->getName());
    m_typeSize = generated_->m_typeSize;
    m_isGetKeyDefined = generated_->m_isGetKeyDefined;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  /// Whether samples are messages, not undecoded bytes.
  bool decodes() const { return dynamic_cast<const BytesType*>(generated_.get()) == nullptr; }
  /// What was wrong with the last sample, which then was not decoded.
  const std::optional<std::string>& last_problem() const { return last_problem_; }
  /// Size of the last sample as it travels [bytes].
  std::size_t last_bytes() const { return last_bytes_; }
  /// Decodes samples of up to this many bytes, or more where another topic of this type allows it.
  void AllowBytes(std::uint32_t bytes) { most_bytes_ = std::max(most_bytes_, bytes); }

  bool serialize(void* data, Payload* payload) override { return generated_->serialize(data, payload); }
  bool deserialize(Payload* payload, void* data) override {
    last_bytes_ = payload->length;
    last_problem_ = Decode(*payload, data);
    return true;  // so that the sample is removed from the history
  }
  /// The inverse of serialize, for what this process has encoded, of whatever size.
  bool DecodeOwn(Payload& payload, void* data) { return generated_->deserialize(&payload, data); }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return generated_->getSerializedSizeProvider(data);
  }
  void* createData() override { return generated_->createData(); }
  void deleteData(void* data) override { generated_->deleteData(data); }
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool force_md5) override {
    return generated_->getKey(data, handle, force_md5);
  }
  bool is_bounded() const override { return generated_->is_bounded(); }

 private:
  std::optional<std::string> Decode(Payload& payload, void* data) {
    if (payload.length > most_bytes_) {
      return std::to_string(payload.length) + " bytes, more than the " + std::to_string(most_bytes_) +
             " that a message of this topic may have";
    }
    try {
      if (generated_->deserialize(&payload, data)) return std::nullopt;
    } catch (const std::exception&) {  // the decoder throws at lengths that the bytes do not hold
    }
    return "bytes that cannot be decoded as this type";
  }

  TypeSupport generated_;
  std::uint32_t most_bytes_ = 0;
  std::size_t last_bytes_ = 0;
  std::optional<std::string> last_problem_;
};

}  // namespace thalweg::dds
