#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "common/dds/bus.h"

namespace thalweg::dds {

// What BusOptions and Delivery mean in Fast DDS. Every policy that matters is set, on writers and readers:
// the defaults of the two do not agree with each other.

/// Throws std::runtime_error on a malformed discovery server or interface.
eprosima::fastdds::dds::DomainParticipantQos ParticipantQosFrom(const BusOptions& options);
eprosima::fastdds::dds::DataWriterQos WriterQosFrom(Delivery delivery);
eprosima::fastdds::dds::DataReaderQos ReaderQosFrom(Delivery delivery);

}  // namespace thalweg::dds
