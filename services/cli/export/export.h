#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "services/recorder/core/mcap_reader.h"

namespace thalweg::cli {

/// What became of one topic.
struct ExportedTopic {
  std::string topic;           ///< With a leading slash.
  std::string files;           ///< In the folder: "odometry.tum", "stereo_left/*.png"; empty = none.
  std::uint64_t messages = 0;  ///< Messages that are in these files.
  std::uint64_t left_out = 0;  ///< Messages that are not,
  std::string reason;          ///< and why the first of them is not.
};

struct Exported {
  std::vector<ExportedTopic> topics;  ///< In order of their names.
  recorder::Problems problems;        ///< Chunks and messages of the recording that could not be read.
};

/// Writes the messages of a recording as files that other programs read, each named after its topic with "_"
/// for "/":
/// - odometry and stamped poses: TOPIC.tum, as the TUM RGB-D benchmark and evo have it;
/// - point clouds: a binary PLY each, TOPIC/STAMP.ply, of their finite points, with colors if they have them;
/// - images: a PNG each, TOPIC/STAMP.png, with TOPIC.txt, a line "STAMP FILE" for each as in the TUM RGB-D
///   benchmark. Depth becomes 16 bits in millimeters, 0 where there is none or more than 65.535 m;
/// - all others, and disparities: TOPIC.jsonl, for each message a line {"log_time": SECONDS, "message": ...}
/// as
///   inspector::ToJson writes it.
///
/// Schemas are those of the recording, so that it may be of any program. A message that cannot be decoded, or
/// an image of an encoding that PNG does not have, is left out and counted; a topic all of whose messages are
/// left out gets no file. Where the names of several topics would be the same, as those of /a/b and /a_b, the
/// later ones are numbered: a_b.jsonl, a_b_2.jsonl.
/// Errors: throws std::runtime_error naming the file if one exists already or cannot be written.
Exported Export(const recorder::McapReader& recording, const recorder::Selection& selection,
                const std::filesystem::path& folder);

}  // namespace thalweg::cli
