#include "services/inspector/core/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "common/base/text.h"

namespace thalweg::inspector {
namespace {

constexpr std::array<std::pair<std::string_view, Kind>, 12> kBasicTypes = {{{"bool", Kind::kBool},
                                                                            {"int8", Kind::kInt8},
                                                                            {"uint8", Kind::kUint8},
                                                                            {"int16", Kind::kInt16},
                                                                            {"uint16", Kind::kUint16},
                                                                            {"int32", Kind::kInt32},
                                                                            {"uint32", Kind::kUint32},
                                                                            {"int64", Kind::kInt64},
                                                                            {"uint64", Kind::kUint64},
                                                                            {"float32", Kind::kFloat32},
                                                                            {"float64", Kind::kFloat64},
                                                                            {"string", Kind::kString}}};

/// Cuts the text before the first `mark` off and returns it.
std::string_view TakeUntil(std::string_view& text, char mark) {
  const std::size_t end = std::min(text.find(mark), text.size());
  const std::string_view taken = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return taken;
}

bool IsName(std::string_view text) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789";
  return !text.empty() && text.find_first_not_of(kLetters) == std::string_view::npos &&
         (text[0] < '0' || text[0] > '9');
}

std::optional<std::uint64_t> UnsignedIn(std::string_view text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (text.empty() || rest != end || error != std::errc()) return std::nullopt;
  return number;
}

/// A field whose type is still a name.
struct OpenField {
  Field field;
  std::string type_name;  ///< A message's; empty if the type is a basic one.
};

/// Reads the lines of definitions; refers to other types by name until all are known.
class DefinitionReader {
 public:
  explicit DefinitionReader(std::string_view type) {
    std::string name(type);
    if (const std::size_t middle = name.find("/msg/"); middle != std::string::npos) name.erase(middle, 4);
    Begin(name);
  }

  std::optional<Error> ReadLine(std::string_view line) {
    ++line_;
    line = Trimmed(line.substr(0, line.find('#')));
    if (line.empty() || line.find_first_not_of('=') == std::string_view::npos) return std::nullopt;
    if (line.starts_with("MSG:")) {
      Begin(std::string(Trimmed(line.substr(4))));
      return std::nullopt;
    }
    const std::size_t gap = line.find_first_of(" \t");
    if (gap == std::string_view::npos) return Fail("expected a type and a name");
    const std::string_view type = line.substr(0, gap);
    const std::string_view rest = Trimmed(line.substr(gap));
    return rest.find('=') == std::string_view::npos ? ReadField(type, rest) : ReadConstant(rest);
  }

  /// The messages, with each reference resolved.
  Result<std::vector<MessageType>> Finish() {
    for (std::size_t k = 0; k < messages_.size(); ++k) {
      if (open_[k].empty()) return Error{messages_[k].name + " has no fields"};
      for (OpenField& open : open_[k]) {
        if (!open.type_name.empty()) {
          const auto found = std::ranges::find(messages_, open.type_name, &MessageType::name);
          if (found == messages_.end()) {
            return Error{messages_[k].name + '.' + open.field.name + ": the type " + open.type_name +
                         " is not defined"};
          }
          open.field.type.message = static_cast<std::size_t>(found - messages_.begin());
        }
        messages_[k].fields.push_back(std::move(open.field));
      }
    }
    return std::move(messages_);
  }

 private:
  Error Fail(const std::string& text) const { return {"line " + std::to_string(line_) + ": " + text}; }

  void Begin(std::string name) {
    messages_.push_back({.name = std::move(name), .fields = {}});
    open_.emplace_back();
    constants_.clear();
  }

  std::optional<Error> ReadConstant(std::string_view rest) {
    const std::string_view name = Trimmed(TakeUntil(rest, '='));
    if (!IsName(name)) return Fail("the constant's name is not a word");
    if (const auto value = UnsignedIn(Trimmed(rest))) constants_.push_back({std::string(name), *value});
    return std::nullopt;  // constants of other types name no values of a field
  }

  std::optional<Error> ReadField(std::string_view type, std::string_view name) {
    OpenField open;
    if (!IsName(name)) return Fail(fmt::format("expected a name, found \"{}\"", name));
    open.field.name = name;
    open.field.constants = std::exchange(constants_, {});
    if (const std::size_t bracket = type.find('['); bracket != std::string_view::npos) {
      if (!type.ends_with(']')) return Fail("expected ] at the end of the type");
      const std::string_view length = type.substr(bracket + 1, type.size() - bracket - 2);
      open.field.type.arity = length.empty() ? Arity::kSequence : Arity::kArray;
      if (!length.empty()) {
        const auto number = UnsignedIn(length);
        constexpr std::uint64_t kLongest = 1U << 20;  // of a fixed array, which a message holds in full
        if (!number || *number == 0 || *number > kLongest) {
          return Fail(fmt::format("\"{}\" is not the length of an array", length));
        }
        open.field.type.length = *number;
      }
      type = type.substr(0, bracket);
    }
    const auto* const basic = std::ranges::find(kBasicTypes, type, &std::pair<std::string_view, Kind>::first);
    if (basic != kBasicTypes.end()) {
      open.field.type.kind = basic->second;
    } else {
      open.type_name = type;
    }
    open_.back().push_back(std::move(open));
    return std::nullopt;
  }

  std::vector<MessageType> messages_;
  std::vector<std::vector<OpenField>> open_;  ///< By message.
  std::vector<Constant> constants_;           ///< Those read since the last field.
  int line_ = 0;
};

/// Messages are read and printed by recursion.
constexpr int kDeepest = 64;

struct Visit {
  enum class State { kOpen, kEntered, kLeft };
  State state = State::kOpen;
  int levels = 0;  ///< How many of types there are below this one, once left.
};

/// Fails if a type contains itself, which no message can, or if types are nested deeper than kDeepest.
/// @return How many levels of types there are below the type.
Result<int> LevelsBelow(const std::vector<MessageType>& messages, std::size_t at, int depth,
                        std::vector<Visit>& visits) {
  Visit& visit = visits[at];
  if (visit.state == Visit::State::kEntered) return Error{messages[at].name + " contains itself"};
  if (depth + visit.levels > kDeepest) {
    return Error{"types are nested deeper than " + std::to_string(kDeepest)};
  }
  if (visit.state == Visit::State::kLeft) return visit.levels;
  visit.state = Visit::State::kEntered;
  for (const Field& field : messages[at].fields) {
    if (field.type.kind != Kind::kMessage) continue;
    const Result<int> below = LevelsBelow(messages, field.type.message, depth + 1, visits);
    if (!below) return below;
    visit.levels = std::max(visit.levels, *below + 1);
  }
  visit.state = Visit::State::kLeft;
  return visit.levels;
}

}  // namespace

Result<Schema> Schema::Parse(std::string_view type, std::string_view text) {
  const auto failed = [&](const std::string& why) {
    return Error{"the definition of " + std::string(type) + ": " + why};
  };
  DefinitionReader reader(type);
  while (!text.empty()) {
    if (const auto error = reader.ReadLine(TakeUntil(text, '\n'))) return failed(error->text);
  }
  auto messages = reader.Finish();
  if (!messages) return failed(messages.error());
  std::vector<Visit> visits(messages->size());
  if (const auto levels = LevelsBelow(*messages, 0, 0, visits); !levels) return failed(levels.error());
  Schema schema;
  schema.messages_ = *std::move(messages);
  return schema;
}

std::string Schema::NameOf(const FieldType& type) const {
  std::string name;
  if (type.kind == Kind::kMessage) {
    name = message(type).name;
  } else {
    name = std::ranges::find(kBasicTypes, type.kind, &std::pair<std::string_view, Kind>::second)->first;
  }
  if (type.arity == Arity::kSequence) name += "[]";
  if (type.arity == Arity::kArray) name += '[' + std::to_string(type.length) + ']';
  return name;
}

}  // namespace thalweg::inspector
