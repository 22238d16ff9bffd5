#include "services/cli/export/topic_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/size_text.h"
#include "common/files/ply.h"
#include "common/files/tum.h"
#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "services/inspector/core/field_path.h"
#include "services/inspector/core/json.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;
using inspector::Schema;
using inspector::Value;

/// Thrown while one message is read; what() is why it is left out.
class LeftOut : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads fields of messages of a schema by their names.
class Fields {
 public:
  explicit Fields(const Schema& schema) : schema_(schema) {}

  Value At(const Value& message, const std::string& path) const {
    const auto parsed = inspector::FieldPath::Parse(schema_, path);
    if (!parsed) throw LeftOut(parsed.error());
    auto value = parsed->In(message);
    if (!value) throw LeftOut(value.error());
    return *std::move(value);
  }
  double Number(const Value& message, const std::string& path) const {
    return std::visit([](const auto number) { return static_cast<double>(number); },
                      At(message, path).number());
  }
  std::size_t Size(const Value& message, const std::string& path) const {
    return static_cast<std::size_t>(Number(message, path));
  }
  std::string Text(const Value& message, const std::string& path) const { return At(message, path).text(); }
  std::vector<std::uint8_t> Bytes(const Value& message, const std::string& path) const {
    return At(message, path).numbers().bytes();
  }
  Time Stamp(const Value& message) const {
    const auto seconds = static_cast<std::int64_t>(Number(message, "header.stamp.sec"));
    const auto nanoseconds = static_cast<std::int64_t>(Number(message, "header.stamp.nanosec"));
    if (nanoseconds >= 1'000'000'000) throw LeftOut("header.stamp.nanosec is 1e9 or more");
    return Time{std::chrono::seconds(seconds) + Duration(nanoseconds)};
  }
  RigidTransform Pose(const Value& message, const std::string& path) const {
    const auto number = [&](const std::string& field) { return Number(message, path + field); };
    const Eigen::Vector3d position(number(".position.x"), number(".position.y"), number(".position.z"));
    const Eigen::Quaterniond rotation(number(".orientation.w"), number(".orientation.x"),
                                      number(".orientation.y"), number(".orientation.z"));
    if (!position.allFinite()) throw LeftOut(path + ".position is not finite");
    if (!(std::abs(rotation.norm() - 1.0) < 0.01)) throw LeftOut(path + ".orientation is no unit quaternion");
    return MakeTransform(rotation.normalized().toRotationMatrix(), position);
  }

 private:
  const Schema& schema_;
};

std::string StampText(Time stamp) {
  const auto nanoseconds = stamp.time_since_epoch().count();
  return fmt::format("{}.{:09}", nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000);
}

/// A writer whose messages are left out by throwing.
class CheckedWriter : public TopicWriter {
 public:
  std::optional<std::string> Write(Time log_time, const Value& message) final {
    try {
      Put(log_time, message);
    } catch (const LeftOut& reason) {
      return reason.what();
    } catch (const std::bad_variant_access&) {
      return "a field is not of the type that its name stands for";
    }
    return std::nullopt;
  }

 private:
  virtual void Put(Time log_time, const Value& message) = 0;
};

class TrajectoryWriter final : public CheckedWriter {
 public:
  TrajectoryWriter(const Schema& schema, const fs::path& folder, const std::string& stem, std::string pose)
      : fields_(schema), file_(folder / (stem + ".tum")), pose_(std::move(pose)) {
    CheckWritable(file_);
  }
  void Finish() override { WriteFile(file_, TumText(poses_)); }
  std::string files() const override { return file_.filename().string(); }

 private:
  void Put(Time, const Value& message) override {
    poses_.push_back({fields_.Stamp(message), fields_.Pose(message, pose_)});
  }
  Fields fields_;
  fs::path file_;
  std::string pose_;  ///< Path of the field.
  std::vector<TimedPose> poses_;
};

/// Names of files by stamp; of several messages with one stamp, the later ones are numbered.
class StampNames {
 public:
  std::string NameOf(Time stamp) {
    const std::string name = StampText(stamp);
    if (used_.insert(name).second) return name;
    for (int number = 2;; ++number) {
      const std::string numbered = fmt::format("{}_{}", name, number);
      if (used_.insert(numbered).second) return numbered;
    }
  }

 private:
  std::set<std::string> used_;
};

/// Where a field of a cloud's points is.
struct Channel {
  std::size_t offset = 0;
  std::uint8_t datatype = 0;
};
constexpr std::uint8_t kFloat32 = 7;  // sensor_msgs/PointField.FLOAT32
constexpr std::uint8_t kUint32 = 6;

class CloudWriter final : public CheckedWriter {
 public:
  CloudWriter(const Schema& schema, const fs::path& folder, const std::string& stem)
      : fields_(schema), folder_(folder / stem) {
    CheckFolderWritable(folder_);
  }
  void Finish() override {}
  std::string files() const override { return folder_.filename().string() + "/*.ply"; }

 private:
  void Put(Time, const Value& message) override {
    const PointCloud cloud = CloudFrom(message);
    WriteFile(folder_ / (names_.NameOf(fields_.Stamp(message)) + ".ply"), PlyOf(cloud));
  }

  PointCloud CloudFrom(const Value& message) const {
    const std::size_t width = fields_.Size(message, "width");
    const std::size_t height = fields_.Size(message, "height");
    const std::size_t point_step = fields_.Size(message, "point_step");
    const std::size_t row_step = fields_.Size(message, "row_step");
    const std::vector<std::uint8_t> data = fields_.Bytes(message, "data");
    if (fields_.Number(message, "is_bigendian") != 0) throw LeftOut("is_bigendian is true");
    const bool fits =
        point_step > 0 && row_step / point_step >= width && (height == 0 || data.size() / height >= row_step);
    if (!fits) throw LeftOut("width, height and steps do not fit the data");
    const auto offset_of = [&](const char* name, std::initializer_list<std::uint8_t> types) {
      return OffsetOf(message, name, types, point_step);
    };
    std::array<std::size_t, 3> axes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto offset = offset_of(std::array{"x", "y", "z"}[axis], {kFloat32});
      if (!offset) throw LeftOut("the cloud has no x, y and z of type float32");
      axes[axis] = *offset;
    }
    const auto color = offset_of("rgb", {kFloat32, kUint32});
    PointCloud cloud;
    for (std::size_t row = 0; row < height; ++row) {
      for (std::size_t column = 0; column < width; ++column) {
        const std::uint8_t* const point = data.data() + row * row_step + column * point_step;
        Eigen::Vector3f& p = cloud.points_C.emplace_back();
        for (int axis = 0; axis < 3; ++axis)
          std::memcpy(&p[axis], point + axes[static_cast<std::size_t>(axis)], 4);
        if (!color) continue;
        const std::uint8_t* const bgr = point + *color;
        cloud.colors.push_back({bgr[2], bgr[1], bgr[0]});
      }
    }
    return cloud;
  }

  std::optional<std::size_t> OffsetOf(const Value& message, std::string_view name,
                                      std::initializer_list<std::uint8_t> types,
                                      std::size_t point_step) const {
    const std::size_t count = fields_.At(message, "fields").size();
    for (std::size_t k = 0; k < count; ++k) {
      const std::string path = fmt::format("fields[{}].", k);
      if (fields_.Text(message, path + "name") != name) continue;
      const auto type = static_cast<std::uint8_t>(fields_.Number(message, path + "datatype"));
      const std::size_t offset = fields_.Size(message, path + "offset");
      if (std::find(types.begin(), types.end(), type) == types.end()) return std::nullopt;
      if (offset + 4 > point_step) throw LeftOut(fmt::format("{} ends beyond point_step", name));
      return offset;
    }
    return std::nullopt;
  }

  Fields fields_;
  fs::path folder_;
  StampNames names_;
};

/// What the pixels of an encoding are [REP 118; sensor_msgs/image_encodings.hpp], and how PNG shows them.
struct Encoding {
  const char* name;
  int type;         ///< OpenCV's.
  int conversion;   ///< OpenCV's, to gray or BGR; -1: none.
  bool is_depth_m;  ///< 32 bits in meters.
};
constexpr std::array<Encoding, 14> kEncodings = {{
    {"mono8", CV_8UC1, -1, false},
    {"8UC1", CV_8UC1, -1, false},
    {"bayer_rggb8", CV_8UC1, -1, false},
    {"bayer_bggr8", CV_8UC1, -1, false},
    {"bayer_gbrg8", CV_8UC1, -1, false},
    {"bayer_grbg8", CV_8UC1, -1, false},
    {"bgr8", CV_8UC3, -1, false},
    {"8UC3", CV_8UC3, -1, false},
    {"rgb8", CV_8UC3, cv::COLOR_RGB2BGR, false},
    {"bgra8", CV_8UC4, -1, false},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGRA, false},
    {"mono16", CV_16UC1, -1, false},
    {"16UC1", CV_16UC1, -1, false},
    {"32FC1", CV_32FC1, -1, true},
}};

cv::Mat Millimeters(const cv::Mat& meters) {
  cv::Mat millimeters(meters.size(), CV_16UC1);
  for (int v = 0; v < meters.rows; ++v) {
    for (int u = 0; u < meters.cols; ++u) {
      const double value = std::round(double{meters.at<float>(v, u)} * 1000.0);
      const bool fits = value > 0.0 && value <= std::numeric_limits<std::uint16_t>::max();
      millimeters.at<std::uint16_t>(v, u) = fits ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
  }
  return millimeters;
}

class ImageWriter final : public CheckedWriter {
 public:
  ImageWriter(const Schema& schema, const fs::path& folder, const std::string& stem)
      : fields_(schema), folder_(folder / stem), list_(folder / (stem + ".txt")) {
    CheckFolderWritable(folder_);
    CheckWritable(list_);
  }
  void Finish() override { WriteFile(list_, lines_); }
  std::string files() const override {
    return fmt::format("{}/*.png, {}", folder_.filename().string(), list_.filename().string());
  }

 private:
  void Put(Time, const Value& message) override {
    const Time stamp = fields_.Stamp(message);
    std::vector<std::uint8_t> data = fields_.Bytes(message, "data");
    const cv::Mat picture = PictureFrom(message, data);
    const std::string name = names_.NameOf(stamp) + ".png";
    WritePicture(folder_ / name, picture);
    lines_ += fmt::format("{} {}/{}\n", StampText(stamp), folder_.filename().string(), name);
  }

  /// @param data  Data of the message; the result may point into it.
  cv::Mat PictureFrom(const Value& message, std::vector<std::uint8_t>& data) const {
    constexpr std::size_t kMostPixels = 1U << 15U;  // in a row or column
    const std::string name = fields_.Text(message, "encoding");
    const auto* const encoding = std::ranges::find(kEncodings, name, &Encoding::name);
    if (encoding == kEncodings.end()) throw LeftOut("PNG has no encoding " + name);
    if (CV_ELEM_SIZE1(encoding->type) > 1 && fields_.Number(message, "is_bigendian") != 0)
      throw LeftOut("is_bigendian is true");
    const std::size_t width = fields_.Size(message, "width");
    const std::size_t height = fields_.Size(message, "height");
    const std::size_t step = fields_.Size(message, "step");
    const std::size_t row = width * static_cast<std::size_t>(CV_ELEM_SIZE(encoding->type));
    if (width == 0 || height == 0 || width > kMostPixels || height > kMostPixels)
      throw LeftOut(SizeText(width, height) + " pixels");
    if (step < row || data.size() / height < step)
      throw LeftOut("width, height and step do not fit the data");
    const cv::Mat image(static_cast<int>(height), static_cast<int>(width), encoding->type, data.data(), step);
    if (encoding->is_depth_m) return Millimeters(image);
    if (encoding->conversion < 0) return image;
    cv::Mat converted;
    cv::cvtColor(image, converted, encoding->conversion);
    return converted;
  }

  Fields fields_;
  fs::path folder_;
  fs::path list_;
  std::string lines_;
  StampNames names_;
};

class JsonWriter final : public CheckedWriter {
 public:
  JsonWriter(const Schema& schema, const fs::path& folder, const std::string& stem)
      : schema_(schema), file_(folder / (stem + ".jsonl")) {
    CheckWritable(file_);
    out_.open(file_, std::ios::binary);
  }
  void Finish() override {
    out_.close();
    ThrowUnlessWritten();
  }
  std::string files() const override { return file_.filename().string(); }

 private:
  void Put(Time log_time, const Value& message) override {
    out_ << R"({"log_time":)" << StampText(log_time) << R"(,"message":)"
         << inspector::ToJson(schema_, schema_.root(), message) << "}\n";
    ThrowUnlessWritten();
  }
  void ThrowUnlessWritten() const {
    if (!out_) throw CannotWrite(file_, errno);
  }
  const Schema& schema_;
  fs::path file_;
  std::ofstream out_;
};

}  // namespace

std::vector<fs::path> FilesOf(const fs::path& folder, const std::string& stem) {
  return {folder / (stem + ".tum"), folder / (stem + ".jsonl"), folder / (stem + ".txt"), folder / stem};
}

std::unique_ptr<TopicWriter> MakeTopicWriter(const std::string& type, const Schema& schema,
                                             const fs::path& folder, const std::string& stem) {
  if (type == "nav_msgs/msg/Odometry")
    return std::make_unique<TrajectoryWriter>(schema, folder, stem, "pose.pose");
  if (type == "geometry_msgs/msg/PoseStamped")
    return std::make_unique<TrajectoryWriter>(schema, folder, stem, "pose");
  if (type == "sensor_msgs/msg/PointCloud2") return std::make_unique<CloudWriter>(schema, folder, stem);
  if (type == "sensor_msgs/msg/Image") return std::make_unique<ImageWriter>(schema, folder, stem);
  return std::make_unique<JsonWriter>(schema, folder, stem);
}

}  // namespace thalweg::cli
