#include "services/explorer/adapter/markers.h"

#include <algorithm>
#include <cmath>

#include "services/explorer/adapter/convert.h"
#include "services/explorer/text/outcome_text.h"

namespace thalweg::explorer {
namespace {

using visualization_msgs::msg::Marker;

// As defined by visualization_msgs/Marker.
constexpr std::int32_t kSphere = 2;
constexpr std::int32_t kTextFacingViewer = 9;
constexpr std::int32_t kAdd = 0;
constexpr std::int32_t kDeleteAll = 3;

constexpr double kLetterHeight = 0.12;  // [m]

std_msgs::msg::ColorRGBA ColorOf(thalweg_msgs::msg::FrontierFate fate) {
  std_msgs::msg::ColorRGBA color;
  const auto set = [&](float r, float g, float b, float a) {
    color.r(r);
    color.g(g);
    color.b(b);
    color.a(a);
  };
  if (fate == thalweg_msgs::msg::FRONTIER_CHOSEN) {
    set(0.2F, 0.8F, 0.3F, 0.9F);
  } else if (fate == thalweg_msgs::msg::FRONTIER_LEFT) {
    set(0.2F, 0.5F, 0.9F, 0.8F);
  } else {
    set(0.6F, 0.6F, 0.6F, 0.5F);
  }
  return color;
}

Marker MakeMarker(const std_msgs::msg::Header& header, const char* group, std::int32_t id, std::int32_t type,
                  const thalweg_msgs::msg::Frontier& frontier) {
  Marker marker;
  marker.header(header);
  marker.ns(group);
  marker.id(id);
  marker.type(type);
  marker.action(kAdd);
  marker.pose().position(frontier.center());
  marker.pose().orientation().w(1.0);
  marker.color(ColorOf(frontier.fate()));
  return marker;
}

}  // namespace

visualization_msgs::msg::MarkerArray MarkersOf(const thalweg_msgs::msg::FrontierList& list) {
  visualization_msgs::msg::MarkerArray array;
  Marker& clear = array.markers().emplace_back();
  clear.header(list.header());
  clear.action(kDeleteAll);
  std::int32_t id = 0;
  for (const thalweg_msgs::msg::Frontier& frontier : list.frontiers()) {
    // A cluster is a patch of a surface: its extent grows with the root of its voxels.
    const double diameter = std::clamp(0.05 * std::sqrt(static_cast<double>(frontier.voxels())), 0.1, 1.0);
    Marker sphere = MakeMarker(list.header(), "frontiers", id, kSphere, frontier);
    sphere.scale().x(diameter);
    sphere.scale().y(diameter);
    sphere.scale().z(diameter);
    array.markers().push_back(std::move(sphere));
    const std::string why = AsideText(FromIdl(frontier.reason()), frontier.doubtful());
    if (!why.empty()) {
      Marker text = MakeMarker(list.header(), "reasons", id, kTextFacingViewer, frontier);
      text.pose().position().z(frontier.center().z() + 0.5 * diameter + kLetterHeight);
      text.scale().z(kLetterHeight);
      text.text(why);
      array.markers().push_back(std::move(text));
    }
    ++id;
  }
  return array;
}

}  // namespace thalweg::explorer
