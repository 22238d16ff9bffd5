#include "services/gateway/core/access.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <stdexcept>

#include "common/base/text.h"

namespace thalweg::gateway {
namespace {

constexpr std::array<std::string_view, 2> kProtocols = {"foxglove.websocket.v1", "foxglove.sdk.v1"};

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

/// "localhost:8765" -> "localhost", "[::1]:8765" -> "::1"
std::string HostName(std::string_view host) {
  if (host.starts_with('[')) return Lower(host.substr(1, host.find(']') - 1));
  return Lower(host.substr(0, host.find(':')));
}

/// Takes the same time wherever the first difference is.
bool SameSecret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t k = 0; k < a.size() && k < b.size(); ++k) {
    difference |= static_cast<unsigned char>(a[k]) ^ static_cast<unsigned char>(b[k]);
  }
  return difference == 0;
}

bool Contains(std::string_view list, std::string_view item) {
  while (!list.empty()) {
    const std::string_view each = list.substr(0, list.find(','));
    if (Trimmed(each) == item) return true;
    list.remove_prefix(std::min(list.size(), each.size() + 1));
  }
  return false;
}

bool NeedsNoEscape(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.' || c == '~';
}

}  // namespace

bool IsLoopback(std::string_view address) {
  if (address == "::1") return true;
  // Four decimal numbers, the first of them 127: "127.evil.example" is a name.
  int parts = 0;
  for (std::string_view rest = address;; ++parts) {
    const std::string_view part = rest.substr(0, rest.find('.'));
    int value = -1;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || value < 0 || value > 255) return false;
    if (parts == 0 && value != 127) return false;
    if (part.size() == rest.size()) return parts == 3;
    rest.remove_prefix(part.size() + 1);
  }
}

std::string_view PathOf(std::string_view target) {
  return target.substr(0, target.find('?'));
}

std::string_view QueryValue(std::string_view target, std::string_view name) {
  const std::size_t question = target.find('?');
  if (question == std::string_view::npos) return {};
  std::string_view query = target.substr(question + 1);
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == name) return pair.substr(equals + 1);
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
  }
  return {};
}

std::string_view ChooseProtocol(std::string_view offered) {
  while (!offered.empty()) {
    const std::string_view item = offered.substr(0, offered.find(','));
    const auto* const known = std::find(kProtocols.begin(), kProtocols.end(), Trimmed(item));
    if (known != kProtocols.end()) return *known;
    offered.remove_prefix(std::min(offered.size(), item.size() + 1));
  }
  return {};
}

Access::Access(std::string_view address, std::string token, std::optional<std::string> read_only,
               std::string_view origins)
    : token_(std::move(token)), read_only_(std::move(read_only)), origins_(Lower(origins)) {
  if (token_.empty() && !IsLoopback(address)) {
    throw std::invalid_argument("address " + std::string(address) +
                                " can be reached from other machines and needs a token; without one, only a "
                                "loopback address such as 127.0.0.1 is allowed");
  }
  if (!std::all_of(token_.begin(), token_.end(), NeedsNoEscape)) {
    throw std::invalid_argument("the token has a character other than letters, digits, - _ . and ~");
  }
}

std::optional<Refusal> Access::RefusePage(const RequestHead& head) const {
  if (head.host.empty()) return Refusal{400, "the request has no Host header"};
  const std::string name = HostName(head.host);
  if (token_.empty() && name != "localhost" && !IsLoopback(name)) {
    return Refusal{403,
                   "host \"" + name + "\" is not this machine; without a token, only localhost is served"};
  }
  return std::nullopt;
}

std::optional<Refusal> Access::RefuseClient(const RequestHead& head) const {
  if (const std::optional<Refusal> refusal = RefusePage(head)) return refusal;
  if (!head.origin.empty()) {
    const std::string origin = Lower(head.origin);
    const std::string host = Lower(head.host);
    const bool own = origin == "http://" + host || origin == "https://" + host;
    if (!own && !Contains(origins_, origin)) {
      return Refusal{403, "origin \"" + std::string(head.origin) + "\" is not the gateway's own page at " +
                              std::string(head.host)};
    }
  }
  if (!token_.empty()) {
    constexpr std::string_view kBearer = "Bearer ";
    const std::string_view given = head.authorization.starts_with(kBearer)
                                       ? head.authorization.substr(kBearer.size())
                                       : QueryValue(head.target, "token");
    if (given.empty()) return Refusal{401, "a token is needed: add ?token=... to the address"};
    if (!SameSecret(given, token_)) return Refusal{401, "the token is wrong"};
  }
  return std::nullopt;
}

std::optional<Refusal> Access::RefuseSocket(const RequestHead& head) const {
  if (const std::optional<Refusal> refusal = RefuseClient(head)) return refusal;
  if (ChooseProtocol(head.protocols).empty()) {
    return Refusal{400,
                   "no known subprotocol offered; the gateway speaks foxglove.websocket.v1 and "
                   "foxglove.sdk.v1"};
  }
  return std::nullopt;
}

std::optional<std::string> Access::RefuseSteering(std::string_view peer_address) const {
  if (read_only_) return read_only_;
  if (token_.empty() && !IsLoopback(peer_address))
    return "only clients on this machine may steer without a token";
  return std::nullopt;
}

std::string NameOfClient(std::string_view target) {
  constexpr std::size_t kLongest = 24;
  std::string name(QueryValue(target, "name").substr(0, kLongest));
  std::erase_if(name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_'; });
  return name.empty() ? "client" : name;
}

}  // namespace thalweg::gateway
