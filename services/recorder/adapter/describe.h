#pragma once

#include <string>
#include <vector>

#include "services/recorder/core/mcap_reader.h"

namespace thalweg::recorder {

/// What a recording holds, in lines for people: length, size, what is damaged, metadata, and its topics with
/// type, number of messages and rate.
std::vector<std::string> Describe(const McapReader& reader);

}  // namespace thalweg::recorder
