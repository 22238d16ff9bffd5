#include "common/files/write_picture.h"

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "common/files/write_file.h"

namespace thalweg {

void WritePicture(const std::filesystem::path& file, const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  if (!cv::haveImageWriter(file.string()) || !cv::imencode(file.extension().string(), picture, bytes)) {
    throw std::runtime_error(file.string() + ": cannot be written: no picture format has the ending \"" +
                             file.extension().string() + "\"");
  }
  WriteFile(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace thalweg
