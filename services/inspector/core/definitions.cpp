#include "services/inspector/core/definitions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "common/base/text.h"

namespace thalweg::inspector {
namespace {

/// More types than a message has; a folder of definitions may be anything.
constexpr std::size_t kMostTypes = 1000;

std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

std::string ShortType(std::string_view type) {
  std::string name(type);
  if (const std::size_t middle = name.find("/msg/"); middle != std::string::npos) name.erase(middle, 4);
  return name;
}

bool IsBasic(std::string_view type) {
  constexpr std::array<std::string_view, 15> kBasic = {"bool",    "int8",   "uint8",   "int16",  "uint16",
                                                       "int32",   "uint32", "int64",   "uint64", "float32",
                                                       "float64", "string", "wstring", "byte",   "char"};
  return std::ranges::find(kBasic, type) != kBasic.end();
}

/// A line of a .msg file, taken apart.
struct FieldLine {
  std::string type;   ///< Without bounds, array and default.
  std::string array;  ///< "", "[]" or "[3]".
  std::string name;
};

/// Nothing for a line without a field: empty, a comment or a constant.
std::optional<FieldLine> FieldIn(std::string_view line) {
  line = Trimmed(line.substr(0, line.find('#')));
  const std::size_t gap = line.find_first_of(" \t");
  if (gap == std::string_view::npos) return std::nullopt;
  std::string_view type = line.substr(0, gap);
  const std::string_view rest = Trimmed(line.substr(gap));
  const std::string_view name = rest.substr(0, rest.find_first_of(" \t="));
  if (Trimmed(rest.substr(name.size())).starts_with('=')) return std::nullopt;
  FieldLine field{.type = {}, .array = {}, .name = std::string(name)};
  if (const std::size_t bracket = type.find('['); bracket != std::string_view::npos) {
    field.array = type.substr(bracket);
    if (field.array.starts_with("[<=")) field.array = "[]";
    type = type.substr(0, bracket);
  }
  field.type = type.substr(0, type.find("<="));
  return field;
}

}  // namespace

Definitions::Definitions(std::string_view text) {
  std::string* at = nullptr;
  while (!text.empty()) {
    const std::string_view line = TakeLine(text);
    if (line.starts_with("MSG: ")) {
      at = &texts_[std::string(Trimmed(line.substr(5)))];
    } else if (at != nullptr) {
      at->append(line).append("\n");
    }
  }
}

Result<std::string> Definitions::Assemble(std::string_view type, const Lookup& others) const {
  struct Wanted {
    std::string type, by;
  };
  std::vector<Wanted> wanted = {{ShortType(type), {}}};
  std::set<std::string> seen = {wanted.front().type};
  std::string all;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const auto [name, by] = wanted[k];
    const std::size_t slash = name.find('/');
    const std::string package = name.substr(0, slash);
    std::optional<std::string> text;
    if (const auto known = texts_.find(name); known != texts_.end()) {
      text = known->second;
    } else if (slash != std::string::npos) {
      text = others(package, name.substr(slash + 1));
    }
    if (!text)
      return Error{by.empty() ? name + " is not defined"
                              : fmt::format("{}, which {} contains, is not defined", name, by)};
    if (wanted.size() > kMostTypes)
      return Error{fmt::format("{} contains more than {} types", ShortType(type), kMostTypes)};
    if (k > 0) all += fmt::format("{:=<80}\nMSG: {}\n", "", name);
    bool has_fields = false;
    for (std::string_view rest = *text; !rest.empty();) {
      std::optional<FieldLine> field = FieldIn(TakeLine(rest));
      if (!field) continue;
      has_fields = true;
      if (field->type == "byte" || field->type == "char") field->type = "uint8";
      if (!IsBasic(field->type)) {
        if (field->type == "Header") field->type = "std_msgs/Header";
        if (field->type.find('/') == std::string::npos) field->type = package + '/' + field->type;
        field->type = ShortType(field->type);
        if (seen.insert(field->type).second) wanted.push_back({field->type, name});
      }
      all += fmt::format("{}{} {}\n", field->type, field->array, field->name);
    }
    // What ROS 2 sends for a message without fields.
    if (!has_fields) all += "uint8 structure_needs_at_least_one_member\n";
  }
  return all;
}

}  // namespace thalweg::inspector
