#include "services/stereo/adapter/ground_truth.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/base/size_text.h"
#include "common/base/text.h"
#include "services/stereo/adapter/image_files.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;

constexpr std::array kColumns = {"name", "scale", "max_disparity"};
constexpr std::array kEndings = {".png", ".pgm", ".ppm", ".pfm", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff"};

std::vector<std::string_view> Fields(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(Trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

template <class Number>
std::optional<Number> NumberFrom(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

using Order = std::array<std::size_t, kColumns.size()>;

/// The position of each column if the line is a header.
std::optional<Order> OrderFrom(const std::vector<std::string_view>& headings) {
  Order order{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::find(headings.begin(), headings.end(), kColumns[i]);
    if (found == headings.end()) return std::nullopt;
    order[i] = static_cast<std::size_t>(found - headings.begin());
  }
  return order;
}

/// Parses a line into `pair`. Returns what is wrong with it; empty if nothing is.
std::string Parse(const std::vector<std::string_view>& fields, const Order& order, std::size_t columns,
                  ListedPair& pair) {
  if (fields.size() != columns) {
    return "has " + std::to_string(fields.size()) + " fields, must have " + std::to_string(columns);
  }
  pair.name = fields[order[0]];
  if (pair.name.empty()) return "name is empty";
  const std::string_view scale = fields[order[1]];
  pair.scale = NumberFrom<double>(scale).value_or(0.0);
  if (!std::isfinite(pair.scale) || pair.scale <= 0.0) {
    return "scale is \"" + std::string(scale) + "\", must be a number > 0";
  }
  const std::string_view most = fields[order[2]];
  pair.max_disparity = NumberFrom<int>(most).value_or(0);
  if (pair.max_disparity <= 0) {
    return "max_disparity is \"" + std::string(most) + "\", must be an integer > 0";
  }
  return "";
}

void RequireSize(const fs::path& file, const auto& image, const ByteImage& left) {
  if (image.SameSizeAs(left)) return;
  throw std::runtime_error(file.string() + ": is " + SizeText(image.width(), image.height()) +
                           ", the left image is " + SizeText(left.width(), left.height()));
}

DisparityMap ReadTruth(const fs::path& file, double scale, const ByteImage& left) {
  DisparityMap truth = ReadScaledDisparity(file, scale);
  RequireSize(file, truth, left);
  if (std::all_of(truth.data().begin(), truth.data().end(), [](float d) { return std::isnan(d); })) {
    throw std::runtime_error(file.string() + ": contains no known disparity");
  }
  return truth;
}

/// Reads a mask if the file exists. In the classic masks, gray means occluded.
bool ReadMask(const fs::path& folder, const std::string& stem, const ByteImage& left, ByteImage& mask) {
  const fs::path file = folder.empty() ? fs::path() : FindPicture(folder, stem);
  if (file.empty()) return false;
  mask = ToGray(ReadImage(file));
  RequireSize(file, mask, left);
  for (std::uint8_t& value : mask.data()) value = value == 255 ? 255 : 0;
  if (std::find(mask.data().begin(), mask.data().end(), 255) == mask.data().end()) {
    throw std::runtime_error(file.string() + ": marks no pixel; pixels that count must be white (255)");
  }
  return true;
}

}  // namespace

PairList ReadPairs(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  PairList list;
  Order order = {0, 1, 2};
  std::size_t columns = kColumns.size();
  bool first = true;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // byte order mark
    if (Trimmed(line).empty()) continue;
    const std::vector<std::string_view> fields = Fields(line);
    if (std::exchange(first, false)) {
      if (const auto named = OrderFrom(fields)) {
        order = *named;
        columns = fields.size();
        continue;
      }
    }
    ListedPair pair;
    pair.where = file.string() + ":" + std::to_string(number);
    const std::string mistake = Parse(fields, order, columns, pair);
    if (mistake.empty()) {
      list.pairs.push_back(pair);
    } else {
      list.mistakes.push_back(pair.where + ": " + mistake);
    }
  }
  if (list.pairs.empty() && list.mistakes.empty())
    throw std::runtime_error(file.string() + ": lists no pairs");
  return list;
}

fs::path FindPicture(const fs::path& folder, const std::string& stem) {
  for (const char* const ending : kEndings) {
    if (fs::path file = folder / (stem + ending); fs::exists(file)) return file;
  }
  return {};
}

fs::path RequirePicture(const fs::path& folder, const std::string& stem) {
  const fs::path file = FindPicture(folder, stem);
  if (file.empty()) {
    throw std::runtime_error((folder / stem).string() +
                             ".*: no such image (.png, .pgm, .ppm, .pfm, .jpg, ...)");
  }
  return file;
}

GroundTruth ReadGroundTruth(const fs::path& file, const fs::path& right, double scale, const fs::path& masks,
                            const ByteImage& images) {
  if (!std::isfinite(scale) || scale <= 0.0) {
    throw std::runtime_error("scale is " + std::to_string(scale) + ", must be a number > 0");
  }
  GroundTruth truth;
  truth.disparity = ReadTruth(file, scale, images);
  std::optional<DisparityMap> of_right;
  if (!right.empty()) of_right = ReadTruth(right, scale, images);
  truth.masks = MasksFrom(truth.disparity, of_right);
  truth.non_occluded_from = of_right ? "both ground truths" : "the left ground truth alone";
  ReadMask(masks, "mask_all", images, truth.masks.all);
  ReadMask(masks, "mask_disc", images, truth.masks.near_discontinuities);
  if (ReadMask(masks, "mask_nonocc", images, truth.masks.non_occluded)) truth.non_occluded_from = "a mask";
  return truth;
}

}  // namespace thalweg::stereo
