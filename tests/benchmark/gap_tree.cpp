/// Explores random polygons by the gap navigation tree and prints, for each kind, what happened and how long
/// the paths are. An argument sets the number of polygons of each kind; the first 40 are those of the tests.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "common/base/median.h"
#include "common/base/stopwatch.h"
#include "services/explorer/core/gaps/gap_explorer.h"
#include "tests/services/explorer/support/random_polygons.h"

namespace thalweg::explorer {
namespace {

void Explore(test::PolygonKind kind, unsigned polygons) {
  std::size_t vertices = 0;
  std::size_t most_vertices = 0;
  std::size_t reflex = 0;
  std::size_t events[4] = {};
  std::vector<double> lengths;
  std::vector<double> ratios;
  double largest_ratio = 0.0;
  double smallest_step = std::numeric_limits<double>::infinity();
  const Stopwatch watch;
  for (unsigned seed = 1; seed <= polygons; ++seed) {
    const Polygon polygon = test::RandomPolygon(kind, seed);
    test::Dice dice(seed);
    GapExplorer explorer(polygon, test::RandomPointIn(dice, polygon));
    while (explorer.Step()) {
    }
    vertices += polygon.size();
    most_vertices = std::max(most_vertices, polygon.size());
    for (std::size_t k = 0; k < polygon.size(); ++k) reflex += polygon.IsReflex(k) ? 1 : 0;
    for (const auto& record : explorer.log()) ++events[static_cast<std::size_t>(record.event.kind)];
    lengths.push_back(explorer.robot().length());
    ratios.push_back(explorer.robot().length() / polygon.Perimeter());
    largest_ratio = std::max(largest_ratio, ratios.back());
    smallest_step = std::min(smallest_step, explorer.robot().smallest_step());
  }
  std::printf("| %s | %.1f (%zu), %.1f | %zu, %zu, %zu, %zu | %.1f | %.2f, %.2f | %.0e | %.1f |\n",
              test::NameOf(kind).c_str(), static_cast<double>(vertices) / polygons, most_vertices,
              static_cast<double>(reflex) / polygons, events[0], events[1], events[2], events[3],
              Median(lengths), Median(ratios), largest_ratio, smallest_step, watch.Milliseconds() / polygons);
}

}  // namespace
}  // namespace thalweg::explorer

int main(int argc, char** argv) {
  using namespace thalweg::explorer;
  const unsigned polygons = argc > 1 ? static_cast<unsigned>(std::max(1, std::atoi(argv[1]))) : 40U;
  std::printf(
      "| %u of each | vertices, mean (most), reflex | appear, disappear, split, merge | path, median [m] | "
      "path / perimeter, median, most | least way after an event [m] | ms each "
      "|\n|---|---|---|---|---|---|---|\n",
      polygons);
  for (const test::PolygonKind kind : test::kPolygonKinds) Explore(kind, polygons);
}
