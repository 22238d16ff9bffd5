#pragma once

#include "common/base/option_visitor.h"
#include "common/base/time.h"
#include "common/scenario/scenario.h"
#include "services/link/core/cloud_codec.h"
#include "services/link/core/pose_thinning.h"

namespace thalweg::link {

/// Where a link stands.
enum class Side { kOnboard, kOffboard };

struct LinkOptions {
  int domain = 100;          ///< Of the two links.
  double pose_rate = 20.0;   ///< [Hz] Of the run's time.
  double clock_rate = 20.0;  ///< [Hz] Of the run's time.
  int keep_mb = 64;          ///< [MB]
  Duration lost_after = std::chrono::seconds(2);
  Duration command_age = std::chrono::seconds(1);
  CloudCodecOptions clouds;
  bool wall_clock = false;  ///< Whether the run's time is that of the machines.
};

void Visit(OptionVisitor& visitor, LinkOptions& options);  ///< Block `link`.

/// @param local_domain  Of the services on this machine. Throws std::invalid_argument if it is the link's,
/// too.
LinkOptions OptionsFrom(const Scenario& scenario, int local_domain);

}  // namespace thalweg::link
