#include "services/mapper/core/ply_file.h"

#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstring>
#include <random>
#include <sstream>
#include <string>

namespace thalweg::mapper {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Bytes PlyBytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string ErrorOfPly(const std::string& text) {
  const auto file = DecodePly(PlyBytesOf(text));
  return file ? "" : file.error();
}

std::string PlyHeadOf(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\ncomment of a test\nobj_info too\n" + elements + "end_header\n";
}
const std::string kPlace = "property float x\nproperty float y\nproperty float z\n";
const std::string kColor = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

std::string TextPly(const std::string& elements, const std::string& body) {
  return PlyHeadOf("ascii", elements) + body;
}

/// Writes values as a file of one of the three formats has them.
class PlyBody {
 public:
  explicit PlyBody(std::string format) : format_(std::move(format)) {}

  template <class T>
  PlyBody& operator<<(T value) {
    if (format_ == "ascii") {
      std::ostringstream text;
      text.precision(17);
      text << +value << ' ';
      bytes_ += text.str();
      return *this;
    }
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    if (format_ == "binary_big_endian") std::ranges::reverse(raw);
    bytes_ += raw;
    return *this;
  }
  void EndLine() {
    if (format_ == "ascii") bytes_ += '\n';
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string format_;
  std::string bytes_;
};

struct RandomCloud {
  explicit RandomCloud(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> coordinate(-20.0F, 20.0F);
    std::uniform_int_distribution<int> channel(0, 255);
    const auto byte = [&] { return static_cast<std::uint8_t>(channel(random)); };
    for (int k = 0; k < 500; ++k) {
      points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
      colors.push_back({byte(), byte(), byte()});
    }
  }
  std::vector<Eigen::Vector3f> points;
  std::vector<Rgb> colors;
};

class PlyFileOf : public testing::TestWithParam<const char*> {
 protected:
  std::string FileOf(const RandomCloud& cloud) const {
    PlyBody body(GetParam());
    for (std::size_t k = 0; k < cloud.points.size(); ++k) {
      const auto& [r, g, b] = cloud.colors[k];
      body << cloud.points[k].x() << cloud.points[k].y() << cloud.points[k].z() << r << g << b;
      body.EndLine();
    }
    return PlyHeadOf(GetParam(), "element vertex 500\n" + kPlace + kColor) + body.bytes();
  }
};

TEST_P(PlyFileOf, APointCloudComesBackBitByBit) {
  const RandomCloud cloud(7);
  const auto file = DecodePly(PlyBytesOf(FileOf(cloud)));
  ASSERT_TRUE(file) << file.error();
  ASSERT_EQ(file->points.size(), cloud.points.size());
  for (std::size_t k = 0; k < cloud.points.size(); ++k) {
    ASSERT_EQ(file->points[k].cast<float>(), cloud.points[k]);
  }
  EXPECT_EQ(file->colors, cloud.colors);
  EXPECT_THAT(file->triangles, IsEmpty());
  EXPECT_EQ(file->map_voxel_size, std::nullopt);
}

TEST_P(PlyFileOf, APointCloudIsWhatAnotherLibraryReads) {
  const std::string bytes = FileOf(RandomCloud(8));
  const auto file = DecodePly(PlyBytesOf(bytes));
  ASSERT_TRUE(file) << file.error();
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, "ply");
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1U);
  const aiMesh& read = *scene->mMeshes[0];
  ASSERT_EQ(read.mNumVertices, file->points.size());
  ASSERT_TRUE(read.HasVertexColors(0));
  for (unsigned k = 0; k < read.mNumVertices; ++k) {
    const aiVector3D& p = read.mVertices[k];
    const aiColor4D& c = read.mColors[0][k];
    // Its own conversion of texts is not exact.
    ASSERT_TRUE((file->points[k] - Eigen::Vector3d(p.x, p.y, p.z)).isZero(1e-5)) << k;
    ASSERT_NEAR(c.r * 255.0F, file->colors[k].r, 0.01);
    ASSERT_NEAR(c.g * 255.0F, file->colors[k].g, 0.01);
    ASSERT_NEAR(c.b * 255.0F, file->colors[k].b, 0.01);
  }
}

TEST_P(PlyFileOf, EveryTypeAndElementIsReadOrPassedOver) {
  const std::string elements =
      "element camera 2\nproperty float view\nproperty list uchar short samples\n"
      "element vertex 4\nproperty double z\nproperty char quality\nproperty int32 x\nproperty list uint8 "
      "float64 more\n"
      "property int16 y\nproperty float red\nproperty float green\nproperty float blue\n"
      "element face 2\nproperty uint id\nproperty list uint ushort vertex_index\n";
  PlyBody body(GetParam());
  for (const float view : {1.5F, -2.0F}) {
    body << view << std::uint8_t{2} << std::int16_t{-7} << std::int16_t{8};
    body.EndLine();
  }
  for (const int k : {0, 1, 2, 3}) {
    body << 0.1 * k << std::int8_t{-1} << std::int32_t{-100000 * k} << std::uint8_t{1} << 3.5;
    body << static_cast<std::int16_t>(-k) << 0.0F << 0.2F << 1.0F;
    body.EndLine();
  }
  for (const std::uint16_t k : {std::uint16_t{4}, std::uint16_t{2}}) {
    body << std::uint32_t{4000000000} << std::uint32_t{k};
    for (std::uint16_t corner = 0; corner < k; ++corner) body << corner;
    body.EndLine();
  }
  const auto file = DecodePly(PlyBytesOf(PlyHeadOf(GetParam(), elements) + body.bytes()));
  ASSERT_TRUE(file) << file.error();
  ASSERT_EQ(file->points.size(), 4U);
  EXPECT_EQ(file->points[3], Eigen::Vector3d(-300000.0, -3.0, 0.1 * 3));
  EXPECT_EQ(file->colors[3], (Rgb{0, 51, 255}));
  EXPECT_THAT(file->triangles, ElementsAre(std::array{0U, 1U, 2U}, std::array{0U, 2U, 3U}));
}

TEST_P(PlyFileOf, AFileThatIsCutOffIsRefusedWhereverItIs) {
  const std::string whole = FileOf(RandomCloud(9));
  std::mt19937 random(9);
  // A text may lose the digits of its last number.
  const std::size_t longest = whole.size() - 5;
  for (int k = 0; k < 200; ++k) {
    const std::size_t length = std::uniform_int_distribution<std::size_t>(0, longest)(random);
    EXPECT_NE(ErrorOfPly(whole.substr(0, length)), "") << length << " of " << whole.size();
  }
}
INSTANTIATE_TEST_SUITE_P(Formats, PlyFileOf,
                         testing::Values("ascii", "binary_little_endian", "binary_big_endian"));

TEST(PlyFileText, MayHaveOtherLineEndsSignsAndSpaces) {
  const std::string text = TextPly("element vertex 2\n" + kPlace, "\n  +1.5\t-2e1 .25 \r\n\r\n4 5 6");
  std::string windows;
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  for (const std::string& file_text : {text, windows}) {
    const auto file = DecodePly(PlyBytesOf(file_text));
    ASSERT_TRUE(file) << file.error();
    EXPECT_THAT(file->points, ElementsAre(Eigen::Vector3d(1.5, -20.0, 0.25), Eigen::Vector3d(4.0, 5.0, 6.0)));
    EXPECT_THAT(file->colors, IsEmpty());
  }
}

TEST(PlyFileText, PointsThatWereNotMeasuredAreLeftOutOfACloudAndRefusedInAMesh) {
  const std::string colored =
      "element vertex 3\n" + kPlace + "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string body = "1 2 3 10 20 30\nnan nan nan 0 0 0\n4 5 6 40 50 60\n";
  const auto file = DecodePly(PlyBytesOf(TextPly(colored, body)));
  ASSERT_TRUE(file) << file.error();
  EXPECT_THAT(file->points, ElementsAre(Eigen::Vector3d(1.0, 2.0, 3.0), Eigen::Vector3d(4.0, 5.0, 6.0)));
  EXPECT_THAT(file->colors, ElementsAre(Rgb{10, 20, 30}, Rgb{40, 50, 60}));
  const std::string mesh = colored + "element face 1\nproperty list uchar int vertex_indices\n";
  EXPECT_THAT(ErrorOfPly(TextPly(mesh, body + "3 0 1 2\n")), HasSubstr("no place for vertex 1"));
  EXPECT_EQ(ErrorOfPly(TextPly("element vertex 1\n" + kPlace, "nan 0 0\n")), "has no vertices with a place");
}

TEST(PlyFileErrors, NameWhatIsWrongWithTheHeader) {
  const auto error_of = [](const std::string& line) { return ErrorOfPly(TextPly(line + "\n", "")); };
  EXPECT_THAT(ErrorOfPly("plyx\n"), HasSubstr("is no PLY"));
  EXPECT_THAT(ErrorOfPly("ply\n"), HasSubstr("ends before its line \"end_header\""));
  EXPECT_THAT(ErrorOfPly("ply\nend_header\n"), HasSubstr("has no line \"format\""));
  EXPECT_THAT(ErrorOfPly(PlyHeadOf("binary", "")), HasSubstr("none of the three formats"));
  EXPECT_THAT(error_of("element vertex -1"), HasSubstr("must state a name and a count"));
  EXPECT_THAT(error_of("element vertex 99999999999999999999"), HasSubstr("must state a name and a count"));
  EXPECT_THAT(error_of("property float x"), HasSubstr("must state types and a name"));
  EXPECT_THAT(error_of("element vertex 1\nproperty half x"), HasSubstr("\"property half x\""));
  EXPECT_THAT(error_of("element vertex 1\nproperty list float x"), HasSubstr("must state types and a name"));
  EXPECT_THAT(error_of("element vertex 1\n" + kPlace + "element vertex 1"), HasSubstr("the second one"));
  std::string many;
  for (int k = 0; k < 65; ++k) many += "element e" + std::to_string(k) + " 0\n";
  EXPECT_THAT(error_of(many), HasSubstr("one of too many elements"));
  EXPECT_THAT(error_of("vertex 1"), HasSubstr("of no kind that it may have"));
  for (const std::string size : {"0", "-1", "nan", "inf", "x"}) {
    EXPECT_THAT(error_of("comment thalweg voxel_size " + size), HasSubstr("a voxel's edge"));
  }
}

TEST(PlyFileErrors, NameWhatIsWrongAndWhere) {
  const auto error_of = [](const std::string& body) {
    return ErrorOfPly(TextPly("element vertex 2\n" + kPlace, body));
  };
  EXPECT_THAT(error_of("1 2 3\n4 5"), HasSubstr("is cut off, in vertex 1 of 2"));
  EXPECT_THAT(error_of("1 2\n4 5 6\n"),
              HasSubstr("has fewer values than its header states, in vertex 0 of 2"));
  EXPECT_THAT(error_of("1 2 3 9\n4 5 6\n"), HasSubstr("has more values than its header states, in vertex 0"));
  EXPECT_THAT(error_of("1 2 3\n4 \x1b[31m 6\n"), HasSubstr("has \"\uFFFD[31m\" for a number, in vertex 1"));
  for (const char* const bad : {"inf", "-inf"}) {
    EXPECT_THAT(error_of("1 2 3\n4 " + std::string(bad) + " 6\n"),
                HasSubstr("has an infinite coordinate, in vertex 1 of 2"));
  }
  EXPECT_THAT(error_of("1 2 3\n4 1e999 6\n"), HasSubstr("has \"1e999\" for a number"));
  EXPECT_EQ(ErrorOfPly(TextPly("element vertex 0\n" + kPlace, "")), "has no vertices with a place");
  EXPECT_EQ(ErrorOfPly(TextPly("", "")), "has no vertices with a place");
  EXPECT_THAT(ErrorOfPly(TextPly("element vertex 1\n", "1 2 3")),
              HasSubstr("has elements without properties"));
  EXPECT_THAT(ErrorOfPly(TextPly("element vertex 1\nproperty float x\n", "1")),
              HasSubstr("has vertices without x, y or z"));
  const std::string colored = "element vertex 1\n" + kPlace + kColor;
  EXPECT_THAT(ErrorOfPly(TextPly(colored, "1 2 3 1 256 3")), HasSubstr("has a color beyond 0 to 255"));
  EXPECT_THAT(ErrorOfPly(TextPly(colored, "1 2 3 1 nan 3")), HasSubstr("has a color beyond 0 to 255"));
  const auto error_of_face = [](const std::string& corners) {
    return ErrorOfPly(
        TextPly("element vertex 3\n" + kPlace + "element face 1\nproperty list int int vertex_indices\n",
                "0 0 0\n1 0 0\n0 1 0\n" + corners));
  };
  EXPECT_EQ(error_of_face("3 0 1 2"), "");
  EXPECT_THAT(error_of_face("3 0 1 3"), HasSubstr("has a face with vertex 3, but only 3 vertices"));
  EXPECT_THAT(error_of_face("3 0 1 -1"), HasSubstr("has a corner that is no vertex, in face 0 of 1"));
  EXPECT_THAT(error_of_face("-3 0 1 2"), HasSubstr("has a list of -3 values"));
  EXPECT_THAT(error_of_face("2000000000 0 1 2"), HasSubstr("is cut off, in face 0 of 1"));
}

TEST(PlyFileErrors, ClaimsOfTheHeaderTakeNoMemory) {
  const std::string little = "binary_little_endian";
  const std::string zeros(24, '\0');
  for (const std::string element : {"vertex", "face", "camera"}) {
    const std::string list = "property list uint double vertex_indices\n";
    EXPECT_THAT(
        ErrorOfPly(PlyHeadOf(little, "element " + element + " 1000000000000\n" + kPlace + list) + zeros),
        HasSubstr("is cut off, in " + element));
  }
  EXPECT_THAT(
      ErrorOfPly(PlyHeadOf(little, "element vertex 1\n" + kPlace + "property list uint double more\n") +
                 std::string(12, '\0') + "\xff\xff\xff\xff"),
      HasSubstr("is cut off, in vertex 0 of 1"));
}

}  // namespace
}  // namespace thalweg::mapper
