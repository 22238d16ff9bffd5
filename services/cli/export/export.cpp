#include "services/cli/export/export.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "common/files/write_file.h"
#include "services/cli/export/topic_writer.h"
#include "services/inspector/core/cdr.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::cli {
namespace {

/// One topic on its way to files. Channels of the same topic and type share one.
struct Output {
  ExportedTopic result;
  std::unique_ptr<inspector::Schema> schema;  ///< At a fixed place, since the writer refers to it.
  std::unique_ptr<TopicWriter> writer;        ///< Null if no message can be read.

  /// @return Why the message is left out, if it is.
  std::optional<std::string> Write(const recorder::Message& message) {
    if (!writer) return result.reason;
    const auto value = inspector::DecodeCdr(*schema, message.payload);
    return value ? writer->Write(message.log_time, *value) : std::optional(value.error());
  }
};

/// "depth_points" for "/depth/points"; whatever else a file's name should not have becomes "_", too.
std::string StemOf(const std::string& topic) {
  std::string stem = topic.starts_with('/') ? topic.substr(1) : topic;
  std::ranges::replace_if(
      stem, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-'; }, '_');
  return stem.empty() ? "_" : stem;
}

/// Stem of the files' names, by topic and type.
using Stems = std::map<std::pair<std::string, std::string>, std::string>;

/// Where the names of several topics would be the same, as those of /a/b and /a_b, the later ones are
/// numbered.
Stems StemsOf(const recorder::McapReader& recording, const recorder::Selection& selection) {
  std::set<std::string> reserved;
  std::vector<const recorder::Channel*> selected;
  for (const auto& [number, channel] : recording.channels()) {
    if (!selection.topics.empty() && !recorder::MatchesAny(selection.topics, channel.topic)) continue;
    selected.push_back(&channel);
    reserved.insert(StemOf(channel.topic));
  }
  Stems stems;
  std::set<std::string> used;
  for (const recorder::Channel* const channel : selected) {
    const auto [known, added] = stems.try_emplace({channel->topic, channel->type}, StemOf(channel->topic));
    if (!added || used.insert(known->second).second) continue;
    const std::string stem = known->second;
    for (int number = 2; reserved.contains(known->second) || !used.insert(known->second).second; ++number) {
      known->second = stem + '_' + std::to_string(number);
    }
  }
  return stems;
}

Output OutputFor(const recorder::Channel& channel, const std::filesystem::path& folder,
                 const std::string& stem) {
  Output output;
  output.result.topic = channel.topic;
  if (channel.message_encoding != "cdr" || channel.schema_encoding != "ros2msg") {
    output.result.reason = "its messages are not CDR with a schema in ros2msg";
    return output;
  }
  auto schema = inspector::Schema::Parse(channel.type, channel.schema);
  if (!schema) {
    output.result.reason = CleanText(schema.error());
    return output;
  }
  output.schema = std::make_unique<inspector::Schema>(*std::move(schema));
  output.writer = MakeTopicWriter(channel.type, *output.schema, folder, stem);
  output.result.files = output.writer->files();
  return output;
}

/// Files of two exports under one name would be taken for one.
void RequireUnusedNames(const Stems& stems, const std::filesystem::path& folder) {
  for (const auto& [topic, stem] : stems) {
    for (const std::filesystem::path& file : FilesOf(folder, stem)) {
      std::error_code unknown;
      if (std::filesystem::exists(file, unknown)) throw CannotWrite(file, EEXIST);
    }
  }
}

/// Files without a message would be taken for an export that went well. None was there before.
void RemoveEmpty(Output& output, const std::vector<std::filesystem::path>& files) {
  output.writer.reset();
  output.result.files.clear();
  std::error_code unknown;
  for (const std::filesystem::path& file : files) std::filesystem::remove(file, unknown);
}

}  // namespace

Exported Export(const recorder::McapReader& recording, const recorder::Selection& selection,
                const std::filesystem::path& folder) {
  const Stems stems = StemsOf(recording, selection);
  RequireUnusedNames(stems, folder);
  std::map<std::string, Output> outputs;  // by stem
  recorder::MessageCursor cursor = recording.Read(selection);
  while (const auto message = cursor.Next()) {
    const recorder::Channel& channel = recording.channels().at(message->channel);
    const std::string& stem = stems.at({channel.topic, channel.type});
    auto found = outputs.find(stem);
    if (found == outputs.end()) found = outputs.emplace(stem, OutputFor(channel, folder, stem)).first;
    Output& output = found->second;
    const auto problem = output.Write(*message);
    if (!problem) {
      ++output.result.messages;
    } else if (output.result.left_out++ == 0) {
      output.result.reason = CleanText(*problem);
    }
  }
  Exported exported{.topics = {}, .problems = cursor.problems()};
  for (auto& [stem, output] : outputs) {
    if (output.result.messages == 0) {
      RemoveEmpty(output, FilesOf(folder, stem));
    } else {
      output.writer->Finish();
    }
    exported.topics.push_back(std::move(output.result));
  }
  std::ranges::sort(exported.topics, {}, &ExportedTopic::topic);
  return exported;
}

}  // namespace thalweg::cli
