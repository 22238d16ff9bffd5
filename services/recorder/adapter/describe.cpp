#include "services/recorder/adapter/describe.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/megabytes.h"
#include "common/base/text.h"

namespace thalweg::recorder {
namespace {

std::string DateOf(Time time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(
      std::chrono::time_point_cast<std::chrono::system_clock::duration>(time));
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(seconds));
}

std::string FirstLineOf(const std::string& text) {
  const std::size_t end = text.find('\n');
  return end == std::string::npos ? text : text.substr(0, end) + " ...";
}

/// "12 chunks by zstd, 31 % of 45.2 MB"
std::string ChunksOf(const McapReader& reader) {
  std::set<std::string> compressions;
  double compressed = 0.0;
  double uncompressed = 0.0;
  for (const McapReader::Chunk& chunk : reader.chunks()) {
    compressions.insert(chunk.compression.empty() ? "none" : chunk.compression);
    compressed += static_cast<double>(chunk.compressed);
    uncompressed += static_cast<double>(chunk.uncompressed);
  }
  if (uncompressed == 0.0) return "no chunks";
  return fmt::format("{} chunks by {}, {:.0f} % of {}", reader.chunks().size(), fmt::join(compressions, ", "),
                     100.0 * compressed / uncompressed, MegabytesText(uncompressed));
}

}  // namespace

std::string SecondsText(Duration span) {
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(span).count();
  return fmt::format("{:.3f} s", 1e-3 * static_cast<double>(milliseconds));
}

std::vector<std::string> Describe(const McapReader& reader) {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("written by   {} (profile {})", reader.library(), reader.profile()));
  lines.push_back(fmt::format("size         {}, {}", MegabytesText(static_cast<double>(reader.size())),
                              ChunksOf(reader)));
  if (reader.is_without_summary() && reader.problems().empty()) {
    lines.emplace_back("index        none: written without a summary, read from beginning to end");
  } else if (!reader.has_summary()) {
    lines.push_back(fmt::format("damaged      read without its summary; whole up to byte {} of {}",
                                reader.whole_until(), reader.size()));
  }
  double length = 0.0;
  if (reader.start()) {
    length = Seconds(*reader.end() - *reader.start());
    lines.push_back("begins       " + DateOf(*reader.start()));
    lines.push_back("length       " + SecondsText(*reader.end() - *reader.start()));
  }
  lines.push_back(fmt::format("messages     {}", reader.message_count()));
  for (const Metadata& metadata : reader.metadata()) {
    for (const auto& [key, value] : metadata.pairs) {
      lines.push_back(fmt::format("{:<12} {}: {}", metadata.name, key, FirstLineOf(value)));
    }
  }
  for (const Attachment& attachment : reader.attachments()) {
    lines.push_back(fmt::format("attachment   {} ({}), {}", attachment.name, attachment.media_type,
                                MegabytesText(static_cast<double>(attachment.data.size()))));
  }
  std::size_t width = 0;
  std::vector<std::string> empty;
  for (const auto& [number, channel] : reader.channels()) {
    if (reader.message_counts().contains(number)) width = std::max(width, channel.topic.size());
  }
  for (const auto& [number, channel] : reader.channels()) {
    const auto counted = reader.message_counts().find(number);
    const std::uint64_t count = counted == reader.message_counts().end() ? 0 : counted->second;
    if (count == 0) {
      empty.push_back(channel.topic);
      continue;
    }
    std::string rate;
    if (length > 0.0 && count > 1) rate = fmt::format("{:.1f} Hz", static_cast<double>(count - 1) / length);
    lines.push_back(fmt::format("{:<{}}  {:>8} {:<8} {:>10}  {}", channel.topic, width, count,
                                count == 1 ? "message" : "messages", rate,
                                channel.type.empty() ? channel.message_encoding : channel.type));
  }
  if (!empty.empty()) lines.push_back("no messages  " + Joined(empty));
  for (const std::string& problem : reader.problems().texts()) lines.push_back("wrong        " + problem);
  // Names in a file may hold what a terminal would act on.
  constexpr std::size_t kLongestLine = 1000;
  for (std::string& line : lines) line = CleanText(line, kLongestLine);
  return lines;
}

}  // namespace thalweg::recorder
