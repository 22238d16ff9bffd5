// libFuzzer target: for any bytes as an MCAP file, the reader returns messages that lie within the file or
// its chunks, names what is wrong, and allocates no more than its limits.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/recorder/core/mcap_reader.h"

namespace {

using namespace thalweg;
using namespace thalweg::recorder;

void Require(bool good) {
  if (!good) __builtin_trap();
}

void ReadAll(Bytes file) {
  const ReadLimits limits{.chunk_bytes = 1 << 20, .open_bytes = 4 << 20};
  const auto reader = McapReader::Open(file, limits);
  if (!reader) return Require(!reader.error().empty());
  Require(reader->whole_until() <= file.size());
  MessageCursor cursor = reader->Read();
  std::uint64_t sum = 0;
  while (const auto message = cursor.Next()) {
    Require(reader->channels().contains(message->channel));
    for (const std::uint8_t byte : message->payload) sum += byte;  // every byte can be read
  }
  volatile std::uint64_t used = sum;
  static_cast<void>(used);
  reader->Check();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // With the magic, so that the fuzzer need not find it.
  std::vector<std::uint8_t> file(kMagic.begin(), kMagic.end());
  file.insert(file.end(), data, data + size);
  ReadAll(file);
  file.insert(file.end(), kMagic.begin(), kMagic.end());
  ReadAll(file);
  return 0;
}
