#include "services/recorder/adapter/recording_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/base/megabytes.h"
#include "common/base/version.h"
#include "common/files/write_file.h"

namespace thalweg::recorder {

std::uintmax_t AvailableIn(const std::filesystem::path& folder) {
  std::error_code unknown;
  const std::filesystem::space_info space = std::filesystem::space(folder, unknown);
  return unknown ? std::numeric_limits<std::uintmax_t>::max() : space.available;
}

RecordingFile::RecordingFile(RecordingOptions options, std::vector<Channel> channels)
    : options_(std::move(options)), channels_(std::move(channels)) {
  if (options_.file.extension() != ".mcap") options_.file += ".mcap";
  RequireFolder();
  if (is_split()) RequireUnusedNames();
  Open();
}

/// A folder of a mistyped name, or of a disk that is not mounted, would take a long recording without a word.
void RecordingFile::RequireFolder() const {
  const std::filesystem::path folder = options_.file.parent_path();
  std::error_code unknown;
  if (folder.empty() || std::filesystem::exists(folder, unknown) || unknown) return;
  throw std::runtime_error(options_.file.string() + ": cannot be written: there is no folder " +
                           folder.string());
}

/// An old part that came up later would end the recording in the middle.
void RecordingFile::RequireUnusedNames() const {
  const std::filesystem::path folder = options_.file.parent_path();
  for (const auto& entry : std::filesystem::directory_iterator(folder.empty() ? "." : folder)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".mcap" || !stem.starts_with(StemOfParts())) continue;
    const std::string number = stem.substr(StemOfParts().size());
    const bool is_part = !number.empty() && number.find_first_not_of("0123456789") == std::string::npos;
    if (is_part) throw CannotWrite(entry.path(), EEXIST);
  }
}

RecordingFile::~RecordingFile() {
  if (fd_ >= 0) close(fd_);
}

void RecordingFile::Open() {
  std::filesystem::path file = options_.file;
  if (is_split()) {
    file.replace_filename(StemOfParts() + std::to_string(files_.size()) + ".mcap");
  }
  fd_ = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd_ < 0) throw CannotWrite(file, errno);
  files_.push_back(file);
  first_log_time_.reset();
  const std::uint64_t bytes_before = bytes_;
  try {
    WriteHead();
  } catch (...) {
    bytes_ = bytes_before;
    Discard(file);
    files_.pop_back();
    throw;
  }
}

void RecordingFile::WriteHead() {
  writer_.emplace(McapWriter::Options{.compression = options_.compression,
                                      .library = "thalweg " + std::string(Version())},
                  [this](Bytes bytes) { Append(bytes); });
  for (const Metadata& metadata : options_.metadata) writer_->AddMetadata(metadata);
  if (files_.size() == 1) {
    for (const Attachment& attachment : options_.attachments) writer_->AddAttachment(attachment);
  }
  for (const Channel& channel : channels_) writer_->AddChannel(channel);
}

void RecordingFile::Discard(const std::filesystem::path& file) {
  if (fd_ >= 0) close(std::exchange(fd_, -1));
  unlink(file.c_str());
}

void RecordingFile::DiscardAll() {
  for (const std::filesystem::path& file : files_) Discard(file);
  files_.clear();
}

std::size_t RecordingFile::AddChannel(const Channel& channel) {
  channels_.push_back(channel);
  writer_->AddChannel(channel);
  return channels_.size() - 1;
}

void RecordingFile::Append(Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw CannotWrite(files_.back(), errno);
    bytes_ += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void RecordingFile::SplitIfDue(Time log_time) {
  if (!first_log_time_) return;
  const bool is_full = options_.split_bytes > 0 && writer_->bytes_written() >= options_.split_bytes;
  const bool is_long =
      options_.split_after > Duration::zero() && log_time - *first_log_time_ >= options_.split_after;
  if (!is_full && !is_long) return;
  Close();
  Open();
  WriteHeld(log_time);
}

void RecordingFile::WriteHeld(Time log_time) {
  for (const HeldMessages::Item& item : held_.Items()) {
    writer_->Write(static_cast<std::uint16_t>(item.channel), item.sequence, log_time, item.publish_time,
                   item.payload);
  }
}

void RecordingFile::Hold(std::size_t channel, const dds::TopicInfo& topic) {
  if (is_split()) held_.Hold(channel, topic);
}

void RecordingFile::Write(std::size_t channel, std::uint32_t sequence, Time log_time, Time publish_time,
                          Bytes payload) {
  SplitIfDue(log_time);
  if (!first_log_time_) first_log_time_ = log_time;
  if (!unflushed_since_) unflushed_since_ = std::chrono::steady_clock::now();
  writer_->Write(static_cast<std::uint16_t>(channel), sequence, log_time, publish_time, payload);
  held_.Take(channel, sequence, log_time, publish_time, payload);
}

void RecordingFile::FlushIfDue() {
  if (!unflushed_since_) return;
  // The first message is flushed at once: within a period, a recording could fill a disk with little room.
  if (has_flushed_ && std::chrono::steady_clock::now() - *unflushed_since_ < kFlushPeriod) return;
  writer_->Flush();
  has_flushed_ = true;
  unflushed_since_.reset();
  RequireRoom();
}

void RecordingFile::RequireRoom() {
  const std::filesystem::path folder = files_.back().parent_path();
  if (options_.available(folder.empty() ? "." : folder) >= options_.keep_free) return;
  Close();
  throw std::runtime_error(files_.back().string() + ": ends here, since less than " +
                           std::to_string(options_.keep_free / kMegabyte) + " MB are free on its disk");
}

void RecordingFile::Close() {
  writer_->Close();
  writer_.reset();
  unflushed_since_.reset();
  const int fd = std::exchange(fd_, -1);
  // Some file systems report only here that there was no room.
  if (close(fd) != 0) throw CannotWrite(files_.back(), errno);
}

}  // namespace thalweg::recorder
