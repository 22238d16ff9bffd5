#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "services/gateway/adapter/options.h"
#include "services/gateway/adapter/page_files.h"
#include "services/gateway/core/access.h"
#include "services/gateway/core/hub.h"

namespace thalweg::gateway {

/// Serves the page's files and the hub's WebSocket clients on one port.
///
/// Threading: a thread of its own, which alone uses the hub. Post may be called from any thread.
class WebServer {
 public:
  /// Called on the server's thread.
  struct Handlers {
    /// Topics come to be wanted, or are no longer.
    std::function<void(const Hub::WantedChanges&)> wanted;
    /// A client commands the robot. Answered by Hub::Answer.
    std::function<void(Hub::ClientId, const ClientInfo&, const ClientCommand&)> command;
  };

  /// Starts to serve. Throws std::runtime_error naming address and port if it cannot, and
  /// std::invalid_argument if a token is missing.
  WebServer(const ListenOptions& options, Hub::Options content, PageFiles page, Handlers handlers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const;
  /// Runs `task` on the server's thread; afterwards, what waits for the clients is written.
  void Post(std::function<void(Hub&)> task);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace thalweg::gateway
