#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "services/stereo/core/evaluation.h"
#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {

/// Result of one engine on one pair of a data set.
struct BenchmarkRow {
  std::string pair;
  std::string engine;
  Evaluation evaluation;
  double milliseconds = 0.0;
};

struct BenchmarkOptions {
  std::filesystem::path
      dataset;  ///< Folder with pairs.csv and one folder per pair: left, right, gt, gt_right or masks.
  std::vector<std::string> engines;  ///< Empty = all engines.
  MatcherOptions matcher;            ///< Except max_disparity, which the data set specifies.
};

struct Benchmark {
  std::vector<std::string> engines;
  std::vector<BenchmarkRow> rows;
  std::vector<std::string> mistakes;  ///< What could not be evaluated, each with its place in pairs.csv.
  std::size_t pairs = 0;              ///< Number of pairs listed, including invalid lines.
  std::size_t failed = 0;             ///< Those that were not evaluated with every engine.
};

/// Callbacks that report each step.
struct BenchmarkListener {
  std::function<void(const BenchmarkRow&)> row = [](const auto&) {};
  /// For people, about the previous rows.
  std::function<void(const std::string&)> remark = [](const auto&) {};
  std::function<void(const std::string&)> mistake = [](const auto&) {};
};

/// Matches every pair of a data set with every engine. An error in one pair or engine does not prevent the
/// others. Throws std::runtime_error if there is no list of pairs, std::invalid_argument naming an unknown
/// engine.
Benchmark RunBenchmark(const BenchmarkOptions& options, const BenchmarkListener& listener);

/// The means over an engine's rows, each over those that have a value; NaN if there are none.
BenchmarkRow MeanRow(const std::vector<BenchmarkRow>& rows, const std::string& engine);

/// Lines of a table for people.
std::string BenchmarkHeading();
std::string ToText(const BenchmarkRow& row);

/// {"rows": [...], "errors": [...]}: percentages, null where there was nothing to evaluate.
nlohmann::json ToJson(const Benchmark& benchmark);

}  // namespace thalweg::stereo
