#include "services/surface/evaluation/experiment_report.h"

#include <fmt/format.h>

#include <regex>
#include <utility>
#include <vector>

#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/surface/evaluation/graph_ply.h"
#include "services/surface/evaluation/picture.h"

namespace thalweg::surface {

ExperimentReport::ExperimentReport(std::ostream& out, std::filesystem::path folder, int views_per_move)
    : out_(out), folder_(std::move(folder)), views_per_move_(views_per_move) {
  RemoveEarlierPictures();
  out_ << RowHeading() << std::flush;
}

void ExperimentReport::Add(const SurfaceRow& row, const Surface& surface, const Move& move) {
  out_ << ToText(row);
  nlohmann::ordered_json json = surface::ToJson(row);
  for (const SearchRow& search : CompareSearches(surface, move)) {
    out_ << ToText(search);
    json["searches"].push_back(surface::ToJson(search));
  }
  out_ << std::flush;
  const auto file = [&](const char* what) {
    return folder_ / fmt::format("{}-{:02}.png", what, rows_.size());
  };
  const Viewpoint from = BesideFirstCamera(surface);
  const auto write = [&](const char* what, const cv::Mat& picture, const char* title,
                         const std::vector<Meaning>& legend) {
    WritePicture(file(what), Framed(picture, fmt::format("{}, {}", row.name, title), legend));
  };
  write("edges", DrawEdges(surface, from), "edges of the surface graph by length",
        LegendOfEdges(surface.options().rift_edge));
  write("rifts", DrawRifts(surface, move, from), "rifts of the surface", LegendOfRifts());
  const bool moves = !move.ranked.empty();
  write("trajectory", DrawTrajectory(surface, move, views_per_move_, from),
        moves ? "the move to the dominant rift" : "no move: no path leads to a rift",
        moves ? LegendOfTrajectory() : std::vector<Meaning>());
  rows_.push_back(std::move(json));
}

void ExperimentReport::RemoveEarlierPictures() const {
  static const std::regex pictures("(edges|rifts|trajectory)-[0-9]+\\.png");
  std::vector<std::filesystem::path> earlier;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    if (std::regex_match(entry.path().filename().string(), pictures)) earlier.push_back(entry.path());
  }
  for (const std::filesystem::path& picture : earlier) std::filesystem::remove(picture);
}

void ExperimentReport::WriteGraphs(const Surface& surface) const {
  WriteFile(folder_ / "graph.ply", GraphPly(surface));
  WriteFile(folder_ / "surface.ply", MeshPly(surface));
}

}  // namespace thalweg::surface
