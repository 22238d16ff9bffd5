#pragma once

#include <cstddef>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <memory>
#include <optional>

#include "common/base/time.h"
#include "common/dds/bus.h"
#include "common/dds/guarded_transport.h"
#include "common/dds/security.h"
#include "common/dds/type_hash.h"

namespace thalweg::dds {

// Translates BusOptions and Delivery into Fast DDS policies. Every policy that matters is set explicitly, on
// writers and readers, since their defaults do not match each other.

/// The property by which a participant says the version of thalweg that it is of.
inline constexpr auto kVersionProperty = "thalweg.version";

/// [byte] What the sockets request; Linux grants at most net.core.rmem_max and wmem_max, without a word. At
/// one megabyte 30 times a second, UDP loses 40 % of the samples with the system's default buffers and none
/// with these.
inline constexpr std::uint32_t kSocketBufferBytes = 4 << 20;

/// [byte] The largest RTPS message that a participant sends by UDP. What stays on this machine need not fit
/// into one packet of a network.
std::uint32_t LargestMessageBytes(bool local_only, bool has_keys);

/// Throws std::runtime_error if the discovery server or the network interface is malformed, or the latter is
/// not an address of this machine.
/// @param guard  Guard of the transport by which the participant receives.
/// @param keys  Keys of the participant, if it is to be secure. It then uses UDP alone, since what arrives
///              through shared memory passes no guard.
eprosima::fastdds::dds::DomainParticipantQos ParticipantQosFrom(const BusOptions& options,
                                                                std::shared_ptr<Guard> guard,
                                                                const std::optional<SecurityKeys>& keys);
/// The first of the two ports in shared memory at which such a participant listens, if it does.
std::optional<std::uint32_t> SharedPortsOf(const eprosima::fastdds::dds::DomainParticipantQos& qos);
eprosima::fastdds::dds::DataWriterQos WriterQosFrom(Delivery delivery);
/// @param best_effort  Whether the reader matches writers that offer no reliable delivery, too.
eprosima::fastdds::dds::DataReaderQos ReaderQosFrom(Delivery delivery, bool best_effort = false,
                                                    Keep keep = Keep::kAsDelivered);

/// Lets a writer or reader announce the hash of its type, as ROS 2's do: tools warn of those that do not.
template <class Qos>
void AnnounceTypeHash(Qos& qos, const std::string& wire_type) {
  const std::string hash = TypeHash(wire_type);
  if (hash.empty()) return;
  const std::string text = "typehash=" + hash + ';';
  qos.user_data().data_vec({text.begin(), text.end()});
}

/// The most samples that a writer keeps for readers that come later.
std::size_t KeptForLateJoiners(Delivery delivery);

/// How long a sample may wait in a reader before it is too old to be used.
Duration LongestWaitOf(Delivery delivery);

}  // namespace thalweg::dds
