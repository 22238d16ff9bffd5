#include "services/surface/adapter/rift_message.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <utility>

namespace thalweg::surface {
namespace {

using visualization_msgs::msg::Marker;

// As defined by visualization_msgs/Marker.
constexpr std::int32_t kArrow = 0;
constexpr std::int32_t kLineList = 5;
constexpr std::int32_t kTextFacingViewer = 9;
constexpr std::int32_t kAdd = 0;
constexpr std::int32_t kDeleteAll = 3;

constexpr double kLineWidth = 0.015;    // [m]
constexpr double kArrowLength = 0.3;    // [m]
constexpr double kArrowWidth = 0.03;    // [m]
constexpr double kLetterHeight = 0.12;  // [m]

geometry_msgs::msg::Point PointOf(const Eigen::Vector3f& p_W) {
  geometry_msgs::msg::Point point;
  point.x(static_cast<double>(p_W.x()));
  point.y(static_cast<double>(p_W.y()));
  point.z(static_cast<double>(p_W.z()));
  return point;
}

thalweg_msgs::msg::RiftFate ToIdl(MeshRift::Fate fate) {
  switch (fate) {
    case MeshRift::Fate::kOpen:
      return thalweg_msgs::msg::RIFT_OPEN;
    case MeshRift::Fate::kMerged:
      return thalweg_msgs::msg::RIFT_MERGED;
    case MeshRift::Fate::kClosed:
      break;
  }
  return thalweg_msgs::msg::RIFT_CLOSED;
}

thalweg_msgs::msg::SurfaceRift ToIdl(const MeshRift& rift) {
  thalweg_msgs::msg::SurfaceRift message;
  message.number(rift.number);
  message.fate(ToIdl(rift.fate));
  message.merged_into(rift.merged_into);
  message.center(PointOf(rift.center_W));
  message.nearest(PointOf(rift.nearest_W));
  message.normal().x(static_cast<double>(rift.normal_W.x()));
  message.normal().y(static_cast<double>(rift.normal_W.y()));
  message.normal().z(static_cast<double>(rift.normal_W.z()));
  message.length_m(rift.length);
  message.edges(rift.edges);
  message.distance_m(rift.distance);
  message.weight(rift.weight);
  return message;
}

void Paint(Marker& marker, float r, float g, float b) {
  marker.color().r(r);
  marker.color().g(g);
  marker.color().b(b);
  marker.color().a(0.9F);
}

void Resize(Marker& marker, double x, double y, double z) {
  marker.scale().x(x);
  marker.scale().y(y);
  marker.scale().z(z);
}

}  // namespace

thalweg_msgs::msg::SurfaceRifts ToIdl(const MeshRifts& rifts) {
  thalweg_msgs::msg::SurfaceRifts message;
  message.open(static_cast<std::uint32_t>(rifts.open().size()));
  for (std::size_t k = 0; k < std::min(rifts.open().size(), kMostOpenRifts); ++k) {
    message.rifts().push_back(ToIdl(rifts.open()[k]));
  }
  for (const MeshRift& rift : rifts.ended()) message.rifts().push_back(ToIdl(rift));
  return message;
}

visualization_msgs::msg::MarkerArray MarkersOf(const MeshRifts& rifts, const std_msgs::msg::Header& header) {
  visualization_msgs::msg::MarkerArray array;
  Marker& clear = array.markers().emplace_back();
  clear.header(header);
  clear.action(kDeleteAll);
  for (std::size_t k = 0; k < std::min(rifts.open().size(), kMostOpenRifts); ++k) {
    const MeshRift& rift = rifts.open()[k];
    const auto make = [&](const char* group, std::int32_t type) {
      Marker marker;
      marker.header(header);
      marker.ns(group);
      marker.id(static_cast<std::int32_t>(rift.number));
      marker.type(type);
      marker.action(kAdd);
      marker.pose().orientation().w(1.0);
      if (rift.distance == MeshRift::kNoPath) {
        Paint(marker, 0.6F, 0.6F, 0.6F);
      } else if (k == 0) {
        Paint(marker, 0.9F, 0.2F, 0.1F);
      } else {
        Paint(marker, 0.95F, 0.6F, 0.1F);
      }
      return marker;
    };
    Marker line = make("lines", kLineList);
    Resize(line, kLineWidth, 0.0, 0.0);
    for (const auto& ends : rift.line_W) {
      for (const Eigen::Vector3f& p_W : ends) line.points().push_back(PointOf(p_W));
    }
    array.markers().push_back(std::move(line));
    if (!rift.normal_W.isZero()) {
      Marker arrow = make("normals", kArrow);
      const auto R =
          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), rift.normal_W.cast<double>());
      arrow.pose().position(PointOf(rift.center_W));
      arrow.pose().orientation().x(R.x());
      arrow.pose().orientation().y(R.y());
      arrow.pose().orientation().z(R.z());
      arrow.pose().orientation().w(R.w());
      Resize(arrow, kArrowLength, kArrowWidth, kArrowWidth);
      array.markers().push_back(std::move(arrow));
    }
    Marker number = make("numbers", kTextFacingViewer);
    number.pose().position(PointOf(rift.center_W));
    Resize(number, 0.0, 0.0, kLetterHeight);
    number.text(std::to_string(rift.number));
    array.markers().push_back(std::move(number));
  }
  return array;
}

}  // namespace thalweg::surface
