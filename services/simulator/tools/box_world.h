#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace thalweg::simulator {

/// A world built of solid boxes and columns that can be written as OBJ. Coordinates are relative to the
/// corner of the room, which lies at `origin`; an origin off the voxel grid makes walls cut voxels as real
/// walls do.
class BoxWorld {
 public:
  BoxWorld(std::string name, const Eigen::Vector3d& origin) : name_(std::move(name)), origin_(origin) {}

  /// @param color  Red, green, blue, each 0 to 1.
  void Material(std::string_view name, const Eigen::Vector3d& color);
  /// Adds a solid box between two corners [m].
  void Box(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  /// Adds a box that is rotated about the vertical axis through its center.
  /// @param yaw_deg   Counterclockwise seen from above.
  /// @param lean_deg  Rotation about the box's own y axis, applied first; positive raises the end at high x.
  void TurnedBox(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                 double yaw_deg, double lean_deg = 0.0);
  /// Adds a solid prism with a regular polygon as its cross section; `from` and `to` are the centers of its
  /// ends.
  void Column(std::string_view material, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
              double radius, int sides = 10);
  /// Whatever is added from now on stands this much higher [m].
  void Lift(double height) { lift_ = height; }
  /// Adds floor, ceiling and four walls, 0.2 m thick, around the room [0, size].
  void Shell(const Eigen::Vector3d& size, std::string_view floor, std::string_view walls,
             std::string_view ceiling);

  const std::string& name() const { return name_; }
  const Eigen::Vector3d& origin() const { return origin_; }
  std::string Obj() const;
  std::string Mtl() const;

 private:
  struct NamedColor {
    std::string name;
    Eigen::Vector3d color;
  };
  struct Solid {
    std::string material;
    std::vector<Eigen::Vector3d> corners;
    std::vector<std::vector<int>> faces;  ///< Indices of corners, counterclockwise seen from outside.
  };
  void Add(std::string_view material, std::vector<Eigen::Vector3d> corners,
           std::vector<std::vector<int>> faces);

  std::string name_;
  Eigen::Vector3d origin_;
  double lift_ = 0.0;  ///< [m]
  std::vector<NamedColor> materials_;
  std::vector<Solid> solids_;
};

}  // namespace thalweg::simulator
