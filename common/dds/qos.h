#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "common/dds/bus.h"

namespace thalweg::dds {

// Translates BusOptions and Delivery into Fast DDS policies. Every policy that matters is set explicitly, on
// writers and readers, since their defaults do not match each other.

/// Throws std::runtime_error if the discovery server or the network interface is malformed.
eprosima::fastdds::dds::DomainParticipantQos ParticipantQosFrom(const BusOptions& options);
eprosima::fastdds::dds::DataWriterQos WriterQosFrom(Delivery delivery);
eprosima::fastdds::dds::DataReaderQos ReaderQosFrom(Delivery delivery);

}  // namespace thalweg::dds
