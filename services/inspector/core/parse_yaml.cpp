#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

#include "services/inspector/core/yaml.h"

namespace thalweg::inspector {
namespace {

constexpr std::string_view kTimeType = "builtin_interfaces/Time";

/// A number of type T; nothing for a text that is none, or outside of its range.
template <class T>
std::optional<T> NumberIn(std::string_view text) {
  if constexpr (std::is_floating_point_v<T>) {
    if (text == ".nan" || text == ".NaN" || text == ".NAN" || text == "nan") {
      return std::numeric_limits<T>::quiet_NaN();
    }
    for (const std::string_view infinity : {".inf", ".Inf", ".INF", "inf"}) {
      if (text == infinity) return std::numeric_limits<T>::infinity();
      if (text.starts_with('-') && text.substr(1) == infinity) return -std::numeric_limits<T>::infinity();
    }
  }
  if (text.starts_with('+')) text.remove_prefix(1);
  T number{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (text.empty() || rest != end || error != std::errc()) return std::nullopt;
  return number;
}

std::optional<Number> BoolIn(const std::string& text) {
  if (text == "true" || text == "True" || text == "1") return std::uint64_t{1};
  if (text == "false" || text == "False" || text == "0") return std::uint64_t{0};
  return std::nullopt;
}

std::optional<Number> NumberOf(Kind kind, const std::string& text) {
  if (kind == Kind::kBool) return BoolIn(text);
  std::optional<Number> number;
  WithTypeOf(kind, [&]<class T>(T) {
    const auto value = NumberIn<T>(text);
    if (!value) return;
    if constexpr (std::is_floating_point_v<T>) {
      number = *value;
    } else if constexpr (std::is_signed_v<T>) {
      number = static_cast<std::int64_t>(*value);
    } else {
      number = static_cast<std::uint64_t>(*value);
    }
  });
  return number;
}

class Parser {
 public:
  Parser(const Schema& schema, Time now) : schema_(schema), now_(now) {}

  bool Read(const FieldType& type, const std::vector<Constant>& constants, const YAML::Node& node,
            Value& out) {
    if (type.arity == Arity::kOne) return ReadOne(type, constants, node, out);
    if (!node.IsSequence()) return Fail("must be a list");
    if (type.arity == Arity::kArray && node.size() != type.length) {
      return Fail("has " + std::to_string(node.size()) + " elements, must have " +
                  std::to_string(type.length));
    }
    Numbers numbers(type.kind);
    std::vector<Value> values;
    std::size_t k = 0;
    const std::size_t outer = path_.size();
    for (const YAML::Node& element : node) {
      path_ += '[' + std::to_string(k++) + ']';
      Value value;
      if (!ReadOne(type.element(), constants, element, value)) return false;
      if (IsNumber(type.kind)) {
        numbers.Append(value.number());
      } else {
        values.push_back(std::move(value));
      }
      path_.resize(outer);
    }
    if (IsNumber(type.kind)) {
      out.content = std::move(numbers);
    } else {
      out.content = std::move(values);
    }
    return true;
  }

  Error error() const { return {path_.empty() ? error_ : path_ + ": " + error_}; }

 private:
  bool Fail(const std::string& text) {
    error_ = text;
    return false;
  }

  bool ReadOne(const FieldType& type, const std::vector<Constant>& constants, const YAML::Node& node,
               Value& out) {
    if (type.kind == Kind::kMessage) return ReadMessage(type, node, out);
    if (!node.IsScalar()) return Fail("must be a single " + schema_.NameOf(type));
    const std::string& text = node.Scalar();
    if (type.kind == Kind::kString) return ReadText(node, out);
    const auto constant = std::ranges::find(constants, text, &Constant::name);
    if (constant != constants.end()) {
      out.content = Number(constant->value);
      return true;
    }
    const auto number = NumberOf(type.kind, text);
    if (!number) return Fail('"' + text + "\" is no " + schema_.NameOf(type));
    out.content = *number;
    return true;
  }

  bool ReadText(const YAML::Node& node, Value& out) {
    if (node.Tag() != "tag:yaml.org,2002:binary") {
      out.content = node.Scalar();
      return true;
    }
    const std::vector<unsigned char> bytes = YAML::DecodeBase64(node.Scalar());
    if (bytes.empty() && !node.Scalar().empty()) return Fail("is not base64");
    out.content = std::string(bytes.begin(), bytes.end());
    return true;
  }

  bool ReadMessage(const FieldType& type, const YAML::Node& node, Value& out) {
    const MessageType& message = schema_.message(type);
    if (message.name == kTimeType && node.IsScalar() && node.Scalar() == "now") {
      const auto seconds = std::chrono::floor<std::chrono::seconds>(now_.time_since_epoch());
      out.content = std::vector<Value>{
          {Number(std::int64_t{seconds.count()})},
          {Number(static_cast<std::uint64_t>((now_.time_since_epoch() - seconds).count()))}};
      return true;
    }
    if (!node.IsMap()) return Fail("must hold the fields of a " + message.name);
    auto& values = out.content.emplace<std::vector<Value>>();
    for (const Field& field : message.fields) values.push_back(ZeroOf(schema_, field.type));
    for (const auto& entry : node) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "?";
      const auto field = std::ranges::find(message.fields, name, &Field::name);
      if (field == message.fields.end()) {
        std::string names;
        for (const Field& known : message.fields) names += (names.empty() ? "" : ", ") + known.name;
        return Fail("a " + message.name + " has no field \"" + name + "\"; its fields are " + names);
      }
      const std::size_t outer = path_.size();
      path_ += (path_.empty() ? "" : ".") + name;
      const auto index = static_cast<std::size_t>(field - message.fields.begin());
      if (!Read(field->type, field->constants, entry.second, values[index])) return false;
      path_.resize(outer);
    }
    return true;
  }

  const Schema& schema_;
  Time now_;
  std::string path_;
  std::string error_;
};

}  // namespace

Result<Value> ParseYaml(const Schema& schema, const std::string& text, Time now) {
  YAML::Node node;
  try {
    node = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    return Error{std::string("not YAML: ") + error.what()};
  }
  Value value;
  if (node.IsNull()) return ZeroOf(schema, schema.root());
  Parser parser(schema, now);
  if (!parser.Read(schema.root(), {}, node, value)) return parser.error();
  return value;
}

}  // namespace thalweg::inspector
