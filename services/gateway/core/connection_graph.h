#pragma once

#include <map>
#include <set>
#include <string>

namespace thalweg::gateway {

/// Who publishes and who subscribes to what, and who offers which services, by name.
struct ConnectionGraph {
  using Nodes = std::set<std::string>;
  std::map<std::string, Nodes> publishers;   ///< By topic.
  std::map<std::string, Nodes> subscribers;  ///< By topic.
  std::map<std::string, Nodes> providers;    ///< By service.

  friend bool operator==(const ConnectionGraph&, const ConnectionGraph&) = default;
};

}  // namespace thalweg::gateway
