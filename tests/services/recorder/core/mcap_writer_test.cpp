#include "services/recorder/core/mcap_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/services/recorder/core/example_recording.h"

namespace thalweg::recorder {
namespace {

using testing::IsEmpty;

TEST(McapWriter, AnEmptyRecordingIsWhole) {
  const std::vector<std::uint8_t> file = Recorded({}, {});
  const McapReader reader = *McapReader::Open(file);
  EXPECT_TRUE(reader.has_summary());
  EXPECT_THAT(reader.Check().texts(), IsEmpty());
  EXPECT_FALSE(reader.start().has_value());
  EXPECT_THAT(SamplesIn(reader), IsEmpty());
}

}  // namespace
}  // namespace thalweg::recorder
