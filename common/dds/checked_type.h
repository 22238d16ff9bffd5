#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <memory>

#include "common/dds/bytes_type.h"

namespace thalweg::dds {

/// Wraps a generated type support and makes it safe against malformed messages: the generated one lets
/// exceptions propagate into Fast DDS, and a sample that cannot be decoded stays in the reader's history
/// forever.
///
/// Threading: deserialize only on the thread that takes samples; everything else on any thread.
class CheckedType : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

  explicit CheckedType(std::unique_ptr<TopicDataType> generated) : generated_(std::move(generated)) {
    setName(generated_->getName());
    m_typeSize = generated_->m_typeSize;
    m_isGetKeyDefined = generated_->m_isGetKeyDefined;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  /// Whether samples are messages, not undecoded bytes.
  bool decodes() const { return dynamic_cast<const BytesType*>(generated_.get()) == nullptr; }
  /// Whether the last sample was decoded successfully. Check once per sample.
  bool last_was_good() const { return last_was_good_; }

  bool serialize(void* data, Payload* payload) override { return generated_->serialize(data, payload); }
  bool deserialize(Payload* payload, void* data) override {
    try {
      last_was_good_ = generated_->deserialize(payload, data);
    } catch (const std::exception&) {
      last_was_good_ = false;
    }
    return true;  // so that the sample is removed from the history
  }
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
  std::unique_ptr<TopicDataType> generated_;
  bool last_was_good_ = true;
};

}  // namespace thalweg::dds
