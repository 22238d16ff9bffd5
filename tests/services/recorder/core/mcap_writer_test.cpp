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

TEST(McapWriter, AnAttachmentIsReadBackWithAndWithoutTheSummary) {
  const std::vector<std::uint8_t> data = {1, 2, 3, 0, 255};
  const Attachment attachment{.log_time_ns = 12,
                              .create_time_ns = ~std::uint64_t{0},
                              .name = "cal.yaml",
                              .media_type = "text/yaml",
                              .data = data};
  std::vector<std::uint8_t> file;
  McapWriter writer({}, [&](Bytes bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  writer.Write(writer.AddChannel(ExampleChannels()[0]), 0, At(0), At(0), data);
  writer.AddAttachment(attachment);
  writer.Close();
  const McapReader whole = *McapReader::Open(file);
  EXPECT_TRUE(whole.has_summary());
  EXPECT_THAT(whole.Check().texts(), IsEmpty());
  EXPECT_THAT(whole.attachments(), testing::ElementsAre(attachment));
  EXPECT_EQ(SamplesIn(whole).size(), 1U);
  const McapReader scanned = *McapReader::Open(Bytes(file).first(file.size() - 1));
  EXPECT_FALSE(scanned.has_summary());
  EXPECT_THAT(scanned.attachments(), testing::ElementsAre(attachment));
  // Its own CRC is all that protects it: the one over all data is only compared by a check.
  file[static_cast<std::size_t>(whole.attachments()[0].data.data() - file.data())] ^= 1;
  const McapReader damaged = *McapReader::Open(file);
  EXPECT_THAT(damaged.attachments(), IsEmpty());
  EXPECT_THAT(damaged.problems().texts(),
              testing::Contains(testing::HasSubstr("record 9 makes no sense, left out")));
  EXPECT_EQ(SamplesIn(damaged).size(), 1U);
}

}  // namespace
}  // namespace thalweg::recorder
