#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "services/inspector/core/schema.h"
#include "services/inspector/core/value.h"

namespace thalweg::inspector {

/// Decodes a sample: an encapsulation header of 4 bytes, then the message in the representation CDR, version
/// 1, of either byte order [OMG, DDS-XTypes 1.3, section 7.4.1], which is what ROS 2 and this project send.
///
/// Every length is checked against the bytes that are there before anything is allocated for it. Fails with
/// the path of the field that is wrong, "frontiers[3].center.x: ...".
Result<Value> DecodeCdr(const Schema& schema, std::span<const std::uint8_t> sample);

/// The inverse, little endian. The value must be of the schema's type, as ZeroOf, DecodeCdr and ParseYaml
/// return it.
std::vector<std::uint8_t> EncodeCdr(const Schema& schema, const Value& value);

}  // namespace thalweg::inspector
