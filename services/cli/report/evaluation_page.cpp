#include "services/cli/report/evaluation_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <regex>

#include "common/base/text.h"
#include "services/cli/report/encoding.h"
#include "services/cli/report/evaluation_tables.h"
#include "services/cli/report/evaluation_verdict.h"
#include "services/cli/report/page_assets.h"
#include "services/cli/report/rounded.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::cli {
namespace {

using evaluator::NamesIn;
using evaluator::Outcome;
using Json = nlohmann::ordered_json;

constexpr std::size_t kCurvePoints = 200;
constexpr std::size_t kPathPoints = 400;

std::vector<const Outcome*> RunsOf(std::span<const Outcome> outcomes, const std::string& scenario,
                                   const std::string& strategy) {
  std::vector<const Outcome*> runs;
  for (const Outcome& outcome : outcomes) {
    if (outcome.scenario == scenario && outcome.strategy == strategy) runs.push_back(&outcome);
  }
  return runs;
}

Json CurveJson(const CoverageCurve& curve) {
  return {{"at", Rounded(curve.at)},
          {"mean", Rounded(curve.mean)},
          {"low", Rounded(curve.low)},
          {"high", Rounded(curve.high)}};
}

/// x, y of some points as 32 bit floats, compressed.
std::string PackedPathOf(const Outcome& outcome) {
  std::vector<float> numbers;
  const std::size_t count = std::min(kPathPoints, outcome.progress.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t n = count > 1 ? k * (outcome.progress.size() - 1) / (count - 1) : 0;
    numbers.push_back(static_cast<float>(outcome.progress[n].p_W.x()));
    numbers.push_back(static_cast<float>(outcome.progress[n].p_W.y()));
  }
  std::vector<std::uint8_t> bytes(numbers.size() * sizeof(float));
  if (!bytes.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return Base64(Deflated(bytes));
}

Json RunOf(const Outcome& outcome) {
  const std::optional<double> to_95 = PathTo(outcome, 0.95);
  return {{"run", outcome.run},
          {"start", outcome.seed},
          {"end", ToText(outcome.end)},
          {"complete", outcome.complete()},
          {"distance_m", Rounded(outcome.distance)},
          {"duration_s", Rounded(outcome.duration)},
          {"to_95_m", Rounded(to_95)},
          {"coverage", Rounded(outcome.coverage)},
          {"collisions", outcome.collisions},
          {"path", PackedPathOf(outcome)}};
}

Json WorldJson(const WorldPicture& world) {
  return {{"png", Base64(world.png)},
          {"min_x", world.min_x},
          {"min_y", world.min_y},
          {"width", world.width},
          {"height", world.height},
          {"lowest", Rounded(world.lowest)},
          {"highest", Rounded(world.highest)}};
}

std::string ClassOf(const std::string& column) {
  static const std::vector<std::string> kWords = {"scenario", "strategy", "path of",
                                                  "stage",    "end",      "reason"};
  return std::ranges::count(kWords, column) > 0 ? " class=\"words\"" : "";
}

/// @param columns  Which of the table's; empty = all.
std::string ToHtml(const Table& table, std::vector<std::size_t> columns = {}) {
  if (columns.empty()) {
    for (std::size_t n = 0; n < table.header.size(); ++n) columns.push_back(n);
  }
  std::string html = "<div class=\"scroll\" tabindex=\"0\"><table>\n";
  const auto add = [&](const Table::Row& row, const char* tag) {
    html += "<tr>";
    for (const std::size_t n : columns) {
      html += fmt::format("<{0}{1}>{2}</{0}>", tag, ClassOf(table.header[n]), EscapedForHtml(row[n]));
    }
    html += "</tr>\n";
  };
  // In C++, since the table is read without its script, too; raised() in page/timeline.js does the same to
  // the sentences of a run's page, which that script writes.
  Table::Row header = table.header;
  for (std::string& name : header) name = std::regex_replace(name, std::regex("m2\\]"), "m²]");
  add(header, "th");
  for (const Table::Row& row : table.rows) add(row, "td");
  return html + "</table></div>\n";
}

std::string Section(const std::string& title, const std::string& content) {
  return "<section><h2>" + EscapedForHtml(title) + "</h2><div class=\"card\">" + content +
         "</div></section>\n";
}

std::string VerdictHtml(std::span<const Outcome> outcomes) {
  std::string html = "<ul class=\"verdict\">\n";
  for (const Verdict& verdict : VerdictsOn(outcomes)) {
    const char* kind = "undecided";
    if (verdict.kind == Verdict::Kind::kShorter || verdict.kind == Verdict::Kind::kFine) kind = "good";
    if (verdict.kind == Verdict::Kind::kLonger || verdict.kind == Verdict::Kind::kTrouble) kind = "warn";
    html += fmt::format("<li class=\"{}\">{}</li>\n", kind, EscapedForHtml(verdict.text));
  }
  return html + "</ul>\n";
}

/// The columns that answer most questions and fit a window, and all of them below.
std::string WithDetails(const Table& table, const std::vector<std::string>& main) {
  std::vector<std::size_t> columns;
  for (std::size_t n = 0; n < table.header.size(); ++n) {
    if (std::ranges::count(main, table.header[n]) > 0) columns.push_back(n);
  }
  return ToHtml(table, columns) + "<details><summary>All figures</summary>" + ToHtml(table) + "</details>";
}

std::string SummaryHtml(const Table& summary) {
  return WithDetails(summary, {"scenario", "strategy", "runs", "complete", "median", "to 90 %", "to 95 %",
                               "to 99 %", "coverage", "nearest", "plan p95 [ms]"});
}

std::string TimeHtml(const Table& time) {
  return WithDetails(time, {"scenario", "strategy", "time [s]", "s to 95 %", "s to 99 %", "moving [s]",
                            "turning [s]", "standing", "stops", "speed [m/s]"});
}

std::string DefinitionsHtml(const std::vector<Table>& tables) {
  std::vector<std::string> columns;
  for (const Table& table : tables) {
    if (!table.rows.empty()) columns.insert(columns.end(), table.header.begin(), table.header.end());
  }
  std::string html =
      "<div class=\"definitions\"><p>Runs in lock step, judged by the simulator's truth. Run k of every "
      "strategy starts at the same "
      "place and "
      "heading. Curves: mean of the runs; band: the middle half of them. A run that has ended keeps its last "
      "coverage.</p>\n";
  for (const std::string& note : NotesOn(columns)) html += "<p>" + EscapedForHtml(note) + "</p>\n";
  return html + "</div>\n";
}

std::string TablesHtml(std::span<const Outcome> outcomes) {
  const Table summary = SummaryTable(outcomes);
  const Table time = TimeTable(outcomes);
  const Table comparison = ComparisonTable(outcomes);
  const Table optimum = OptimumTable(outcomes);
  const Table tail = TailTable(outcomes);
  const Table surface = SurfaceTable(outcomes);
  const Table noise = NoiseTable(outcomes);
  const Table odometry = OdometryTable(outcomes);
  std::string html = Section("Figures", SummaryHtml(summary));
  html += Section("Time: moving, turning, standing", TimeHtml(time));
  if (!comparison.rows.empty()) html += Section("Start by start", ToHtml(comparison));
  if (!optimum.rows.empty()) {
    html += Section("Path relative to the best tour known, an upper bound of the optimum", ToHtml(optimum));
  }
  if (!tail.rows.empty()) html += Section("The tail: where the path after 95 % went", ToHtml(tail));
  if (!surface.rows.empty()) html += Section("Surfaces", ToHtml(surface));
  if (!noise.rows.empty()) html += Section("Noise of the depth sensor", ToHtml(noise));
  if (!odometry.rows.empty()) html += Section("Odometry", ToHtml(odometry));
  html += Section("How runs ended", ToHtml(EndTable(outcomes)));
  html += Section("Frontiers set aside: mean of the runs, at their ends", ToHtml(SetAsideTable(outcomes)));
  html += Section("Planning, stage by stage, of one process among others on this machine",
                  ToHtml(StageTable(outcomes)));
  return html + Section("What the words mean", DefinitionsHtml({summary, time, comparison, optimum, tail,
                                                                surface, noise, odometry}));
}

}  // namespace

CoverageCurve CurveOver(std::span<const Outcome* const> runs, double Outcome::Progress::*along) {
  CoverageCurve curve;
  double longest = 0.0;
  for (const Outcome* run : runs) {
    if (!run->progress.empty()) longest = std::max(longest, run->progress.back().*along);
  }
  if (runs.empty()) return curve;
  for (std::size_t k = 0; k <= kCurvePoints; ++k) {
    const double at = longest * static_cast<double>(k) / kCurvePoints;
    std::vector<double> coverages;
    for (const Outcome* run : runs) coverages.push_back(evaluator::CoverageAt(*run, along, at));
    curve.at.push_back(at);
    curve.mean.push_back(evaluator::Mean(coverages));
    curve.low.push_back(evaluator::Quantile(coverages, 0.25));
    curve.high.push_back(evaluator::Quantile(coverages, 0.75));
  }
  return curve;
}

WorldPicture PictureOf(const MapFromAbove& map) {
  WorldPicture picture;
  if (map.kind.empty()) return picture;
  const double edge = map.voxel_size * map.voxels_per_pixel;
  picture.min_x = map.min_x * map.voxel_size;
  picture.min_y = map.min_y * map.voxel_size;
  picture.width = map.kind.cols * edge;
  picture.height = map.kind.rows * edge;
  picture.lowest = map.lowest;
  picture.highest = map.highest;
  cv::imencode(".png", PixelsOf(map), picture.png);
  return picture;
}

Json EvaluationData(std::span<const Outcome> outcomes, const std::map<std::string, WorldPicture>& worlds) {
  Json scenarios = Json::array();
  for (const std::string& scenario : NamesIn(outcomes, &Outcome::scenario)) {
    Json strategies = Json::array();
    for (const std::string& strategy : NamesIn(outcomes, &Outcome::strategy)) {
      const std::vector<const Outcome*> runs = RunsOf(outcomes, scenario, strategy);
      Json list = Json::array();
      for (const Outcome* run : runs) list.push_back(RunOf(*run));
      strategies.push_back({{"name", strategy},
                            {"distance", CurveJson(CurveOver(runs, &Outcome::Progress::distance))},
                            {"time", CurveJson(CurveOver(runs, &Outcome::Progress::time))},
                            {"runs", list}});
    }
    const auto world = worlds.find(scenario);
    scenarios.push_back({{"name", scenario},
                         {"world", world != worlds.end() ? WorldJson(world->second) : Json(nullptr)},
                         {"strategies", strategies}});
  }
  const MapColors colors = ColorsOfMap();
  return {{"scenarios", scenarios},
          {"colors", {{"heights", colors.heights}, {"wall", colors.wall}, {"hollow", colors.hollow}}}};
}

std::string EvaluationHtml(std::span<const Outcome> outcomes,
                           const std::map<std::string, WorldPicture>& worlds,
                           std::span<const std::string> overrides) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\" data-theme=\"dark\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<meta name=\"color-scheme\" content=\"dark light\">"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
      "'unsafe-inline'; "
      "style-src 'unsafe-inline'; img-src data:\"><title>thalweg: evaluation</title>"
      "<link rel=\"icon\" href=\"data:,\"><style>\n";
  html += kEvaluationStyle;
  html +=
      "</style></head><body><div class=\"top\"><span class=\"brand\">"
      "<svg viewBox=\"0 0 24 24\" width=\"20\" height=\"20\" aria-hidden=\"true\"><path d=\"M2 6c5 0 5 4 10 "
      "4s5-4 10-4M2 12c5 0 5 6 10 6s5-6 10-6\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"2.2\" "
      "stroke-linecap=\"round\"/></svg>thalweg</span>"
      "<span class=\"spacer\"></span><button id=\"theme\" class=\"icon\" title=\"Dark or "
      "light\">\u25d0</button>"
      "</div><main><h1>Evaluation</h1>\n";
  html += VerdictHtml(outcomes);
  if (!overrides.empty()) html += "<p>All runs with " + EscapedForHtml(Joined(overrides)) + ".</p>\n";
  html +=
      "<div id=\"scenarios\"><noscript><p>Curves and paths need JavaScript; the tables do "
      "not.</p></noscript></div>\n";
  html += TablesHtml(outcomes);
  html += "</main><script id=\"data\" type=\"application/json\">" +
          JsonForScript(EvaluationData(outcomes, worlds)) + "</script>\n<script>\n(() => {\n";
  html += kEvaluationScript;
  return html + "})();\n</script></body></html>\n";
}

}  // namespace thalweg::cli
