#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "common/base/bytes.h"

namespace thalweg::recorder {

// What the MCAP file format, version 0, consists of [https://mcap.dev/spec]: a magic, records, and the magic
// again. A record is its opcode (1 byte), the length of its content (8 bytes) and the content. Messages stand
// in chunks, which may be compressed; the summary at the end says where each chunk is.

inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::uint64_t kRecordHeaderBytes = 9;
inline constexpr std::uint64_t kFooterBytes = kRecordHeaderBytes + 20;

enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// One topic of a recording, with the schema of its messages.
struct Channel {
  std::string topic;  ///< With a leading slash, as ROS 2 tools write it: "/depth/points".
  std::string type;   ///< E.g. "sensor_msgs/msg/PointCloud2"; empty = the file gives no schema.
  std::string schema = {};
  std::string schema_encoding = "ros2msg";
  std::string message_encoding = "cdr";
  std::map<std::string, std::string> metadata = {};

  friend bool operator==(const Channel&, const Channel&) = default;
};

/// Named pairs of strings about the whole recording, e.g. the scenario's text.
struct Metadata {
  std::string name;
  std::map<std::string, std::string> pairs;

  friend bool operator==(const Metadata&, const Metadata&) = default;
};

/// A file that was put into the recording, e.g. a calibration.
struct Attachment {
  std::uint64_t log_time_ns = 0;     ///< [ns] When it was put there, since the epoch.
  std::uint64_t create_time_ns = 0;  ///< [ns] When it was made; 0 = unknown.
  std::string name;
  std::string media_type;  ///< E.g. "text/plain".
  Bytes data;              ///< Valid as long as the bytes of the recording from which it was read.

  friend bool operator==(const Attachment& a, const Attachment& b) {
    return a.log_time_ns == b.log_time_ns && a.create_time_ns == b.create_time_ns && a.name == b.name &&
           a.media_type == b.media_type && TextOf(a.data) == TextOf(b.data);
  }
};

}  // namespace thalweg::recorder
