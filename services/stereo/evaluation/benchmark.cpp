#include "services/stereo/evaluation/benchmark.h"

#include <fmt/format.h>

#include <cmath>

#include "services/stereo/adapter/ground_truth.h"
#include "services/stereo/adapter/image_files.h"
#include "services/stereo/evaluation/pair.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;

/// The mean over those rows of an engine that have a value; NaN if there are none.
template <class ValueOf>
double MeanOf(const std::vector<BenchmarkRow>& rows, const std::string& engine, ValueOf&& value_of) {
  double sum = 0.0;
  double count = 0.0;
  for (const BenchmarkRow& row : rows) {
    const double value = value_of(row);
    if (row.engine != engine || std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  return sum / count;
}

nlohmann::json JsonPercent(double share) {
  constexpr double kPercent = 100.0;
  return std::isnan(share) ? nlohmann::json() : nlohmann::json(kPercent * share);
}

class Runner {
 public:
  Runner(const BenchmarkOptions& options, const BenchmarkListener& listener)
      : options_(options), listener_(listener) {
    result_.engines = options.engines;
    if (result_.engines.empty()) result_.engines.assign(EngineNames().begin(), EngineNames().end());
  }

  Benchmark Run() {
    for (const std::string& engine : result_.engines) {
      MakeMatcher(engine, options_.matcher);  // throws if there is no such engine
    }
    const PairList list = ReadPairs(options_.dataset / "pairs.csv");
    result_.pairs = list.pairs.size() + list.mistakes.size();
    for (const std::string& mistake : list.mistakes) Note(mistake);
    result_.failed = list.mistakes.size();
    for (const ListedPair& pair : list.pairs) {
      const std::size_t before = result_.mistakes.size();
      try {
        Match(pair);
      } catch (const std::exception& error) {  // one bad pair must not prevent the others
        Note(pair.where + ": " + pair.name + ": " + error.what());
      }
      result_.failed += result_.mistakes.size() > before ? 1 : 0;
    }
    return std::move(result_);
  }

 private:
  void Note(const std::string& mistake) {
    result_.mistakes.push_back(mistake);
    listener_.mistake(mistake);
  }

  void Match(const ListedPair& pair) {
    const fs::path folder = options_.dataset / pair.name;
    const ByteImage left = ReadImage(RequirePicture(folder, "left"));
    const ByteImage right = ReadImage(RequirePicture(folder, "right"));
    const GroundTruth truth = ReadGroundTruth(RequirePicture(folder, "gt"), FindPicture(folder, "gt_right"),
                                              pair.scale, folder, left);
    MatcherOptions matcher_options = options_.matcher;
    matcher_options.max_disparity = pair.max_disparity;
    CheckPair(left, right);
    MakeMatcher(result_.engines.front(), matcher_options);  // throws errors that concern every engine
    for (const std::string& engine : result_.engines) {
      BenchmarkRow row{pair.name, engine, {}, 0.0};
      try {
        const auto matcher = MakeMatcher(engine, matcher_options);
        const DisparityMap disparity = MatchTimed(*matcher, left, right, row.milliseconds);
        row.evaluation = Evaluate(disparity, truth.disparity, truth.masks);
        listener_.row(row);
        const std::string why = WhyNoMatches(disparity, left, right, pair.max_disparity);
        if (!why.empty()) listener_.remark("  " + why + '\n');
        result_.rows.push_back(row);
      } catch (const std::exception& error) {  // a failure of one engine must not prevent the others
        Note(pair.where + ": " + pair.name + ", " + engine + ": " + error.what());
      }
    }
    const std::string beyond = BeyondRange(truth, pair.max_disparity);
    if (!beyond.empty()) listener_.remark(beyond);
  }

  const BenchmarkOptions& options_;
  const BenchmarkListener& listener_;
  Benchmark result_;
};

}  // namespace

Benchmark RunBenchmark(const BenchmarkOptions& options, const BenchmarkListener& listener) {
  return Runner(options, listener).Run();
}

BenchmarkRow MeanRow(const std::vector<BenchmarkRow>& rows, const std::string& engine) {
  const auto mean = [&](double Evaluation::*share) {
    return MeanOf(rows, engine, [share](const BenchmarkRow& row) { return row.evaluation.*share; });
  };
  return {"mean",
          engine,
          {mean(&Evaluation::bad_non_occluded), mean(&Evaluation::bad_near_discontinuities),
           mean(&Evaluation::bad_all), mean(&Evaluation::density), mean(&Evaluation::bad_matched)},
          MeanOf(rows, engine, [](const BenchmarkRow& row) { return row.milliseconds; })};
}

std::string BenchmarkHeading() {
  return fmt::format("{:<18}{:<16}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "pair", "engine", "nonocc %", "disc %",
                     "all %", "density", "matched%", "ms");
}

std::string ToText(const BenchmarkRow& row) {
  const Evaluation& e = row.evaluation;
  return fmt::format("{:<18}{:<16}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9.1f}\n", row.pair, row.engine,
                     PercentText(e.bad_non_occluded), PercentText(e.bad_near_discontinuities),
                     PercentText(e.bad_all), PercentText(e.density), PercentText(e.bad_matched),
                     row.milliseconds);
}

nlohmann::json ToJson(const Benchmark& benchmark) {
  nlohmann::json report;
  report["rows"] = nlohmann::json::array();
  for (const BenchmarkRow& row : benchmark.rows) {
    const Evaluation& e = row.evaluation;
    report["rows"].push_back({{"pair", row.pair},
                              {"engine", row.engine},
                              {"bad_nonocc", JsonPercent(e.bad_non_occluded)},
                              {"bad_disc", JsonPercent(e.bad_near_discontinuities)},
                              {"bad_all", JsonPercent(e.bad_all)},
                              {"density", JsonPercent(e.density)},
                              {"bad_matched", JsonPercent(e.bad_matched)},
                              {"ms", row.milliseconds}});
  }
  if (!benchmark.mistakes.empty()) report["errors"] = benchmark.mistakes;
  return report;
}

}  // namespace thalweg::stereo
