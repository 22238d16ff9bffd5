#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "services/recorder/adapter/held_messages.h"
#include "services/recorder/core/mcap_writer.h"

namespace thalweg::recorder {

/// [byte] What is free on the disk of a folder; the largest number if that is unknown.
std::uintmax_t AvailableIn(const std::filesystem::path& folder);

struct RecordingOptions {
  std::filesystem::path file;
  Compression compression = Compression::kZstd;
  std::uint64_t split_bytes = 0;  ///< [byte] A file that reaches this size is followed by another; 0 = never.
  Duration split_after{0};        ///< The same for the time that its messages span.
  std::vector<Metadata> metadata = {};  ///< Goes into each file.
  /// Go into the first file only, since they may be larger than a file is to become.
  std::vector<Attachment> attachments = {};
  /// [byte] A recording ends while this much is free on its disk, which the run needs for its map and report.
  std::uintmax_t keep_free = 500'000'000;
  std::function<std::uintmax_t(const std::filesystem::path& folder)> available = AvailableIn;
};

/// Writes a recording to FILE.mcap or, if it is split, to FILE_0.mcap, FILE_1.mcap, ... An existing file is
/// not replaced: it is an error at the beginning, whichever of these it is, as is a folder that does not
/// exist. What is older than FlushPeriod is in the hands of the system, and survives a kill.
///
/// Threading: one thread. Errors: everything throws std::runtime_error "FILE: cannot be written: REASON"; the
/// recording is then over, and what it has written remains; a file that could not even be begun does not.
class RecordingFile {
 public:
  static constexpr Duration kFlushPeriod = std::chrono::milliseconds(500);

  RecordingFile(RecordingOptions options, std::vector<Channel> channels);
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  /// @return  The channel's index, for Write.
  std::size_t AddChannel(const Channel& channel);
  /// What holds of the topic (HeldMessages) stands at the beginning of each further file as well, under the
  /// log time at which that begins, so that each can be read on its own. Nothing if the recording is not
  /// split.
  /// @param channel  As for Write.
  void Hold(std::size_t channel, const dds::TopicInfo& topic);
  /// @param channel  Index in the constructor's `channels`, which AddChannel continues.
  void Write(std::size_t channel, std::uint32_t sequence, Time log_time, Time publish_time, Bytes payload);
  /// Call at least ten times a second. Where the disk is nearly full, closes the recording and throws.
  void FlushIfDue();
  void Close();  ///< Writes the summary; nothing may be written afterwards.

  void DiscardAll();  ///< Removes all files; nothing may be written afterwards.

  const std::vector<std::filesystem::path>& files() const { return files_; }
  std::uint64_t bytes_written() const { return bytes_; }  ///< [byte] Size of all files.

 private:
  bool is_split() const { return options_.split_bytes > 0 || options_.split_after > Duration::zero(); }
  std::string StemOfParts() const { return options_.file.stem().string() + '_'; }
  void RequireFolder() const;
  void RequireUnusedNames() const;
  void Open();
  void WriteHead();
  void Discard(const std::filesystem::path& file);
  void Append(Bytes bytes);
  void SplitIfDue(Time log_time);
  void WriteHeld(Time log_time);
  void RequireRoom();

  RecordingOptions options_;
  std::vector<Channel> channels_;
  HeldMessages held_;
  std::vector<std::filesystem::path> files_;
  int fd_ = -1;
  std::optional<McapWriter> writer_;
  std::optional<Time> first_log_time_;  ///< In the current file.
  std::uint64_t bytes_ = 0;             ///< Those on disk, of a write that failed as well.
  std::optional<std::chrono::steady_clock::time_point> unflushed_since_;
  bool has_flushed_ = false;
};

}  // namespace thalweg::recorder
