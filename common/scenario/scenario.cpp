#include "common/scenario/scenario.h"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "common/base/nearest_name.h"
#include "common/base/text.h"
#include "common/files/write_file.h"
#include "common/scenario/mistakes.h"
#include "common/scenario/shipped_scenarios.h"

namespace thalweg {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::TextFormat;
namespace fs = std::filesystem;

constexpr const char* kDataVariable = "THALWEG_DATA";

std::string FieldsOf(const Descriptor* type) {
  std::string names;
  for (int k = 0; k < type->field_count(); ++k) names += (k == 0 ? "" : ", ") + type->field(k)->name();
  return names;
}

std::string ToText(const Mistake& mistake) {
  return ToString(mistake.field) + ": " + mistake.text;
}

/// "; did you mean NAME?" where a field has nearly that name.
std::string NearestOf(const Descriptor* type, const std::string& name) {
  std::vector<std::string> names;
  for (int k = 0; k < type->field_count(); ++k) names.push_back(type->field(k)->name());
  return DidYouMean(names, name);
}

/// What replaces a field of earlier versions; empty for any other field.
std::string InPlaceOf(const std::string& field) {
  static const std::map<std::string, std::string> kSuccessors = {
      {"DepthSensor.enabled", "depth_source (DEPTH_SENSOR, STEREO or EXTERNAL) outside of this block"},
      {"Flow.sight_worth", "sight_worth_m_per_m2"}};
  const auto successor = kSuccessors.find(field);
  return successor == kSuccessors.end() ? "" : "; use " + successor->second + " instead";
}

/// The first field of that name in any message of a scenario; null if there is none.
const FieldDescriptor* FieldNamed(const std::string& name) {
  const google::protobuf::FileDescriptor* const file = Scenario::descriptor()->file();
  for (int k = 0; k < file->message_type_count(); ++k) {
    if (const auto* const field = file->message_type(k)->FindFieldByName(name)) return field;
  }
  return nullptr;
}

/// Rewords errors such as Protobuf's "Expected double, got: abc" in plain words; other errors are unchanged.
std::string InPlainWords(const std::string& message, const std::string& field) {
  static const std::regex kWrongType(
      "^Expected (?:double|integer|integer or identifier), got: (.*)$|"
      "^Invalid value for boolean field \"\\w+\"\\. Value: (.*)\\.$|"
      "^Unknown enumeration value of (.*) for field \"\\w+\"\\.$");
  const FieldDescriptor* const descriptor = FieldNamed(field);
  std::smatch match;
  if (descriptor == nullptr || !std::regex_match(message, match, kWrongType)) return message;
  const std::string value = match[1].str() + match[2].str() + match[3].str();
  return "is " + value + ", must be " + TypeText(descriptor);
}

/// Collects the errors of Protobuf's parser, in the format of our own.
class ErrorList final : public google::protobuf::io::ErrorCollector {
 public:
  /// @param text     Text being parsed, to find the field in.
  /// @param in_file  Whether lines and columns refer to a file.
  ErrorList(std::string where, const std::string& text, bool in_file)
      : where_(std::move(where)), in_file_(in_file) {
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines_.push_back(line);
  }

  void AddError(int line, google::protobuf::io::ColumnNumber column, const std::string& message) override {
    static const std::regex kUnknown("Message type \"thalweg\\.(\\w+)\" has no field named \"([^\"]+)\"\\.");
    static const std::regex kNamed("field \"(\\w+)\"");
    std::smatch match;
    std::string what = message;
    std::string field = FieldBefore(line, column);
    if (std::regex_search(message, match, kUnknown)) {
      const Descriptor* const type = Scenario::descriptor()->file()->FindMessageTypeByName(match[1].str());
      field = match[2].str();
      what = "no such field in " + match[1].str() + ", which has " + FieldsOf(type) + NearestOf(type, field) +
             InPlaceOf(match[1].str() + '.' + field);
      const std::size_t start = TextBefore(line, column).rfind(field);  // Protobuf points behind it
      if (start != std::string::npos) column = static_cast<int>(start);
    } else if (std::regex_search(message, match, kNamed)) {
      field = match[1].str();
    }
    errors_.append(errors_.empty() ? "" : "\n").append(where_);
    if (in_file_) errors_ += ':' + std::to_string(line + 1) + ':' + std::to_string(column + 1);
    errors_ += ": ";
    if (!field.empty()) errors_ += field + ": ";
    errors_ += InPlainWords(what, field);
  }
  const std::string& errors() const { return errors_; }

 private:
  std::string TextBefore(int line, int column) const {
    const auto index = static_cast<std::size_t>(line);  // huge for -1, which means no line
    return index < lines_.size() ? lines_[index].substr(0, static_cast<std::size_t>(column)) : "";
  }
  /// The last name before this position: the field whose value is wrong.
  std::string FieldBefore(int line, int column) const {
    static const std::regex kName("([A-Za-z_]\\w*)\\s*[:{]?[^A-Za-z_]*$");
    const std::string before = TextBefore(line, column);
    std::smatch match;
    return std::regex_search(before, match, kName) ? match[1].str() : "";
  }

  std::string where_;
  bool in_file_;
  std::vector<std::string> lines_;
  std::string errors_;
};

void ParseFile(const std::string& file, const std::string& text, Message& message,
               TextFormat::ParseInfoTree& locations) {
  ErrorList errors(file, text, true);
  TextFormat::Parser parser;
  parser.RecordErrorsTo(&errors);
  parser.WriteLocationsTo(&locations);
  if (!parser.ParseFromString(text, &message)) throw std::runtime_error(errors.errors());
}

std::string ReadFile(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  return text.str();
}

fs::path FindScenario(const std::string& name_or_file) {
  if (fs::is_regular_file(name_or_file)) return fs::absolute(name_or_file).lexically_normal();
  const fs::path folder = ScenarioFolder();
  const fs::path shipped = folder / (name_or_file + ".txtpb");
  if (fs::is_regular_file(shipped)) return shipped;
  std::vector<std::string> names;
  std::string list;
  for (const ShippedScenario& scenario : ShippedScenarios()) {
    names.push_back(scenario.name);
    list += " " + scenario.name;
  }
  throw std::runtime_error("scenario \"" + name_or_file +
                           "\": no such file, and no scenario of that name in " + folder.string() +
                           ", which has:" + list + DidYouMean(names, name_or_file));
}

/// An override "a.b.c=value", parsed. Throws naming what is wrong with the field.
struct Override {
  std::string text;
  FieldPath field;
  std::string value;

  explicit Override(const std::string& its_text) : text(its_text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw std::runtime_error("--set " + text + ": must be FIELD=VALUE");
    value = text.substr(equals + 1);
    std::istringstream names(text.substr(0, equals));
    const Descriptor* type = Scenario::descriptor();
    for (std::string name; std::getline(names, name, '.');) {
      const FieldDescriptor* const next = type == nullptr ? nullptr : type->FindFieldByName(name);
      if (next == nullptr) throw std::runtime_error(NoSuchField(name, type));
      field.push_back(next);
      type = next->message_type();
    }
    if (field.empty()) throw std::runtime_error("--set " + text + ": names no field");
  }

  void ApplyTo(Scenario& scenario) const {
    Message* message = &scenario;
    for (std::size_t k = 0; k + 1 < field.size(); ++k) {
      message = message->GetReflection()->MutableMessage(message, field[k]);
    }
    const FieldDescriptor* const last = field.back();
    if (last->type() == FieldDescriptor::TYPE_STRING) {
      message->GetReflection()->SetString(message, last, Unquoted(value));
      return;
    }
    const bool nested = last->type() == FieldDescriptor::TYPE_MESSAGE;
    if (nested && value.find_first_of("{<[") == std::string::npos) {
      const std::string group = ToString(field);
      throw std::runtime_error("--set " + text + ": " + group + " is a group; set one of its fields, " +
                               group + '.' + last->message_type()->field(0)->name() +
                               " for example: it has " + FieldsOf(last->message_type()));
    }
    ErrorList errors("--set " + text, last->name() + " " + value, false);
    TextFormat::Parser parser;
    parser.RecordErrorsTo(&errors);
    if (nested && !parser.MergeFromString(last->name() + " " + value, message)) {
      throw std::runtime_error(errors.errors());
    }
    if (!nested && !parser.ParseFieldValueFromString(value, last, message)) {
      const bool number = TypeText(last).ends_with("number");
      throw std::runtime_error("--set " + text + ": " + ToString(field) + ": is \"" + value + "\", must be " +
                               TypeText(last) + (number ? " " + AllowedText(field) : ""));
    }
  }

 private:
  std::string NoSuchField(const std::string& name, const Descriptor* type) const {
    const std::string outer = field.empty() ? "the scenario" : ToString(field);
    if (type == nullptr) return "--set " + text + ": " + outer + " is a value and has no field " + name;
    return "--set " + text + ": " + name + ": no such field in " + outer + ", which has " + FieldsOf(type) +
           NearestOf(type, name) + InPlaceOf(type->name() + '.' + name);
  }
  static std::string Unquoted(const std::string& text) {
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return quoted ? text.substr(1, text.size() - 2) : text;
  }
};

/// Makes the path of the world file absolute.
/// @return What is wrong with it; empty if nothing is.
std::string ResolveWorldFile(const fs::path& scenario_file, Scenario& scenario) {
  if (!scenario.world().has_file()) return "";
  std::string file = scenario.world().file();
  const std::string variable = std::string("${") + kDataVariable + "}";
  if (const std::size_t at = file.find(variable); at != std::string::npos) {
    const char* const data = std::getenv(kDataVariable);
    if (data == nullptr) return "needs the environment variable " + std::string(kDataVariable);
    file.replace(at, variable.size(), data);
  }
  const fs::path absolute = (scenario_file.parent_path() / file).lexically_normal();
  if (!fs::is_regular_file(absolute)) return "is " + absolute.string() + ", which is not a file";
  scenario.mutable_world()->set_file(absolute.string());
  return "";
}

/// Where a field was given its value: in an override, or at a place in the file; empty if it was not given.
/// @param elements  Indices of the repeated fields on its path.
std::string PlaceOf(const FieldPath& field, const std::vector<int>& elements, const std::string& file,
                    const std::vector<Override>& overrides, const TextFormat::ParseInfoTree& locations) {
  if (field.empty()) return "";
  for (auto set = overrides.rbegin(); set != overrides.rend(); ++set) {
    const std::size_t common = std::min(set->field.size(), field.size());
    if (std::equal(set->field.begin(), set->field.begin() + static_cast<std::ptrdiff_t>(common),
                   field.begin())) {
      return "--set " + set->text;
    }
  }
  const TextFormat::ParseInfoTree* tree = &locations;
  auto element = elements.begin();
  const auto index_in = [&](const FieldDescriptor* part) {
    return part->is_repeated() && element != elements.end() ? *element++ : -1;
  };
  for (std::size_t k = 0; k + 1 < field.size() && tree != nullptr; ++k) {
    tree = tree->GetTreeForNested(field[k], index_in(field[k]));
  }
  if (tree == nullptr) return "";
  const TextFormat::ParseLocation place = tree->GetLocation(field.back(), index_in(field.back()));
  return place.line < 0
             ? ""
             : file + ':' + std::to_string(place.line + 1) + ':' + std::to_string(place.column + 1);
}

}  // namespace

Scenario LoadScenario(const std::string& name_or_file, const std::vector<std::string>& overrides,
                      const ServiceChecks& checks) {
  const fs::path file = FindScenario(name_or_file);
  Scenario scenario;
  TextFormat::ParseInfoTree locations;
  ParseFile(file.string(), ReadFile(file), scenario, locations);
  std::vector<Override> applied;
  for (const std::string& text : overrides) applied.emplace_back(text).ApplyTo(scenario);

  std::vector<Mistake> mistakes =
      MistakesIn(checks.with_defaults ? checks.with_defaults(scenario) : scenario);
  for (Mistake& mistake : UnusedBlocksIn(scenario)) mistakes.push_back(std::move(mistake));
  if (checks.mistakes) {
    for (Mistake& mistake : checks.mistakes(scenario)) mistakes.push_back(std::move(mistake));
  }
  if (const std::string what = ResolveWorldFile(file, scenario); !what.empty()) {
    const FieldDescriptor* const world =
        Scenario::descriptor()->FindFieldByNumber(Scenario::kWorldFieldNumber);
    mistakes.push_back({{world, World::descriptor()->FindFieldByNumber(World::kFileFieldNumber)}, what});
  }
  std::vector<std::string> lines;
  for (const Mistake& mistake : mistakes) {
    std::string place = PlaceOf(mistake.field, mistake.elements, file.string(), applied, locations);
    if (place.empty()) place = PlaceOf(mistake.other, {}, file.string(), applied, locations);
    lines.push_back((place.empty() ? file.string() : place) + ": " + ToText(mistake));
  }
  if (!lines.empty()) throw std::runtime_error(Joined(lines, "\n"));
  return scenario;
}

void CheckScenario(const Scenario& scenario) {
  std::vector<std::string> lines;
  for (const Mistake& mistake : MistakesIn(scenario)) lines.push_back(ToText(mistake));
  if (!lines.empty()) throw std::invalid_argument(Joined(lines, "\n"));
}

void SaveScenario(const Scenario& scenario, const fs::path& file) {
  std::string text;
  TextFormat::PrintToString(scenario, &text);
  WriteFile(file, text);
}

fs::path ScenarioFolder() {
  if (const char* const folder = std::getenv("THALWEG_SCENARIOS")) return folder;
  const fs::path executable = fs::read_symlink("/proc/self/exe");
  const fs::path installed = executable.parent_path().parent_path() / "share" / "thalweg" / "scenarios";
  if (fs::is_directory(installed)) return installed;
  for (fs::path folder = executable.parent_path();; folder = folder.parent_path()) {
    if (fs::is_directory(folder / "deploy" / "scenarios")) return folder / "deploy" / "scenarios";
    if (folder == folder.root_path()) break;
  }
  throw std::runtime_error("no folder " + installed.string() + ", and no deploy/scenarios above " +
                           executable.string() + "; set THALWEG_SCENARIOS");
}

}  // namespace thalweg
