#include "services/simulator/tools/box_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iomanip>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace thalweg::simulator {
namespace {

constexpr double kWallThickness = 0.2;

// Corner k of a box: bit 0 = high x, bit 1 = high y, bit 2 = high z. Faces turn outwards.
constexpr std::array<std::array<int, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

}  // namespace

void BoxWorld::Material(std::string_view name, const Eigen::Vector3d& color) {
  materials_.push_back({std::string(name), color});
}

void BoxWorld::Box(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TurnedBox(material, low, high, 0.0);
}

void BoxWorld::TurnedBox(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                         double yaw_deg) {
  if (((high - low).array() <= 0.0).any()) throw std::invalid_argument("box without volume");
  const bool known = std::any_of(materials_.begin(), materials_.end(),
                                 [&](const NamedColor& entry) { return entry.name == material; });
  if (!known) throw std::invalid_argument("no material " + std::string(material));
  solids_.push_back({std::string(material), low, high, yaw_deg * std::numbers::pi / 180.0});
}

void BoxWorld::Shell(const Eigen::Vector3d& size, std::string_view floor, std::string_view walls,
                     std::string_view ceiling) {
  const double t = kWallThickness;
  const auto [x, y, z] = std::array<double, 3>{size.x(), size.y(), size.z()};
  Box(floor, {-t, -t, -t}, {x + t, y + t, 0});
  Box(ceiling, {-t, -t, z}, {x + t, y + t, z + t});
  Box(walls, {-t, -t, 0}, {0, y + t, z});
  Box(walls, {x, -t, 0}, {x + t, y + t, z});
  Box(walls, {0, -t, 0}, {x, 0, z});
  Box(walls, {0, y, 0}, {x, y + t, z});
}

std::string BoxWorld::Obj() const {
  std::ostringstream out;
  out << std::fixed << std::setprecision(4);
  out << "# " << name_ << ": made by thalweg-make-worlds. Metres, z up.\nmtllib " << name_ << ".mtl\n";
  int first = 1;
  std::string material;
  for (const Solid& solid : solids_) {
    const Eigen::Vector3d middle = 0.5 * (solid.low + solid.high);
    const Eigen::AngleAxisd turn(solid.yaw, Eigen::Vector3d::UnitZ());
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p(corner & 1U ? solid.high.x() : solid.low.x(),
                              corner & 2U ? solid.high.y() : solid.low.y(),
                              corner & 4U ? solid.high.z() : solid.low.z());
      const Eigen::Vector3d placed = origin_ + middle + turn * (p - middle);
      out << "v " << placed.x() << ' ' << placed.y() << ' ' << placed.z() << '\n';
    }
    if (solid.material != material) out << "usemtl " << (material = solid.material) << '\n';
    for (const auto& face : kFaces) {
      out << 'f';
      for (const int corner : face) out << ' ' << first + corner;
      out << '\n';
    }
    first += 8;
  }
  return out.str();
}

std::string BoxWorld::Mtl() const {
  std::ostringstream out;
  out << std::fixed << std::setprecision(3);
  for (const NamedColor& material : materials_) {
    out << "newmtl " << material.name << "\nKd " << material.color.x() << ' ' << material.color.y() << ' '
        << material.color.z() << '\n';
  }
  return out.str();
}

}  // namespace thalweg::simulator
