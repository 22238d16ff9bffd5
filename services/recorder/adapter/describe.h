#pragma once

#include <string>
#include <vector>

#include "services/recorder/core/mcap_reader.h"

namespace thalweg::recorder {

/// A span of a recording, as every text gives it: "12.345 s". Cut to milliseconds, so that a limit that is
/// printed is one that is accepted.
std::string SecondsText(Duration span);

/// What a recording holds, in lines for people: length, size, what is damaged, metadata, and its topics with
/// type, number of messages and rate.
std::vector<std::string> Describe(const McapReader& reader);

}  // namespace thalweg::recorder
