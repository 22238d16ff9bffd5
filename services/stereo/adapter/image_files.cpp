#include "services/stereo/adapter/image_files.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/base/append_raw.h"
#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;

/// OpenCV fills the missing part of a truncated JPEG with gray. An end marker cannot occur within the scan
/// data.
bool IsTruncatedJpeg(const std::string& bytes) {
  if (!bytes.starts_with("\xFF\xD8")) return false;
  const std::size_t scan = bytes.rfind("\xFF\xDA");
  const std::size_t end = bytes.rfind("\xFF\xD9");
  return scan == std::string::npos || end == std::string::npos || end < scan;
}

/// Keeps only the sign of the scale in a PFM header, which gives the byte order; OpenCV would multiply by its
/// magnitude.
void TakeScaleFromPfm(std::string& bytes) {
  if (!bytes.starts_with("Pf") && !bytes.starts_with("PF")) return;
  std::istringstream head(bytes.substr(0, 200));
  std::string kind, width, height, scale;
  if (!(head >> kind >> width >> height)) return;
  head >> std::ws;
  const auto at = static_cast<std::ptrdiff_t>(head.tellg());
  if (at < 0 || !(head >> scale)) return;
  bytes.replace(static_cast<std::size_t>(at), scale.size(), scale.starts_with('-') ? "-1" : "1");
}

cv::Mat Read(const fs::path& file) {
  const auto unreadable = [&file](const std::string& why) {
    return std::runtime_error(file.string() + ": is not a readable image" + why);
  };
  if (!fs::is_regular_file(file)) throw unreadable("");
  std::string bytes(fs::file_size(file), '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in || bytes.empty()) throw unreadable("");
  if (IsTruncatedJpeg(bytes)) throw unreadable(": it is truncated");
  TakeScaleFromPfm(bytes);
  cv::Mat image;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U, bytes.data());
    image = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    throw unreadable(": its size is invalid or too large");
  }
  if (image.empty()) throw unreadable("");
  return image;
}

ByteImage CopyOf(const cv::Mat& image) {
  ByteImage out(image.cols, image.rows, image.channels());
  cv::Mat to(image.rows, image.cols, image.type(), out.data().data());
  image.copyTo(to);
  return out;
}

}  // namespace

ByteImage ReadImage(const fs::path& file) {
  cv::Mat image = Read(file);
  if (image.depth() != CV_8U) {
    throw std::runtime_error(file.string() + ": has more than 8 bits per channel, must have 8");
  }
  if (image.channels() == 2) cv::extractChannel(image, image, 0);  // gray with transparency
  if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2RGB);
  return CopyOf(image);
}

DisparityMap ReadScaledDisparity(const fs::path& file, double scale) {
  cv::Mat image = Read(file);
  if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
  if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2GRAY);
  image.convertTo(image, CV_32F);
  DisparityMap disparity(image.cols, image.rows);
  std::transform(image.begin<float>(), image.end<float>(), disparity.data().begin(), [&](float value) {
    const bool known = std::isfinite(value) && value > 0.0F;
    return known ? static_cast<float>(value / scale) : kNoDisparity;
  });
  return disparity;
}

void WritePfm(const fs::path& file, const DisparityMap& disparity) {
  std::ostringstream out;
  out << "Pf\n" << disparity.width() << ' ' << disparity.height() << "\n-1\n";  // negative: little-endian
  std::string bytes = out.str();
  for (int v = disparity.height() - 1; v >= 0; --v) {
    for (int u = 0; u < disparity.width(); ++u) {
      const float d = disparity(u, v);
      AppendRaw(bytes, std::isnan(d) ? std::numeric_limits<float>::infinity() : d);
    }
  }
  WriteFile(file, bytes);
}

ByteImage Colored(const DisparityMap& disparity, double max_disparity) {
  cv::Mat_<std::uint8_t> levels(disparity.height(), disparity.width());
  cv::Mat_<std::uint8_t> none(disparity.height(), disparity.width());
  for (int v = 0; v < disparity.height(); ++v) {
    for (int u = 0; u < disparity.width(); ++u) {
      const float d = disparity(u, v);
      none(v, u) = std::isnan(d) ? 255 : 0;
      levels(v, u) =
          std::isnan(d) ? std::uint8_t{0} : cv::saturate_cast<std::uint8_t>(255.0 * d / max_disparity);
    }
  }
  cv::Mat colors;
  cv::applyColorMap(levels, colors, cv::COLORMAP_JET);
  colors.setTo(cv::Scalar::all(0), none);
  cv::cvtColor(colors, colors, cv::COLOR_BGR2RGB);
  return CopyOf(colors);
}

void WriteColored(const fs::path& file, const DisparityMap& disparity, double max_disparity) {
  WriteImage(file, Colored(disparity, max_disparity));
}

void WriteImage(const fs::path& file, const ByteImage& image) {
  cv::Mat out;  // a matrix of its own, since the view must not be written to
  if (image.channels() == 3) {
    cv::cvtColor(ViewOf(image), out, cv::COLOR_RGB2BGR);
  } else {
    out = ViewOf(image);
  }
  WritePicture(file, out);
}

}  // namespace thalweg::stereo
