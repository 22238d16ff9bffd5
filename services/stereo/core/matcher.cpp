#include "services/stereo/core/matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/base/size_text.h"
#include "services/stereo/core/census.h"
#include "services/stereo/core/opencv_matchers.h"
#include "services/stereo/core/sad5.h"
#include "services/stereo/core/sad5_thesis.h"
#include "services/stereo/core/semi_global.h"

namespace thalweg::stereo {
namespace {

constexpr double kHardlyAny = 0.01;

struct Engine {
  std::string_view name;
  std::unique_ptr<Matcher> (*make)(MatcherOptions);
};

template <Prefilter kKind>
std::unique_ptr<Matcher> MakeSad5(MatcherOptions options) {
  options.sad5.prefilter.kind = kKind;
  return std::make_unique<Sad5>(options);
}

std::unique_ptr<Matcher> MakeSad5OfTheThesis(MatcherOptions options) {
  options.sad5 = AsTheThesisPrints(options.sad5);
  return std::make_unique<Sad5>(options);
}

constexpr std::array kEngines = {
    Engine{"sad5-dog", MakeSad5<Prefilter::kDifferenceOfGaussians>},
    Engine{"sad5-log", MakeSad5<Prefilter::kLaplacianOfGaussian>},
    Engine{"sad5-bilateral", MakeSad5<Prefilter::kBilateral>},
    Engine{"sad5-none", MakeSad5<Prefilter::kNone>},
    Engine{"sad5-thesis", MakeSad5OfTheThesis},
    Engine{"opencv-bm", [](MatcherOptions options) { return MakeOpenCvBlockMatcher(options); }},
    Engine{"opencv-sgbm", [](MatcherOptions options) { return MakeOpenCvSemiGlobalMatcher(options); }},
    Engine{kBestEngine,
           [](MatcherOptions options) -> std::unique_ptr<Matcher> {
             return std::make_unique<SemiGlobal>(options);
           }},
};

std::string SizeOf(const ByteImage& image) {
  return SizeText(image.width(), image.height());
}

}  // namespace

std::span<const std::string_view> EngineNames() {
  static constexpr auto kNames = [] {
    std::array<std::string_view, kEngines.size()> names;
    std::transform(kEngines.begin(), kEngines.end(), names.begin(), [](const Engine& e) { return e.name; });
    return names;
  }();
  return kNames;
}

std::unique_ptr<Matcher> MakeMatcher(std::string_view engine, const MatcherOptions& options) {
  if (options.max_disparity < 1 || options.max_disparity > 256) {
    throw std::invalid_argument("max_disparity is " + std::to_string(options.max_disparity) +
                                ", must be 1 to 256");
  }
  if (options.threads < 0) {
    throw std::invalid_argument("threads is " + std::to_string(options.threads) + ", must be >= 0");
  }
  const auto* const found =
      std::find_if(kEngines.begin(), kEngines.end(), [&](const Engine& e) { return e.name == engine; });
  if (found != kEngines.end()) return found->make(options);
  std::string known;
  for (const Engine& e : kEngines) known += (known.empty() ? "" : ", ") + std::string(e.name);
  throw std::invalid_argument("engine is \"" + std::string(engine) + "\", must be one of " + known);
}

DisparityMap Matcher::Match(const ByteImage& left, const ByteImage& right) {
  CheckPair(left, right);
  if (LookSwapped(ToGray(left), ToGray(right), max_disparity_)) {
    return {left.width(), left.height(), 1, kNoDisparity};
  }
  return Find(left, right);
}

double Density(const DisparityMap& disparity) {
  const auto matched =
      std::count_if(disparity.data().begin(), disparity.data().end(), [](float d) { return !std::isnan(d); });
  return static_cast<double>(matched) / static_cast<double>(disparity.data().size());
}

std::string WhyNoMatches(const DisparityMap& disparity, const ByteImage& left, const ByteImage& right,
                         int max_disparity) {
  if (Density(disparity) > kHardlyAny) return "";
  if (LookSwapped(ToGray(left), ToGray(right), max_disparity)) {
    return "almost no matches: left and right look swapped";
  }
  return "almost no matches: are the images not rectified, taken at different times or without texture, or "
         "are the disparities not below " +
         std::to_string(max_disparity) + "?";
}

void CheckPair(const ByteImage& left, const ByteImage& right) {
  if (left.empty()) throw std::invalid_argument("left image is " + SizeOf(left));
  if (!left.SameSizeAs(right) || left.channels() != right.channels()) {
    throw std::invalid_argument("left image is " + SizeOf(left) + " with " + std::to_string(left.channels()) +
                                " channels, right image " + SizeOf(right) + " with " +
                                std::to_string(right.channels()));
  }
  if (left.channels() != 1 && left.channels() != 3) {
    throw std::invalid_argument("images have " + std::to_string(left.channels()) +
                                " channels, must be 1 or 3");
  }
}

}  // namespace thalweg::stereo
