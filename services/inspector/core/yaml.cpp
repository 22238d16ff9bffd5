#include "services/inspector/core/yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/binary.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "common/base/text.h"

namespace thalweg::inspector {
namespace {

template <class Float>
std::string FloatText(Float number) {
  if (std::isnan(number)) return ".nan";
  if (std::isinf(number)) return number > 0 ? ".inf" : "-.inf";
  std::string text = fmt::format("{}", number);
  // YAML 1.1 takes a number without a point, 1e-07, for a text.
  if (text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = FirstCharacter(text).bytes;
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

std::string Base64Of(const std::string& bytes) {
  return YAML::EncodeBase64(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

bool HasControls(std::string_view text) {
  while (!text.empty()) {
    const Character first = FirstCharacter(text);
    if (IsControlCharacter(first.code)) return true;
    text.remove_prefix(first.bytes);
  }
  return false;
}

/// Whether a text can stand without quotes and is read as a text by every reader: words of letters, digits
/// and _ - / . that begin with a letter, and are none of those that mean true, false or null.
bool IsPlain(std::string_view text) {
  constexpr std::string_view kWords = " true false null yes no on off y n nan inf ";
  constexpr std::string_view kMarks = "_-/. ";
  if (text.empty() || text.size() > 200 || text.back() == ' ') return false;
  if (std::isalpha(static_cast<unsigned char>(text[0])) == 0) return false;
  std::string folded = " ";
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && kMarks.find(c) == std::string_view::npos)
      return false;
    folded += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text.find("  ") == std::string_view::npos && kWords.find(folded + ' ') == std::string_view::npos;
}

std::string Escaped(std::uint32_t code) {
  switch (code) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default:
      if (code <= 0xFF) return fmt::format("\\x{:02x}", code);
      return code <= 0xFFFF ? fmt::format("\\u{:04x}", code) : fmt::format("\\U{:08x}", code);
  }
}

std::string TextInYaml(const std::string& whole) {
  std::string_view text = whole;
  if (IsPlain(text)) return whole;
  if (!IsUtf8(text)) return "!!binary \"" + Base64Of(whole) + '"';
  std::string out;
  if (!HasControls(text)) {
    for (const char c : text) out += c == '\'' ? "''" : std::string(1, c);
    return '\'' + out + '\'';
  }
  while (!text.empty()) {
    const Character first = FirstCharacter(text);
    if (first.code == '"' || first.code == '\\') {
      out += '\\';
      out += static_cast<char>(first.code);
    } else if (IsControlCharacter(first.code)) {
      out += Escaped(first.code);
    } else {
      out += text.substr(0, first.bytes);
    }
    text.remove_prefix(first.bytes);
  }
  return '"' + out + '"';
}

class Printer {
 public:
  Printer(const Schema& schema, const PrintOptions& options) : schema_(schema), options_(options) {}

  /// What stands behind "name:" or "-", up to and including the line break.
  /// @param indent  Columns at which the lines of the value begin.
  /// @param in_list  Whether the first of these lines is the one of the dash.
  void Print(const FieldType& type, const Value& value, std::size_t indent, bool in_list) {
    if (type.arity != Arity::kOne) return PrintArray(type, value, indent);
    if (type.kind == Kind::kMessage) return PrintFields(type, value, indent, in_list);
    out_ += ' ' + Scalar(type, value) + '\n';
  }

  void PrintFields(const FieldType& type, const Value& value, std::size_t indent, bool in_list) {
    const std::vector<Field>& fields = schema_.message(type).fields;
    bool first = in_list;
    if (!in_list && indent > 0) out_ += '\n';
    for (std::size_t k = 0; k < fields.size(); ++k) {
      out_ += first ? std::string(1, ' ') : std::string(indent, ' ');
      first = false;
      out_ += fields[k].name + ':';
      // A list stands in the column of its name, everything else two columns further.
      Print(fields[k].type, value.values()[k], fields[k].type.arity == Arity::kOne ? indent + 2 : indent,
            false);
    }
  }

  void PrintArray(const FieldType& type, const Value& value, std::size_t indent) {
    const std::size_t count = value.size();
    if (count == 0) {
      out_ += " []\n";
      return;
    }
    if (!options_.arrays) {
      FieldType element = type.element();
      out_ += fmt::format(" '<{} type: {}, length: {}>'\n",
                          type.arity == Arity::kArray ? "array" : "sequence", schema_.NameOf(element), count);
      return;
    }
    if (!out_.empty()) out_ += '\n';
    for (std::size_t k = 0; k < std::min(count, options_.most_elements); ++k) {
      out_ += std::string(indent, ' ') + '-';
      if (IsNumber(type.kind)) {
        out_ += ' ' + Scalar(type.element(), Value{value.numbers().At(k)}) + '\n';
      } else {
        Print(type.element(), value.values()[k], indent + 2, true);
      }
    }
    if (count > options_.most_elements) {
      out_ += fmt::format("{:{}}- '... {} more of {}'\n", "", indent, count - options_.most_elements, count);
    }
  }

  static std::string Scalar(const FieldType& type, const Value& value) {
    if (type.kind == Kind::kString) return TextInYaml(value.text());
    if (type.kind == Kind::kBool) return value.number() == Number(std::uint64_t{0}) ? "false" : "true";
    return YamlNumber(value.number());
  }

  std::string Take() { return std::move(out_); }

 private:
  const Schema& schema_;
  PrintOptions options_;
  std::string out_;
};

}  // namespace

std::string YamlNumber(const Number& number) {
  return std::visit(
      []<class T>(const T value) -> std::string {
        if constexpr (std::is_floating_point_v<T>) return FloatText(value);
        return fmt::format("{}", value);
      },
      number);
}

std::string ToYaml(const Schema& schema, const FieldType& type, const Value& value,
                   const PrintOptions& options) {
  Printer printer(schema, options);
  if (type.arity == Arity::kOne && type.kind != Kind::kMessage) return Printer::Scalar(type, value) + '\n';
  printer.Print(type, value, 0, false);
  std::string text = printer.Take();
  return text.substr(text.find_first_not_of(' '));
}

}  // namespace thalweg::inspector
