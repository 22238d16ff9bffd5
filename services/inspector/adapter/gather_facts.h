#pragma once

#include <filesystem>
#include <stop_token>

#include "common/dds/bus.h"
#include "services/inspector/core/diagnosis.h"

namespace thalweg::inspector {

/// Looks at this machine, then at the bus for some seconds.
/// @param options  With BusOptions::surveys; a bus is made of them, whose errors are thrown.
/// @param out_folder  Where runs leave their files.
Facts GatherFacts(const dds::BusOptions& options, const std::filesystem::path& out_folder,
                  const std::stop_token& stop);

}  // namespace thalweg::inspector
