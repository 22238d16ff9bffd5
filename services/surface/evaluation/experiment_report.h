#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "services/surface/evaluation/exploration.h"

namespace thalweg::surface {

/// The table of an experiment, as it grows, and the pictures and graphs that belong to it.
class ExperimentReport {
 public:
  /// Prints the table's heading. Pictures of an earlier experiment in the folder are removed.
  /// @param folder          Exists; where pictures and graphs go.
  /// @param views_per_move  Poses to draw on the way to the dominant rift.
  ExperimentReport(std::ostream& out, std::filesystem::path folder, int views_per_move);

  /// Prints the row and how the three searches did on its surface. Leaves the pictures edges-NN.png,
  /// rifts-NN.png and trajectory-NN.png, numbered from 0.
  void Add(const SurfaceRow& row, const Surface& surface, const Move& move);

  /// Leaves graph.ply and surface.ply.
  void WriteGraphs(const Surface& surface) const;

  /// {"rows": [...]}, each with its "searches" if it has any.
  nlohmann::ordered_json ToJson() const { return {{"rows", rows_}}; }

 private:
  void RemoveEarlierPictures() const;

  std::ostream& out_;
  std::filesystem::path folder_;
  int views_per_move_;
  nlohmann::ordered_json rows_ = nlohmann::ordered_json::array();
};

}  // namespace thalweg::surface
