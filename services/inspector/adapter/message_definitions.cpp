#include "services/inspector/adapter/message_definitions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>

#include "common/dds/schema.h"
#include "services/inspector/core/definitions.h"
#include "services/inspector/core/standard_types.h"

namespace thalweg::inspector {
namespace {

namespace fs = std::filesystem;

/// More than any definition has.
constexpr std::uintmax_t kMostBytes = 1U << 20;

std::vector<fs::path> FoldersIn(const char* variable) {
  std::vector<fs::path> folders;
  const char* const value = std::getenv(variable);
  std::istringstream names(value == nullptr ? "" : value);
  for (std::string name; std::getline(names, name, ':');) {
    if (!name.empty()) folders.emplace_back(name);
  }
  return folders;
}

/// Whether it names a file in a folder, and no other place.
bool IsWord(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) {
    return c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  });
}

std::optional<std::string> TextIn(const fs::path& file) {
  std::error_code error;
  if (const auto size = fs::file_size(file, error); error || size > kMostBytes) return std::nullopt;
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return in ? std::optional(text.str()) : std::nullopt;
}

}  // namespace

std::vector<fs::path> MessageFolders() {
  std::vector<fs::path> folders = FoldersIn("THALWEG_MSG_PATH");
  for (const fs::path& prefix : FoldersIn("AMENT_PREFIX_PATH")) folders.push_back(prefix / "share");
  std::error_code error;
  std::vector<fs::path> distributions;
  for (const auto& entry : fs::directory_iterator("/opt/ros", error)) distributions.push_back(entry.path());
  std::ranges::sort(distributions);
  for (const fs::path& distribution : distributions) folders.push_back(distribution / "share");
  return folders;
}

Result<std::string> MessageDefinition(std::string_view type, const std::vector<fs::path>& folders) {
  const std::string_view own = dds::Ros2MsgSchema(type);
  if (!own.empty()) return std::string(own);
  static const Definitions standard(StandardTypes());
  const auto found = standard.Assemble(
      type, [&](const std::string& package, const std::string& name) -> std::optional<std::string> {
        if (!IsWord(package) || !IsWord(name)) return std::nullopt;
        for (const fs::path& folder : folders) {
          if (auto text = TextIn(folder / package / "msg" / (name + ".msg"))) return text;
        }
        return std::nullopt;
      });
  if (found) return *found;
  std::string places;
  for (const fs::path& folder : folders) places += (places.empty() ? "" : ", ") + folder.string();
  return Error{fmt::format(
      "{}: neither here nor in {}; name the folder that holds PACKAGE/msg/NAME.msg in THALWEG_MSG_PATH",
      found.error(), places.empty() ? "/opt/ros" : places)};
}

}  // namespace thalweg::inspector
