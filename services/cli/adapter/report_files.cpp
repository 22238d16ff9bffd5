#include "services/cli/adapter/report_files.h"

#include <fstream>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <ostream>
#include <stdexcept>

#include "services/cli/report/report_json.h"
#include "services/cli/report/report_picture.h"

namespace thalweg::cli {
namespace {

void WriteFile(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write) {
  std::ofstream out(file);
  write(out);
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

void WriteReport(const RunRecord& record, const OccupancyGrid* map, const std::filesystem::path& folder) {
  WriteFile(folder / "trajectory.tum", [&](std::ostream& out) { WriteTum(record.trajectory, out); });
  WriteFile(folder / "report.json", [&](std::ostream& out) { out << ToJson(record).dump(2) << '\n'; });
  const std::filesystem::path picture = folder / "report.png";
  if (!cv::imwrite(picture.string(), DrawReport(record, map))) {
    throw std::runtime_error("cannot write " + picture.string());
  }
}

}  // namespace thalweg::cli
