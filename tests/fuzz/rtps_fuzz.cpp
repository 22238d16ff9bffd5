// libFuzzer target: any bytes are refused as an RTPS message or read within their bounds, and what passes
// where only encrypted submessages may carry samples also passes where all may.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/dds/rtps_message.h"

namespace {

void Require(bool good) {
  if (!good) __builtin_trap();
}

void Check(std::span<const std::uint8_t> datagram) {
  using namespace thalweg::dds;
  const auto problem = FindRtpsError(datagram);
  Require(!problem || !problem->empty());
  const auto with_keys = FindRtpsError(datagram, {.secured = true});
  Require(with_keys || !problem);
  const RtpsContents contents = ContentsOf(datagram);  // also of what was refused
  if (problem) return;
  for (const auto& heartbeat : contents.heartbeats) Require(heartbeat.first >= 1);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Check({data, size});
  // With a header, so that the fuzzer need not find it.
  std::vector<std::uint8_t> datagram = {'R', 'T', 'P', 'S', 2, 3, 1, 15};
  datagram.resize(20, 7);
  datagram.insert(datagram.end(), data, data + size);
  Check(datagram);
  return 0;
}
