#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace thalweg::gateway {

/// The headers of an HTTP request by which the gateway decides whether to serve it; "" where absent.
struct RequestHead {
  std::string_view target;         ///< Path and query, e.g. "/?token=secret".
  std::string_view host;           ///< Header Host.
  std::string_view origin;         ///< Header Origin, which browsers send and most other clients do not.
  std::string_view authorization;  ///< Header Authorization.
  std::string_view protocols;      ///< Header Sec-WebSocket-Protocol, a list separated by commas.
};

/// Why a request is refused.
struct Refusal {
  int http_status;
  std::string reason;
};

/// Who may open a WebSocket.
///
/// Without a token, only this machine may: the gateway listens on a loopback address, and a request must name
/// the gateway as localhost, so that a page from elsewhere whose host name was made to resolve to 127.0.0.1
/// is refused as well. A browser must in either case come from the gateway's own page, since browsers let
/// any page open a socket to any address.
class Access {
 public:
  /// @param token  "" = none, which is allowed only on a loopback address: throws std::invalid_argument
  ///               otherwise, or if the token has a character that a URL would have to escape.
  /// @param read_only  Nobody may steer, and why; nothing = who may connect may also steer.
  /// @param origins    Other pages that may open a socket, e.g. "https://app.foxglove.dev"; separated by
  /// commas.
  Access(std::string_view address, std::string token, std::optional<std::string> read_only = {},
         std::string_view origins = {});

  std::optional<Refusal> RefusePage(const RequestHead& head) const;  ///< For files of the page.
  /// By origin and token: what a page may ask first, since browsers hide from it why a socket was refused.
  std::optional<Refusal> RefuseClient(const RequestHead& head) const;
  std::optional<Refusal> RefuseSocket(const RequestHead& head) const;  ///< The same, and by its subprotocols.
  /// Why a client that may open a socket may not steer the robot; nothing if it may: from this machine, and
  /// from another one only with the token.
  std::optional<std::string> RefuseSteering(std::string_view peer_address) const;

 private:
  std::string token_;
  std::optional<std::string> read_only_;
  std::string origins_;
};

/// The name that a client gives itself by ?name=... in its address, cut to 24 letters, digits, - and _; or
/// "client".
std::string NameOfClient(std::string_view target);

/// True for 127.0.0.0/8 and ::1.
bool IsLoopback(std::string_view address);

/// The first of the client's subprotocols that the gateway speaks; "" if there is none.
/// foxglove.websocket.v1 is that of earlier clients, foxglove.sdk.v1 the same frames under a newer name.
std::string_view ChooseProtocol(std::string_view offered);

/// The path of a target without its query: "/a.js?x=1" -> "/a.js".
std::string_view PathOf(std::string_view target);
/// The value of `name` in the query of a target, not unescaped; "" if absent.
std::string_view QueryValue(std::string_view target, std::string_view name);

}  // namespace thalweg::gateway
