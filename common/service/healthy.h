#pragma once

#include <string>

#include "common/dds/bus.h"

namespace thalweg {

/// Whether the copy of a service that runs on this machine does its work.
struct Healthiness {
  bool healthy = false;
  std::string text;  ///< A sentence that says so, or what is wrong.
};

/// Listens for the health of the service named `options.name` in its domain and partition: a copy on this
/// machine is healthy if its loop advances, which two messages in a row show. Blocks until then, for at most
/// `patience`.
Healthiness CheckHealthy(dds::BusOptions options, Duration patience);

}  // namespace thalweg
