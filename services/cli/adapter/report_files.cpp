#include "services/cli/adapter/report_files.h"

#include "common/files/tum.h"
#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/cli/report/report_json.h"
#include "services/cli/report/report_picture.h"

namespace thalweg::cli {

void WriteReport(const RunRecord& record, const OccupancyGrid* map, const std::filesystem::path& folder) {
  WriteFile(folder / "trajectory.tum", TumText(record.trajectory));
  WriteFile(folder / "report.json", ToJson(record).dump(2) + '\n');
  WritePicture(folder / "report.png", DrawReport(record, map));
}

}  // namespace thalweg::cli
