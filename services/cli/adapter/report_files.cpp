#include "services/cli/adapter/report_files.h"

#include "common/files/tum.h"
#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/cli/report/report_json.h"
#include "services/cli/report/report_picture.h"

namespace thalweg::cli {

std::vector<std::string> WriteReport(const RunRecord& record, const OccupancyGrid* map,
                                     const std::filesystem::path& folder) {
  using nlohmann::ordered_json;  // a scenario's file name may hold any bytes
  SeparateWrites writes;
  writes.Try([&] {
    WriteFile(folder / "report.json",
              ToJson(record).dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n');
  });
  writes.Try([&] { WriteFile(folder / "trajectory.tum", TumText(record.trajectory)); });
  writes.Try([&] { WritePicture(folder / "report.png", DrawReport(record, map)); });
  return writes.errors();
}

}  // namespace thalweg::cli
