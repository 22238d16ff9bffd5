#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <memory>

namespace thalweg::dds {

/// A generated type support that survives bytes which are no such message: the generated one lets exceptions
/// pass into Fast DDS, and a sample that fails stays in the reader's history for ever.
/// Threading: deserialize only on the thread that takes samples; all else anywhere.
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

  /// Whether the sample deserialised last was good. Asked once a sample.
  bool last_was_good() const { return last_was_good_; }

  bool serialize(void* data, Payload* payload) override { return generated_->serialize(data, payload); }
  bool deserialize(Payload* payload, void* data) override {
    try {
      last_was_good_ = generated_->deserialize(payload, data);
    } catch (const std::exception&) {
      last_was_good_ = false;
    }
    return true;  // so that the sample is taken out
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
