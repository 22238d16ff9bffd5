#include "services/simulator/adapter/load_mesh.h"

#include <spdlog/spdlog.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"
#include "services/simulator/adapter/moving_parts.h"
#include "services/simulator/core/reachable.h"

namespace thalweg::simulator {
namespace {

constexpr double kStartClearance = 0.3;  // [m] least free radius around a random start
constexpr double kMostVoxels = 4e8;      // of the true map: 2 GB
// [m] Farther from the origin, single precision no longer resolves a centimeter.
constexpr double kFarthestVertex = 1e5;

std::string Slashes(std::string path) {
  std::replace(path.begin(), path.end(), '\\', '/');
  return path;
}

bool IsKeyword(const std::string& line, const char* keyword, std::string& rest) {
  std::istringstream words(line);
  std::string first;
  if (!(words >> first) || first != keyword) return false;
  std::getline(words, rest);
  return true;
}

std::runtime_error ErrorAt(const std::filesystem::path& file, int line, const std::string& what) {
  return std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + what);
}

/// Checks the three coordinates of a vertex, which a weight or a color may follow. Error: what is wrong.
std::optional<std::string> MistakeInVertex(const std::string& coordinates, double scale) {
  std::istringstream words(coordinates);
  int count = 0;
  for (std::string word; count < 3 && words >> word; ++count) {
    const std::string named = std::string("the vertex's ") + "xyz"[count] + " is '" + word + "', ";
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (end != word.c_str() + word.size() || !std::isfinite(value)) return named + "must be a finite number";
    if (std::abs(value * scale) > kFarthestVertex) {
      std::ostringstream limit;
      limit << named << "with world.scale " << scale << " more than " << kFarthestVertex
            << " m from the origin";
      return limit.str();
    }
  }
  if (count < 3) return "the vertex has " + std::to_string(count) + " coordinates, must have 3";
  return std::nullopt;
}

/// Checks vertices and faces before tinyobjloader sees the file, because tinyobjloader silently reads a
/// number that it does not understand as 0, drops faces that refer to missing vertices and does not report
/// the line.
void CheckFile(const std::filesystem::path& file, double scale) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  struct Face {
    int line;
    long vertices_so_far;
    std::string corners;
  };
  std::vector<Face> faces;
  long vertices = 0;
  int line_number = 0;
  std::string rest;
  for (std::string line; std::getline(stream, line);) {
    ++line_number;
    if (IsKeyword(line, "v", rest)) {
      ++vertices;
      if (const auto mistake = MistakeInVertex(rest, scale)) throw ErrorAt(file, line_number, *mistake);
    }
    if (IsKeyword(line, "f", rest)) faces.push_back({line_number, vertices, rest});
  }
  for (const Face& face : faces) {
    std::istringstream corners(face.corners);
    int count = 0;
    for (std::string corner; corners >> corner; ++count) {
      const long index = std::strtol(corner.c_str(), nullptr, 10);
      const bool exists = index > 0 ? index <= vertices : index < 0 && index >= -face.vertices_so_far;
      if (exists) continue;
      throw ErrorAt(
          file, face.line,
          "the face's corner '" + corner + "' is not one of " + std::to_string(vertices) + " vertices");
    }
    if (count < 3) throw ErrorAt(file, face.line, "the face has " + std::to_string(count) + " corners");
  }
  if (faces.empty()) throw std::runtime_error(file.string() + ": no faces");
}

/// Loads each image once. An image that cannot be read yields index -1 and a warning.
class TextureTable {
 public:
  TextureTable(std::filesystem::path folder, LoadedMesh& loaded)
      : folder_(std::move(folder)), loaded_(loaded) {}

  int Find(const std::string& name) {
    if (name.empty()) return -1;
    const auto [entry, is_new] = known_.try_emplace(name, -1);
    if (is_new) entry->second = Load(name);
    return entry->second;
  }

 private:
  int Load(const std::string& name) {
    const std::filesystem::path file = folder_ / Slashes(name);
    const cv::Mat image =
        std::filesystem::exists(file) ? cv::imread(file.string(), cv::IMREAD_COLOR) : cv::Mat();
    if (image.empty()) {
      loaded_.warnings.push_back(file.string() + ": texture cannot be read; the pattern is used instead");
      return -1;
    }
    Texture texture{image.cols, image.rows, {}};
    texture.pixels.reserve(image.total());
    for (int row = 0; row < image.rows; ++row) {
      for (int column = 0; column < image.cols; ++column) {
        const auto& bgr = image.at<cv::Vec3b>(row, column);
        texture.pixels.push_back({bgr[2], bgr[1], bgr[0]});
      }
    }
    loaded_.mesh.textures.push_back(std::move(texture));
    return static_cast<int>(loaded_.mesh.textures.size()) - 1;
  }

  std::filesystem::path folder_;
  LoadedMesh& loaded_;
  std::map<std::string, int> known_;
};

Rgb ToRgb(const tinyobj::real_t color[3]) {
  const auto channel = [](tinyobj::real_t value) {
    return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F)));
  };
  return {channel(color[0]), channel(color[1]), channel(color[2])};
}

void AddVertices(const tinyobj::attrib_t& attributes, UpAxis up_axis, double scale, Mesh& mesh) {
  const auto s = static_cast<float>(scale);
  mesh.vertices.reserve(attributes.vertices.size() / 3);
  for (std::size_t i = 0; i + 2 < attributes.vertices.size(); i += 3) {
    const float x = attributes.vertices[i];
    const float y = attributes.vertices[i + 1];
    const float z = attributes.vertices[i + 2];
    mesh.vertices.push_back(up_axis == UpAxis::kY ? Eigen::Vector3f(s * x, -s * z, s * y)
                                                  : Eigen::Vector3f(s * x, s * y, s * z));
  }
}

void AddTriangles(const tinyobj::attrib_t& attributes, const tinyobj::mesh_t& shape, Mesh& mesh) {
  for (std::size_t face = 0; face < shape.num_face_vertices.size(); ++face) {
    std::array<std::uint32_t, 3> corners{};
    std::array<Eigen::Vector2f, 3> uvs;
    for (std::size_t k = 0; k < 3; ++k) {
      const tinyobj::index_t& index = shape.indices[3 * face + k];
      corners[k] = static_cast<std::uint32_t>(index.vertex_index);
      const std::size_t uv = 2 * static_cast<std::size_t>(std::max(index.texcoord_index, 0));
      uvs[k] = index.texcoord_index >= 0 && uv + 1 < attributes.texcoords.size()
                   ? Eigen::Vector2f(attributes.texcoords[uv], attributes.texcoords[uv + 1])
                   : Eigen::Vector2f::Zero();
    }
    mesh.triangles.push_back(corners);
    mesh.uvs.push_back(uvs);
    mesh.materials.push_back(shape.material_ids[face]);
  }
}

/// Formats a size as "8.4 x 8.4 x 3.4 m".
std::string SizeText(const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d size = box.sizes();
  std::ostringstream text;
  text << std::setprecision(4) << size.x() << " x " << size.y() << " x " << size.z() << " m";
  return text.str();
}

Eigen::AlignedBox3d ExtentOf(const Mesh& mesh) {
  Eigen::AlignedBox3d extent;
  for (const Eigen::Vector3f& vertex : mesh.vertices) extent.extend(vertex.cast<double>());
  return extent;
}

/// "2 parts move; ", or nothing where none does.
std::string MovingText(const World& world) {
  const std::size_t count = world.parts().size();
  if (count == 0) return "";
  return std::to_string(count) + (count == 1 ? " part moves; " : " parts move; ");
}

Eigen::Vector3d GivenStart(const Scenario& scenario, const World& world) {
  const thalweg::Simulator& simulator = scenario.simulator();
  const Vector3& position = simulator.start_position_m();
  return simulator.has_start_position_m() ? Eigen::Vector3d(position.x(), position.y(), position.z())
                                          : world.bounds().center();
}

/// Runs `work` and prefixes its std::invalid_argument with the scenario field that gives the start.
template <class Do>
auto NamingTheField(Do&& work) {
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("simulator.start_position_m: ") + error.what());
  }
}

}  // namespace

void Visit(OptionVisitor& visitor, WorldOptions& options) {
  visitor.Choice("up_axis", options.up_axis, {{"Z", UpAxis::kZ}, {"Y", UpAxis::kY}});
  visitor.Number("scale", options.scale);
}

void Visit(OptionVisitor& visitor, StartOptions& options) {
  visitor.Degrees("start_yaw_deg", options.yaw);
  visitor.Whole("start_seed", options.seed);
}

LoadedMesh LoadObj(const std::filesystem::path& file, UpAxis up_axis, double scale) {
  CheckFile(file, scale);
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning;
  std::string error;
  const std::string folder = file.parent_path().empty() ? "./" : file.parent_path().string() + "/";
  const bool read = tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, file.c_str(),
                                     folder.c_str(), true);
  if (!read || !error.empty()) throw std::runtime_error(file.string() + ": " + error);

  LoadedMesh loaded;
  if (!warning.empty()) loaded.warnings.push_back(file.string() + ": " + warning);
  TextureTable textures(file.parent_path(), loaded);
  for (const tinyobj::material_t& material : materials) {
    loaded.mesh.material_table.push_back({ToRgb(material.diffuse), textures.Find(material.diffuse_texname)});
  }
  AddVertices(attributes, up_axis, scale, loaded.mesh);
  for (const tinyobj::shape_t& shape : shapes) AddTriangles(attributes, shape.mesh, loaded.mesh);
  return loaded;
}

World LoadWorld(const Scenario& scenario) {
  const thalweg::World& world = scenario.world();
  if (!world.has_file()) throw std::runtime_error("world.file: no world is given");
  WorldOptions options;
  ReadOptions(world, options);
  LoadedMesh loaded = LoadObj(world.file(), options.up_axis, options.scale);
  for (const std::string& warning : loaded.warnings) spdlog::warn("{}", warning);
  Eigen::AlignedBox3d bounds = ExtentOf(loaded.mesh);
  if (world.has_bounds_min_m()) bounds.min() = ToEigen(world.bounds_min_m());
  if (world.has_bounds_max_m()) bounds.max() = ToEigen(world.bounds_max_m());
  return World(std::move(loaded.mesh), bounds, NoGoFrom(scenario), MovingPartsFrom(scenario));
}

std::string DescriptionOf(const Scenario& scenario, const World& world) {
  return "world " + std::filesystem::path(scenario.world().file()).filename().string() + ": " +
         SizeText(ExtentOf(world.mesh())) + ", " + std::to_string(world.mesh().triangles.size()) +
         " triangles; " + MovingText(world) + "explored within " + SizeText(world.bounds());
}

void CheckExtent(const World& world, double voxel_size) {
  const double voxels = (world.bounds().sizes() / voxel_size).prod();
  if (voxels <= kMostVoxels) return;
  std::ostringstream text;
  text << std::setprecision(2) << "world.scale: the world's bounds are " << SizeText(world.bounds()) << ", "
       << voxels << " voxels of " << voxel_size << " m, more than " << kMostVoxels
       << "; a file in millimeters needs world.scale = 0.001, a large world smaller bounds or larger voxels";
  throw std::invalid_argument(text.str());
}

std::vector<Eigen::Vector3d> StartPlacesFrom(const Scenario& scenario, const World& world,
                                             const RobotModel& robot) {
  CheckExtent(world, robot.radius);  // must pass before voxels are allocated
  return NamingTheField([&] {
    return StartPlaces(world, GivenStart(scenario, world), robot, std::max(kStartClearance, robot.radius));
  });
}

RigidTransform StartFrom(const Scenario& scenario, const World& world, const RobotModel& robot) {
  StartOptions options;
  ReadOptions(scenario.simulator(), options);
  if (options.seed != 0) return RandomStart(StartPlacesFrom(scenario, world, robot), options.seed);
  const Eigen::Vector3d start = GivenStart(scenario, world);
  NamingTheField([&] { CheckStart(world, start, robot); });
  return MakeTransform(RotationFromYawPitch(options.yaw, 0.0), start);
}

}  // namespace thalweg::simulator
