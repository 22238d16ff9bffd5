#pragma once

#include <vector>

#include "common/base/megabytes.h"
#include "common/base/option_visitor.h"
#include "common/base/time.h"
#include "common/scenario/mistakes.h"
#include "common/scenario/scenario.h"
#include "services/link/core/cloud_codec.h"
#include "services/link/core/endpoint.h"
#include "services/link/core/pose_thinning.h"

namespace thalweg::link {

/// Where a link stands.
enum class Side { kOnboard, kOffboard };

struct LinkOptions {
  int domain = 100;                                                            ///< The two links' own.
  double pose_rate = 20.0;                                                     ///< [Hz] By the run's time.
  double clock_rate = 20.0;                                                    ///< [Hz] By the run's time.
  int keep_mb = static_cast<int>(Endpoint::Options{}.keep_bytes / kMegabyte);  ///< [MB]
  Duration lost_after = Endpoint::Options{}.lost_after;
  Duration command_age = std::chrono::seconds(1);
  CloudCodecOptions clouds;
  bool wall_clock = false;  ///< Whether the run's time is that of the machines.
};

void Visit(OptionVisitor& visitor, LinkOptions& options);  ///< Block `link`.

LinkOptions OptionsFrom(const Scenario& scenario);

/// Finds that the links have no DDS domain of their own. For LoadScenario.
/// @param local_domain  The domain of the services on this machine.
std::vector<Mistake> MistakesIn(const Scenario& scenario, int local_domain);

}  // namespace thalweg::link
