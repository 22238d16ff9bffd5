#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "services/inspector/core/schema.h"
#include "services/inspector/core/value.h"

namespace thalweg::cli {

/// Writes the messages of one topic to files.
///
/// Errors: Write returns why a message was left out; everything else throws std::runtime_error if a file
/// cannot be written.
class TopicWriter {
 public:
  virtual ~TopicWriter() = default;
  virtual std::optional<std::string> Write(Time log_time, const inspector::Value& message) = 0;
  virtual void Finish() = 0;
  virtual std::string files() const = 0;  ///< Without the folder.
};

/// The files and folders of this stem that any writer would write.
std::vector<std::filesystem::path> FilesOf(const std::filesystem::path& folder, const std::string& stem);

/// @param stem  Stem of the files' names.
std::unique_ptr<TopicWriter> MakeTopicWriter(const std::string& type, const inspector::Schema& schema,
                                             const std::filesystem::path& folder, const std::string& stem);

}  // namespace thalweg::cli
