#include "common/dds/schema_generator/idl_model.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "common/base/text.h"

namespace thalweg::idl {
namespace {

struct Token {
  std::string text;  ///< A word, "::" or one character; empty at the end of the file.
  int line = 0;
  std::vector<std::string> above;  ///< Comments on the lines right above it.
  std::string behind;              ///< The comment behind the last token of a line.
};

bool IsWordCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Cuts the text into tokens and attaches its comments to them.
std::vector<Token> TokensOf(std::string_view text) {
  std::vector<Token> tokens;
  std::vector<std::string> above;
  int last_comment_line = 0;
  std::size_t column_behind = 0;  ///< Where the comment behind the last token begins; 0 = nowhere.
  int line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view row = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (row.starts_with('#')) continue;  // #include
    bool has_token = false;
    for (std::size_t k = 0; k < row.size();) {
      if (std::isspace(static_cast<unsigned char>(row[k])) != 0) {
        ++k;
        continue;
      }
      if (row.substr(k).starts_with("//")) {
        const std::string comment(Trimmed(row.substr(k + 2)));
        if (has_token) {
          tokens.back().behind = comment;
          column_behind = k;
        } else if (column_behind == k && column_behind > 0 && last_comment_line == line - 1) {
          tokens.back().behind += ' ' + comment;
        } else {
          if (last_comment_line != line - 1) above.clear();
          above.push_back(comment);
          column_behind = 0;
        }
        last_comment_line = line;
        break;
      }
      Token token;
      token.line = line;
      if (last_comment_line == line - 1) token.above = above;
      above.clear();
      column_behind = 0;
      has_token = true;
      std::size_t length = 1;
      if (row.substr(k).starts_with("::")) length = 2;
      while (IsWordCharacter(row[k]) && k + length < row.size() && IsWordCharacter(row[k + length])) ++length;
      token.text = row.substr(k, length);
      k += length;
      tokens.push_back(std::move(token));
    }
  }
  tokens.push_back({.text = "", .line = line, .above = {}, .behind = ""});
  return tokens;
}

/// The names of IDL's basic types in ROS 2 message definitions.
const std::map<std::string, std::string>& BasicTypes() {
  static const std::map<std::string, std::string> types = {
      {"boolean", "bool"},  {"octet", "uint8"},     {"char", "uint8"},     {"int8", "int8"},
      {"uint8", "uint8"},   {"short", "int16"},     {"int16", "int16"},    {"unsigned short", "uint16"},
      {"uint16", "uint16"}, {"long", "int32"},      {"int32", "int32"},    {"unsigned long", "uint32"},
      {"uint32", "uint32"}, {"long long", "int64"}, {"int64", "int64"},    {"unsigned long long", "uint64"},
      {"uint64", "uint64"}, {"float", "float32"},   {"double", "float64"}, {"string", "string"}};
  return types;
}

/// The numbers of types in a description [type_description_interfaces/msg/FieldType]; those of our structs
/// have kNested. Arrays and sequences add to them.
constexpr int kNested = 1;
constexpr int kArray = 48;
constexpr int kSequence = 144;
const std::map<std::string, int>& TypeNumbers() {
  static const std::map<std::string, int> numbers = {
      {"int8", 2},  {"uint8", 3},  {"int16", 4},    {"uint16", 5},   {"int32", 6}, {"uint32", 7},
      {"int64", 8}, {"uint64", 9}, {"float32", 10}, {"float64", 11}, {"bool", 15}, {"string", 17}};
  return numbers;
}

}  // namespace

class IdlModel::Parser {
 public:
  Parser(IdlModel& model, std::string file, std::string_view text)
      : model_(model), file_(std::move(file)), tokens_(TokensOf(text)) {}

  void Parse() {
    while (!Next().text.empty()) {
      Expect("module");
      const std::string package = Word();
      Expect("{");
      Expect("module");
      Expect("msg");
      Expect("{");
      prefix_ = package + "/msg/";
      while (Next().text != "}") Declaration();
      for (const char* const end : {"}", ";", "}", ";"}) Expect(end);
    }
  }

 private:
  const Token& Next() const { return tokens_[at_]; }
  std::string Place() const { return file_ + ':' + std::to_string(Next().line); }
  [[noreturn]] void Fail(const std::string& expected) const {
    const std::string found = Next().text.empty() ? "the end of the file" : '"' + Next().text + '"';
    throw std::runtime_error(Place() + ": expected " + expected + ", found " + found);
  }
  /// Consumes a token; returns the comment behind it.
  std::string Expect(const std::string& text) {
    if (Next().text != text) Fail('"' + text + '"');
    return tokens_[at_++].behind;
  }
  std::string Word() {
    if (Next().text.empty() || !IsWordCharacter(Next().text[0])) Fail("a name");
    return tokens_[at_++].text;
  }

  void Declaration() {
    const std::vector<std::string> above = Next().above;
    const std::string kind = Next().text;
    if (kind != "struct" && kind != "enum") Fail("struct or enum");
    ++at_;
    const std::string name = prefix_ + Word();
    if (model_.structs_.contains(name) || model_.enums_.contains(name)) {
      throw std::runtime_error(Place() + ": " + name + " is defined twice");
    }
    const std::string behind = Expect("{");
    if (kind == "enum") {
      Values(model_.enums_[name]);
    } else {
      Struct& made = model_.structs_[name];
      made.above = above;
      if (!behind.empty()) made.above.push_back(behind);
      if (Next().text == "}") Fail("a field");
      while (Next().text != "}") made.fields.push_back(TakeField());
    }
    Expect("}");
    Expect(";");
  }

  void Values(std::vector<Value>& values) {
    for (;;) {
      Value value;
      value.behind = Next().behind;
      value.name = Word();
      const bool more = Next().text == ",";
      if (more) value.behind = Expect(",");
      values.push_back(std::move(value));
      if (!more) return;
    }
  }

  Field TakeField() {
    Field field;
    field.place = Place();
    field.above = Next().above;
    if (Next().text == "sequence") {
      Expect("sequence");
      Expect("<");
      field.type = Type();
      Expect(">");
      field.suffix = "[]";
    } else {
      field.type = Type();
    }
    field.name = Word();
    if (Next().text == "[") {
      if (!field.suffix.empty()) Fail("\";\": an array of sequences has no ROS 2 form");
      Expect("[");
      field.suffix = '[' + Word() + ']';
      Expect("]");
    }
    field.behind = Expect(";");
    return field;
  }

  std::string Type() {
    std::string name = Word();
    while (name == "unsigned" || name == "unsigned long" || name == "long") {
      if (Next().text != "long" && Next().text != "short") break;
      name += ' ' + Word();
    }
    if (const auto basic = BasicTypes().find(name); basic != BasicTypes().end()) return basic->second;
    if (Next().text != "::") return prefix_ + name;
    while (Next().text == "::") {
      Expect("::");
      name += '/' + Word();
    }
    return name;
  }

  IdlModel& model_;
  std::string file_;
  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  std::string prefix_;
};

void IdlModel::Add(const std::string& file, std::string_view text) {
  Parser(*this, file, text).Parse();
}

std::vector<std::string> IdlModel::Structs() const {
  std::vector<std::string> names;
  for (const auto& [name, made] : structs_) names.push_back(name);
  return names;
}

void IdlModel::AppendDefinition(const std::string& name, std::string& out,
                                std::vector<std::string>& needed) const {
  const Struct& made = structs_.at(name);
  for (const std::string& comment : made.above) out += "# " + comment + '\n';
  std::set<std::string> shown;  // enums, whose constants stand before their first field
  for (const Field& field : made.fields) {
    for (const std::string& comment : field.above) out += "# " + comment + '\n';
    std::string type = field.type;
    if (const auto enumeration = enums_.find(type); enumeration != enums_.end()) {
      int number = 0;
      if (shown.insert(type).second) {
        for (const Value& value : enumeration->second) {
          out += "uint32 " + value.name + "=" + std::to_string(number++);
          out += value.behind.empty() ? "\n" : "  # " + value.behind + '\n';
        }
      }
      type = "uint32";
    } else if (type.find('/') != std::string::npos) {
      if (!structs_.contains(type)) {
        throw std::runtime_error(field.place + ": the type " + type + " is not defined");
      }
      if (std::ranges::find(needed, type) == needed.end()) needed.push_back(type);
      type.erase(type.find("/msg/"), 4);  // PACKAGE/NAME
    }
    out += type + field.suffix + ' ' + field.name;
    out += field.behind.empty() ? "\n" : "  # " + field.behind + '\n';
  }
}

bool IdlModel::AddContained(const std::string& name, std::set<std::string>& contained) const {
  bool has_enum = false;
  for (const Field& field : structs_.at(name).fields) {
    if (TypeNumbers().contains(field.type)) continue;
    if (enums_.contains(field.type)) {
      has_enum = true;
    } else if (!structs_.contains(field.type)) {
      throw std::runtime_error(field.place + ": the type " + field.type + " is not defined");
    } else if (contained.insert(field.type).second) {
      has_enum = AddContained(field.type, contained) || has_enum;
    }
  }
  return has_enum;
}

std::string IdlModel::DescriptionAlone(const std::string& name) const {
  std::string out = R"({"type_name": ")" + name + R"(", "fields": [)";
  const char* separator = "";
  for (const Field& field : structs_.at(name).fields) {
    const auto number = TypeNumbers().find(field.type);
    const bool nested = number == TypeNumbers().end();
    int type = nested ? kNested : number->second;
    std::string capacity = "0";
    if (field.suffix == "[]") {
      type += kSequence;
    } else if (!field.suffix.empty()) {
      type += kArray;
      capacity = field.suffix.substr(1, field.suffix.size() - 2);
    }
    out += separator + (R"({"name": ")" + field.name) + R"(", "type": {"type_id": )" + std::to_string(type) +
           R"(, "capacity": )" + capacity + R"(, "string_capacity": 0, "nested_type_name": ")" +
           (nested ? field.type : "") + R"("}})";
    separator = ", ";
  }
  return out + "]}";
}

std::string IdlModel::Description(const std::string& name) const {
  std::set<std::string> contained;  // in alphabetical order, as the description lists them
  if (AddContained(name, contained)) return "";
  std::string out =
      R"({"type_description": )" + DescriptionAlone(name) + R"(, "referenced_type_descriptions": [)";
  const char* separator = "";
  for (const std::string& type : contained) {
    out += separator + DescriptionAlone(type);
    separator = ", ";
  }
  return out + "]}";
}

std::string IdlModel::Ros2Msg(const std::string& name) const {
  std::string out;
  std::vector<std::string> needed = {name};
  for (std::size_t k = 0; k < needed.size(); ++k) {
    const std::string type = needed[k];
    if (k > 0) {
      std::string short_name = type;
      short_name.erase(short_name.find("/msg/"), 4);
      out += std::string(80, '=') + "\nMSG: " + short_name + '\n';
    }
    AppendDefinition(type, out, needed);
  }
  return out;
}

}  // namespace thalweg::idl
