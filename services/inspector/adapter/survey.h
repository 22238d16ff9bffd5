#pragma once

#include <stop_token>

#include "common/dds/bus.h"

namespace thalweg::inspector {

/// Waits until discovery has calmed down: nobody new for 1.5 s, or nobody at all for 4 s; at most 6 s.
/// @param bus  With BusOptions::surveys.
dds::BusGraph Survey(dds::Bus& bus, const std::stop_token& stop);

}  // namespace thalweg::inspector
