// libFuzzer target: for any bytes as frames of a link, as a coded cloud, its table or a change of the map,
// the readers return what they hold or say what is wrong, and access no memory beyond their own.
#include <cstddef>
#include <cstdint>

#include "services/link/core/cloud_codec.h"
#include "services/link/core/endpoint.h"
#include "services/link/core/map_codec.h"

namespace {

using namespace thalweg;
using namespace thalweg::link;

void Require(bool good) {
  if (!good) __builtin_trap();
}

/// The bytes as frames that follow each other, of a length that their first byte says.
void FuzzFrames(Bytes bytes) {
  Endpoint endpoint({}, {{.name = "packed"}, {.name = "plain", .packed = false}});
  std::uint64_t sequence = 0;
  Duration now{1};
  ByteReader in(bytes);
  while (!in.rest().empty()) {
    const std::uint8_t length = in.U8();
    const Bytes payload = in.Take(std::min<std::size_t>(length, in.rest().size()));
    now += std::chrono::milliseconds(10);
    const Endpoint::Taken taken =
        endpoint.Take({1, ++sequence, {payload.begin(), payload.end()}}, {now, now});
    for (const Endpoint::Received& received : taken.messages) Require(received.channel < 2);
    endpoint.SetMatched(true, {now, now});
    endpoint.NextFrame({now, now});
  }
}

void FuzzCloud(Bytes bytes) {
  CloudDecoder decoder;
  Require(!decoder.SetTable(RayTable(16, 8, {-0.5, 0.07, -0.25, 0.07}).Encode()));
  const auto cloud = decoder.Decode(bytes);
  if (!cloud) return Require(!cloud.error().empty());
  const std::size_t count =
      static_cast<std::size_t>(cloud->width_px) * static_cast<std::size_t>(cloud->height_px);
  Require(cloud->points_C.size() == count);
  Require(cloud->colors.empty() || cloud->colors.size() == count);
}

void FuzzTable(Bytes bytes) {
  CloudDecoder decoder;
  if (const auto error = decoder.SetTable(bytes)) Require(!error->text.empty());
}

void FuzzMap(Bytes bytes) {
  // Packed here, since the fuzzer would not find what zstd accepts.
  const auto change = DecodeMapChange(Pack(bytes));
  Require(change || !change.error().empty());
  Require(DecodeMapChange(bytes) || !DecodeMapChange(bytes).error().empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes bytes(data + 1, size - 1);
  switch (data[0] % 4) {
    case 0:
      FuzzFrames(bytes);
      break;
    case 1:
      FuzzCloud(bytes);
      break;
    case 2:
      FuzzTable(bytes);
      break;
    default:
      FuzzMap(bytes);
      break;
  }
  return 0;
}
