// libFuzzer target: for any bytes as a sample of any topic's type, the decoder either names what is wrong or
// returns a message that can be printed in every form, is printed without a control character, and is parsed
// and encoded back to what it was.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/text.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/inspector/core/cdr.h"
#include "services/inspector/core/one_line.h"
#include "services/inspector/core/yaml.h"

namespace {

using namespace thalweg;
using namespace thalweg::inspector;

void Require(bool good) {
  if (!good) __builtin_trap();
}

const std::vector<Schema>& Schemas() {
  static const std::vector<Schema> schemas = [] {
    std::vector<Schema> all;
    for (const dds::TopicInfo& topic : dds::AllTopics()) {
      const std::string type = dds::Ros2TypeName(topic.type_name);
      all.push_back(*Schema::Parse(type, dds::Ros2MsgSchema(type)));
    }
    return all;
  }();
  return schemas;
}

/// No character but the ends of lines controls a terminal.
void RequireClean(std::string_view text) {
  while (!text.empty()) {
    const Character first = FirstCharacter(text);
    Require(first.bytes > 0 && (first.code == '\n' || !IsControlCharacter(first.code)));
    text.remove_prefix(first.bytes);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const Schema& schema = Schemas()[data[0] % Schemas().size()];
  std::vector<std::uint8_t> sample = {0, 1, 0, 0};  // the header, so that the fuzzer need not find it
  sample.insert(sample.end(), data + 1, data + size);
  const auto message = DecodeCdr(schema, sample);
  if (!message) {
    Require(!message.error().empty());
    return 0;
  }
  const FieldType root = schema.root();
  RequireClean(ToLine(schema, root, *message));
  for (const Arrays arrays : {Arrays::kWhole, Arrays::kLeftOut})
    RequireClean(ToCsv(schema, root, *message, arrays));
  const std::string yaml = ToYaml(schema, root, *message, PrintOptions::Everything());
  RequireClean(yaml);
  const auto parsed = ParseYaml(schema, yaml, {});
  Require(static_cast<bool>(parsed));
  // By text, since a NaN has more bytes than one, and is not equal to itself.
  Require(ToYaml(schema, root, *parsed, PrintOptions::Everything()) == yaml);
  Require(EncodeCdr(schema, *parsed).size() == EncodeCdr(schema, *message).size());
  return 0;
}
