#pragma once

namespace thalweg::dds {

// RTPS standard, section 9.6.2: the ports of a domain begin at kFirstPort + kPortsOfDomain * domain with that
// of multicast discovery.
inline constexpr int kFirstPort = 7400;
inline constexpr int kPortsOfDomain = 250;
inline constexpr int kParticipantsPerDomain = 120;  // two ports each
inline constexpr int kLastPort = 65535;             // of UDP

/// The unicast port for discovery of a domain's participant with this ID; the next one is for data.
constexpr int FirstPortOf(int domain, int participant_id) {
  constexpr int kFirstUnicast = 10;
  return kFirstPort + kPortsOfDomain * domain + kFirstUnicast + 2 * participant_id;
}

}  // namespace thalweg::dds
