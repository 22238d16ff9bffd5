#include "services/mapper/core/ply_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "common/base/text.h"
#include "services/mapper/core/header_text.h"

namespace thalweg::mapper {
namespace {

constexpr std::size_t kMostPlyElements = 64;  // so that a header cannot keep us busy

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

struct PlyType {
  enum class Kind { kSigned, kUnsigned, kFloat };
  std::string_view name;
  std::string_view other_name;
  std::size_t bytes;
  Kind kind;
};
constexpr std::array kPlyTypes = {
    PlyType{"char", "int8", 1, PlyType::Kind::kSigned},
    PlyType{"uchar", "uint8", 1, PlyType::Kind::kUnsigned},
    PlyType{"short", "int16", 2, PlyType::Kind::kSigned},
    PlyType{"ushort", "uint16", 2, PlyType::Kind::kUnsigned},
    PlyType{"int", "int32", 4, PlyType::Kind::kSigned},
    PlyType{"uint", "uint32", 4, PlyType::Kind::kUnsigned},
    PlyType{"float", "float32", 4, PlyType::Kind::kFloat},
    PlyType{"double", "float64", 8, PlyType::Kind::kFloat},
};

const PlyType* PlyTypeOf(std::string_view name) {
  const auto* const found = std::ranges::find_if(
      kPlyTypes, [&](const PlyType& type) { return type.name == name || type.other_name == name; });
  return found == kPlyTypes.end() ? nullptr : found;
}

struct PlyProperty {
  std::string_view name;
  const PlyType* type = nullptr;
  const PlyType* count_type = nullptr;  ///< Only lists have one.
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Index among the properties; nothing if there is none of this name and kind.
  std::optional<std::size_t> Find(std::string_view property, bool is_list) const {
    for (std::size_t k = 0; k < properties.size(); ++k) {
      if (properties[k].name == property && (properties[k].count_type != nullptr) == is_list) return k;
    }
    return std::nullopt;
  }
};

struct PlyHead {
  std::optional<PlyEncoding> encoding;
  std::vector<PlyElement> elements;
  std::optional<double> map_voxel_size;
};

std::optional<PlyEncoding> PlyEncodingOf(std::string_view name) {
  if (name == "ascii") return PlyEncoding::kAscii;
  if (name == "binary_little_endian") return PlyEncoding::kLittleEndian;
  if (name == "binary_big_endian") return PlyEncoding::kBigEndian;
  return std::nullopt;
}

std::optional<PlyElement> PlyElementIn(std::string_view line) {
  const std::string_view name = TakeWord(line);
  const auto count = NumberIn<std::uint64_t>(Trimmed(line));
  if (name.empty() || !count) return std::nullopt;
  return PlyElement{.name = name, .count = *count, .properties = {}};
}

std::optional<PlyProperty> PlyPropertyIn(std::string_view line) {
  PlyProperty property;
  std::string_view type = TakeWord(line);
  const bool is_list = type == "list";
  if (is_list) {
    property.count_type = PlyTypeOf(TakeWord(line));
    type = TakeWord(line);
  }
  property.type = PlyTypeOf(type);
  property.name = Trimmed(line);
  const bool is_counted = property.count_type != nullptr;
  if (property.type == nullptr || is_list != is_counted || property.name.empty()) return std::nullopt;
  return property;
}

/// Reads one line of the header. Error: what is wrong with it.
std::optional<std::string> ReadPlyLine(std::string_view line, PlyHead& head) {
  std::string_view rest = line;
  const std::string_view key = TakeWord(rest);
  const std::string complaint = "has the line \"" + CleanText(line) + "\" in its header, ";
  if (line.starts_with(kPlyVoxelSize)) {
    head.map_voxel_size = NumberIn(line.substr(kPlyVoxelSize.size()));
    const bool is_size = head.map_voxel_size && std::isfinite(*head.map_voxel_size);
    if (!is_size || *head.map_voxel_size <= 0.0)
      return complaint + "which must state a voxel's edge in meters";
  } else if (key == "format") {
    head.encoding = PlyEncodingOf(TakeWord(rest));
    if (!head.encoding) return complaint + "which is none of the three formats";
  } else if (key == "element") {
    const auto element = PlyElementIn(rest);
    if (!element) return complaint + "which must state a name and a count";
    if (head.elements.size() == kMostPlyElements) return complaint + "one of too many elements";
    if (std::ranges::count(head.elements, element->name, &PlyElement::name) > 0) {
      return complaint + "the second one of this name";
    }
    head.elements.push_back(*element);
  } else if (key == "property") {
    const auto property = PlyPropertyIn(rest);
    if (!property || head.elements.empty()) return complaint + "which must state types and a name";
    head.elements.back().properties.push_back(*property);
  } else if (!key.empty() && key != "comment" && key != "obj_info") {
    return complaint + "which is of no kind that it may have";
  }
  return std::nullopt;
}

/// Takes the header from the front of a file.
Result<PlyHead> TakePlyHead(std::string_view& rest) {
  PlyHead head;
  TakeLine(rest);
  while (const auto line = TakeLine(rest)) {
    if (*line == "end_header") {
      if (!head.encoding) return Error{"has no line \"format\" in its header"};
      return head;
    }
    if (const auto problem = ReadPlyLine(*line, head)) return Error{*problem};
  }
  return Error{"ends before its line \"end_header\""};
}

/// The numbers after the header, in their order. Beyond the end they are zeros, and problem() says so.
class PlyNumbers {
 public:
  PlyNumbers(PlyEncoding encoding, std::string_view rest) : encoding_(encoding), rest_(rest) {}

  double Take(const PlyType& type) {
    return encoding_ == PlyEncoding::kAscii ? TakeText() : TakeBinary(type);
  }

  std::uint64_t TakeCount(const PlyType& type) {
    constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
    const double count = Take(type);
    if (count >= 0.0 && count <= kMost) return static_cast<std::uint64_t>(count);
    Fail("has a list of " + NumberText(count) + " values");
    return 0;
  }

  /// In a text, each record has a line of its own.
  void EndRecord() {
    in_record_ = false;
    if (encoding_ != PlyEncoding::kAscii || !problem_.empty()) return;
    const std::size_t next = rest_.find_first_not_of(" \t\r");
    if (next != std::string_view::npos && rest_[next] != '\n')
      problem_ = "has more values than its header states";
  }

  const std::string& problem() const { return problem_; }

 private:
  double Fail(const std::string& problem) {
    if (problem_.empty()) problem_ = problem;
    return 0.0;
  }

  double TakeText() {
    const std::size_t next = rest_.find_first_not_of(" \t\r");
    if (in_record_ && next != std::string_view::npos && rest_[next] == '\n') {
      return Fail("has fewer values than its header states");
    }
    in_record_ = true;
    std::string_view word = TakeWord(rest_);
    if (word.empty()) return Fail("is cut off");
    const std::string_view whole = word;
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto number = NumberIn(word);
    return number ? *number : Fail("has \"" + CleanText(whole) + "\" for a number");
  }

  double TakeBinary(const PlyType& type) {
    if (rest_.size() < type.bytes) return Fail("is cut off");
    std::uint64_t raw = 0;
    for (std::size_t k = 0; k < type.bytes; ++k) {
      const std::size_t place = encoding_ == PlyEncoding::kLittleEndian ? k : type.bytes - 1 - k;
      raw |= std::uint64_t{static_cast<std::uint8_t>(rest_[k])} << (8 * place);
    }
    rest_.remove_prefix(type.bytes);
    switch (type.kind) {
      case PlyType::Kind::kUnsigned:
        return static_cast<double>(raw);
      case PlyType::Kind::kSigned: {
        const std::size_t unused_bits = 64 - 8 * type.bytes;
        return static_cast<double>(static_cast<std::int64_t>(raw << unused_bits) >> unused_bits);
      }
      case PlyType::Kind::kFloat:
        break;
    }
    if (type.bytes == 8) return std::bit_cast<double>(raw);
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
  }

  PlyEncoding encoding_;
  std::string_view rest_;
  bool in_record_ = false;  ///< Whether a number of the present record has been taken.
  std::string problem_;
};

class PlyReader {
 public:
  PlyReader(const PlyHead& head, std::string_view rest) : head_(head), numbers_(*head.encoding, rest) {
    file_.map_voxel_size = head.map_voxel_size;
  }

  Result<PlyFile> Read() {
    for (const PlyElement& element : head_.elements) {
      if (!ReadElement(element)) return Error{problem_};
    }
    if (!file_.triangles.empty() && first_missing_)
      return Error{"has faces, but no place for vertex " + std::to_string(*first_missing_)};
    if (first_missing_) DropMissing();
    if (file_.points.empty() && !file_.map_voxel_size) return Error{"has no vertices with a place"};
    for (const auto& corners : file_.triangles) {
      const std::uint32_t last = std::ranges::max(corners);
      if (last < file_.points.size()) continue;
      return Error{"has a face with vertex " + std::to_string(last) + ", but only " +
                   std::to_string(file_.points.size()) + " vertices"};
    }
    return std::move(file_);
  }

 private:
  using Index = std::optional<std::size_t>;

  bool FailAll(const char* problem) {
    problem_ = problem;
    return false;
  }
  bool Fail(const PlyElement& element, std::uint64_t record, const std::string& problem) {
    problem_ = problem + ", in " + CleanText(element.name) + ' ' + std::to_string(record) + " of " +
               std::to_string(element.count);
    return false;
  }

  bool ReadElement(const PlyElement& element) {
    if (element.count == 0) return true;
    if (element.properties.empty()) return FailAll("has elements without properties");
    if (element.name == "vertex") return ReadVertices(element);
    if (element.name == "face") return ReadFaces(element);
    if (element.name == "tristrips") return FailAll("has strips of triangles, must have faces");
    return ForEachRecord(element, std::nullopt, [](std::uint64_t) { return true; });
  }

  /// Calls visit(record) with the record's numbers in values_, by property, and those of a list in list_.
  /// Stops where it returns false.
  template <class Visit>
  bool ForEachRecord(const PlyElement& element, const Index& list, Visit&& visit) {
    values_.assign(element.properties.size(), 0.0);
    for (std::uint64_t record = 0; record < element.count; ++record) {
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        if (property.count_type == nullptr) {
          values_[k] = numbers_.Take(*property.type);
        } else {
          TakeList(property, k == list);
        }
      }
      numbers_.EndRecord();
      if (!numbers_.problem().empty()) return Fail(element, record, numbers_.problem());
      if (!visit(record)) return false;
    }
    return true;
  }

  void TakeList(const PlyProperty& property, bool is_kept) {
    if (is_kept) list_.clear();
    const std::uint64_t count = numbers_.TakeCount(*property.count_type);
    for (std::uint64_t k = 0; k < count && numbers_.problem().empty(); ++k) {
      const double value = numbers_.Take(*property.type);
      if (is_kept) list_.push_back(value);
    }
  }

  bool ReadVertices(const PlyElement& element) {
    const std::array<Index, 3> place = {element.Find("x", false), element.Find("y", false),
                                        element.Find("z", false)};
    const std::array<Index, 3> color = {element.Find("red", false), element.Find("green", false),
                                        element.Find("blue", false)};
    const auto is_there = [](const Index& property) { return property.has_value(); };
    if (!std::ranges::all_of(place, is_there)) return FailAll("has vertices without x, y or z");
    const bool has_colors = std::ranges::all_of(color, is_there);
    return ForEachRecord(element, std::nullopt, [&](std::uint64_t record) {
      const Eigen::Vector3d point(values_[*place[0]], values_[*place[1]], values_[*place[2]]);
      if (point.array().isInf().any()) return Fail(element, record, "has an infinite coordinate");
      if (point.hasNaN() && !first_missing_) first_missing_ = record;
      file_.points.push_back(point);
      if (!has_colors) return true;
      std::array<std::uint8_t, 3> channels{};
      for (std::size_t k = 0; k < 3; ++k) {
        const bool is_share = element.properties[*color.at(k)].type->kind == PlyType::Kind::kFloat;
        const double value = std::round(values_[*color.at(k)] * (is_share ? 255.0 : 1.0));
        if (!(value >= 0.0 && value <= 255.0)) return Fail(element, record, "has a color beyond 0 to 255");
        channels.at(k) = static_cast<std::uint8_t>(value);
      }
      file_.colors.push_back({channels[0], channels[1], channels[2]});
      return true;
    });
  }

  /// Some tools write the pixels of a camera's cloud that were not measured, too, as NaN.
  void DropMissing() {
    std::vector<Eigen::Vector3d> points;
    std::vector<Rgb> colors;
    for (std::size_t k = 0; k < file_.points.size(); ++k) {
      if (file_.points[k].hasNaN()) continue;
      points.push_back(file_.points[k]);
      if (!file_.colors.empty()) colors.push_back(file_.colors[k]);
    }
    file_.points = std::move(points);
    file_.colors = std::move(colors);
  }

  bool ReadFaces(const PlyElement& element) {
    Index corners = element.Find("vertex_indices", true);
    if (!corners) corners = element.Find("vertex_index", true);
    if (!corners) return FailAll("has faces without a list vertex_indices");
    return ForEachRecord(element, corners, [&](std::uint64_t record) {
      constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
      for (const double corner : list_) {
        if (!(corner >= 0.0 && corner <= kMost))
          return Fail(element, record, "has a corner that is no vertex");
      }
      const auto corner = [this](std::size_t k) { return static_cast<std::uint32_t>(list_[k]); };
      for (std::size_t k = 2; k < list_.size(); ++k) {
        file_.triangles.push_back({corner(0), corner(k - 1), corner(k)});
      }
      return true;
    });
  }

  const PlyHead& head_;
  PlyNumbers numbers_;
  PlyFile file_;
  std::optional<std::uint64_t> first_missing_;  ///< The first vertex with a NaN.
  std::string problem_;
  std::vector<double> values_;
  std::vector<double> list_;
};

}  // namespace

Result<PlyFile> DecodePly(Bytes bytes) {
  if (!IsPly(bytes)) return Error{"is no PLY: its first line is not \"ply\""};
  std::string_view rest = TextOf(bytes);
  const Result<PlyHead> head = TakePlyHead(rest);
  if (!head) return Error{head.error()};
  return PlyReader(*head, rest).Read();
}

bool IsPly(Bytes bytes) {
  const std::string_view text = TextOf(bytes);
  return text.starts_with("ply\n") || text.starts_with("ply\r\n");
}

}  // namespace thalweg::mapper
