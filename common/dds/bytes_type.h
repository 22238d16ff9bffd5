#pragma once

#include <cstdint>
#include <cstring>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <string>
#include <vector>

namespace thalweg::dds {

/// Type support for samples that pass undecoded: a sample is the vector of bytes that travels, an
/// encapsulation header of 4 bytes and the CDR representation of the message.
class BytesType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  using Sample = std::vector<std::uint8_t>;
  static constexpr std::size_t kHeaderBytes = 4;

  explicit BytesType(const std::string& type_name) {
    setName(type_name.c_str());
    m_typeSize = 1024;  // where buffers start; they grow
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, Payload* payload) override {
    const Sample& bytes = *static_cast<const Sample*>(data);
    if (bytes.size() < kHeaderBytes || bytes.size() > payload->max_size) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = (bytes[1] & 1U) != 0 ? CDR_LE : CDR_BE;
    return true;
  }
  bool deserialize(Payload* payload, void* data) override {
    static_cast<Sample*>(data)->assign(payload->data, payload->data + payload->length);
    return payload->length >= kHeaderBytes;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<const Sample*>(data)->size()); };
  }
  void* createData() override { return new Sample(); }
  void deleteData(void* data) override { delete static_cast<Sample*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
  bool is_bounded() const override { return false; }
};

}  // namespace thalweg::dds
