#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace thalweg::simulator {

/// A world built of solid boxes and columns, for writing as OBJ. Coordinates are those of the room, whose
/// corner lies at `origin`: away from the voxels' grid, as real walls do.
class BoxWorld {
 public:
  BoxWorld(std::string name, const Eigen::Vector3d& origin) : name_(std::move(name)), origin_(origin) {}

  /// @param color  0 to 1, red, green, blue.
  void Material(std::string_view name, const Eigen::Vector3d& color);
  /// A solid box between two corners [m].
  void Box(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  /// The same, turned about the vertical through its middle. @param yaw_deg  Counter-clockwise from above.
  /// @param lean_deg  Before that, about its own y axis: raises the end at high x.
  void TurnedBox(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                 double yaw_deg, double lean_deg = 0.0);
  /// A solid prism with a regular outline about the line between the middles of its ends.
  void Column(std::string_view material, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
              double radius, int sides = 10);
  /// Floor, ceiling and four walls, 0.2 m thick, around the room [0, size].
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
    std::vector<std::vector<int>> faces;  ///< Corners, counter-clockwise from outside.
  };
  void Add(std::string_view material, std::vector<Eigen::Vector3d> corners,
           std::vector<std::vector<int>> faces);

  std::string name_;
  Eigen::Vector3d origin_;
  std::vector<NamedColor> materials_;
  std::vector<Solid> solids_;
};

}  // namespace thalweg::simulator
