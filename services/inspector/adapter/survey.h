#pragma once

#include <stop_token>

#include "common/dds/bus.h"

namespace thalweg::inspector {

/// Waits until discovery has calmed down: nothing new for 2.5 s, or for 4 s while nobody is there or nothing
/// but the names of some; at most 8 s.
/// @param bus  With BusOptions::surveys.
dds::BusGraph Survey(dds::Bus& bus, const std::stop_token& stop);

}  // namespace thalweg::inspector
