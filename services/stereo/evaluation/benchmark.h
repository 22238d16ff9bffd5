#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "services/stereo/core/evaluation.h"
#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {

/// How well one engine matched one pair of a data set.
struct BenchmarkRow {
  std::string pair;
  std::string engine;
  Evaluation evaluation;
  double milliseconds = 0.0;
};

struct BenchmarkOptions {
  std::filesystem::path
      dataset;  ///< Holds pairs.csv, and a folder a pair: left, right, gt, gt_right or masks.
  std::vector<std::string> engines;  ///< Empty: all there are.
  MatcherOptions matcher;            ///< But for max_disparity, which the data set tells.
};

struct Benchmark {
  std::vector<std::string> engines;
  std::vector<BenchmarkRow> rows;
  std::vector<std::string> mistakes;  ///< What could not be judged, each with its place in pairs.csv.
  std::size_t pairs = 0;              ///< Listed, the lines that are none among them.
  std::size_t failed = 0;             ///< Of those: not judged, or not by every engine.
};

/// Who wants to know about each step as it is made.
struct BenchmarkListener {
  std::function<void(const BenchmarkRow&)> row = [](const auto&) {};
  std::function<void(const std::string&)> remark = [](const auto&) {};  ///< For people, on the rows before.
  std::function<void(const std::string&)> mistake = [](const auto&) {};
};

/// Matches every pair of a data set by every engine. What is wrong with one pair or engine is not the end of
/// the others.
/// Throws std::runtime_error when there is no list of pairs, std::invalid_argument naming an unknown engine.
Benchmark RunBenchmark(const BenchmarkOptions& options, const BenchmarkListener& listener);

/// The means over an engine's rows, each over those that have a value; NaN of none.
BenchmarkRow MeanRow(const std::vector<BenchmarkRow>& rows, const std::string& engine);

/// Lines of a table for people.
std::string BenchmarkHeading();
std::string ToText(const BenchmarkRow& row);

/// {"rows": [...], "errors": [...]}: percentages, null where there was nothing to judge by.
nlohmann::json ToJson(const Benchmark& benchmark);

}  // namespace thalweg::stereo
