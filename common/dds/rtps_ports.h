#pragma once

namespace thalweg::dds {

// RTPS standard, section 9.6.2: the ports of a domain begin at kFirstPort + kPortsOfDomain * domain with that
// of multicast discovery.
inline constexpr int kFirstPort = 7400;
inline constexpr int kPortsOfDomain = 250;

}  // namespace thalweg::dds
