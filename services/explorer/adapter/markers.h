#pragma once

#include "common/dds/topics.h"

namespace thalweg::explorer {

/// Frontiers as rviz draws them without plug-ins: spheres as large as their cluster, green the chosen one,
/// blue those left, gray those set aside, with the reason above. Replaces all markers before.
visualization_msgs::msg::MarkerArray MarkersOf(const thalweg_msgs::msg::FrontierList& list);

}  // namespace thalweg::explorer
