#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "services/recorder/adapter/recording_file.h"
#include "services/recorder/core/mcap_reader.h"

namespace thalweg::recorder {

struct Copied {
  Problems problems;  ///< What could not be read.
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  std::vector<std::filesystem::path> files = {};
};

/// Writes the selected messages of one or several recordings into another, in order of their log time, with
/// their bytes and times as they are. Topics of one name and type become one. Metadata and attachments of all
/// recordings are kept, after those of `options`. What the parts of a recording repeat at their beginnings
/// stands once.
///
/// Where the selection begins later than a recording, the copy begins with what is said once and holds from
/// then on, under the selection's start as its log time: the last message of each topic that the middleware
/// keeps for late joiners, such as tf_static, and a full copy of map/updates and surface/updates
/// (held_messages.h). If the copy is split, so does each of its files.
///
/// @param names  What problems call the recordings, e.g. by their files; empty = problems do not say which.
/// Throws std::runtime_error if no recording has any of the selected topics, or if the file cannot be
/// written; the unfinished copy is then removed.
Copied Copy(const std::vector<const McapReader*>& recordings, const Selection& selection,
            RecordingOptions options, std::span<const std::string> names = {});

}  // namespace thalweg::recorder
