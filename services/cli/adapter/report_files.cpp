#include "services/cli/adapter/report_files.h"

#include <spdlog/spdlog.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "common/files/tum.h"
#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/cli/report/report_json.h"
#include "services/cli/report/report_picture.h"
#include "services/cli/report/run_page.h"

namespace thalweg::cli {
namespace {

std::string ContentOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  return content.str();
}

}  // namespace

std::vector<std::string> WriteReport(const RunRecord& record, const OccupancyGrid* map,
                                     const CoverageTally& tally, const std::filesystem::path& folder,
                                     const std::filesystem::path& page_template) {
  using nlohmann::ordered_json;  // a scenario's file name may hold any bytes
  SeparateWrites writes;
  writes.Try([&] {
    WriteFile(folder / "report.json",
              ToJson(record).dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n');
  });
  writes.Try([&] { WriteFile(folder / "trajectory.tum", TumText(record.trajectory)); });
  writes.Try([&] { WritePicture(folder / "report.png", DrawReport(record, map)); });
  if (!std::filesystem::exists(page_template)) {
    spdlog::info("no report.html: {} was not built, which needs the packages nodejs and npm",
                 page_template.string());
    return writes.errors();
  }
  writes.Try(
      [&] { WriteFile(folder / "report.html", RunPage(ContentOf(page_template), record, map, tally)); });
  return writes.errors();
}

std::string FilesText(const std::filesystem::path& folder) {
  std::string names;
  for (const char* name : {"report.html", "report.png", "report.json", "map.bt", "map.ot", "map.ply",
                           "map_surface.ply", "trajectory.tum", "recording.mcap"}) {
    if (std::filesystem::exists(folder / name)) names += (names.empty() ? "" : ", ") + std::string(name);
  }
  return "files in " + folder.string() + ": " + names + " and logs";
}

std::filesystem::path RunPageTemplate() {
  const std::filesystem::path bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return bin.parent_path() / "share/thalweg/report.html";
}

}  // namespace thalweg::cli
