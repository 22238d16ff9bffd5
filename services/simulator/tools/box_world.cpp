#include "services/simulator/tools/box_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/base/angles.h"

namespace thalweg::simulator {
namespace {

constexpr double kWallThickness = 0.2;

// Corner k of a box: bit 0 = high x, bit 1 = high y, bit 2 = high z. Faces are oriented outward.
const std::vector<std::vector<int>> kBoxFaces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                 {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

double Radians(double degrees) {
  return degrees * kDegree;
}

}  // namespace

void BoxWorld::Material(std::string_view name, const Eigen::Vector3d& color) {
  materials_.push_back({std::string(name), color});
}

void BoxWorld::Box(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TurnedBox(material, low, high, 0.0);
}

void BoxWorld::TurnedBox(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                         double yaw_deg, double lean_deg) {
  if (((high - low).array() <= 0.0).any()) throw std::invalid_argument("box without volume");
  const Eigen::Vector3d middle = 0.5 * (low + high);
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(Radians(yaw_deg), Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(-Radians(lean_deg), Eigen::Vector3d::UnitY()))
                                   .toRotationMatrix();
  std::vector<Eigen::Vector3d> corners;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p(corner & 1U ? high.x() : low.x(), corner & 2U ? high.y() : low.y(),
                            corner & 4U ? high.z() : low.z());
    corners.emplace_back(middle + turn * (p - middle));
  }
  Add(material, std::move(corners), kBoxFaces);
}

void BoxWorld::Column(std::string_view material, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                      double radius, int sides) {
  const double length = (to - from).norm();
  if (length <= 0.0 || radius <= 0.0 || sides < 3) throw std::invalid_argument("column without volume");
  const Eigen::Vector3d along = (to - from) / length;
  const Eigen::Vector3d aside =
      along.cross(std::abs(along.z()) > 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ())
          .normalized();
  const Eigen::Vector3d across = along.cross(aside);
  std::vector<Eigen::Vector3d> corners;  // around the lower end, then around the upper end
  for (const Eigen::Vector3d& end : {from, to}) {
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / sides;
      corners.emplace_back(end + radius * (std::cos(angle) * aside + std::sin(angle) * across));
    }
  }
  std::vector<std::vector<int>> faces(2);
  for (int k = 0; k < sides; ++k) {
    faces[0].push_back(sides - 1 - k);
    faces[1].push_back(sides + k);
    const int next = (k + 1) % sides;
    faces.push_back({k, next, sides + next, sides + k});
  }
  Add(material, std::move(corners), std::move(faces));
}

void BoxWorld::Add(std::string_view material, std::vector<Eigen::Vector3d> corners,
                   std::vector<std::vector<int>> faces) {
  const bool known = std::any_of(materials_.begin(), materials_.end(),
                                 [&](const NamedColor& entry) { return entry.name == material; });
  if (!known) throw std::invalid_argument("no material " + std::string(material));
  for (Eigen::Vector3d& corner : corners) corner.z() += lift_;
  solids_.push_back({std::string(material), std::move(corners), std::move(faces)});
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
  out << "# " << name_ << ": made by thalweg-make-worlds. Meters, z up.\nmtllib " << name_ << ".mtl\n";
  int first = 1;
  std::string material;
  for (const Solid& solid : solids_) {
    for (const Eigen::Vector3d& corner : solid.corners) {
      const Eigen::Vector3d placed = origin_ + corner;
      out << "v " << placed.x() << ' ' << placed.y() << ' ' << placed.z() << '\n';
    }
    if (solid.material != material) out << "usemtl " << (material = solid.material) << '\n';
    for (const auto& face : solid.faces) {
      out << 'f';
      for (const int corner : face) out << ' ' << first + corner;
      out << '\n';
    }
    first += static_cast<int>(solid.corners.size());
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
