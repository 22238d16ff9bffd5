#include "services/mapper/core/map_journal.h"

#include <bit>
#include <cmath>
#include <string_view>
#include <utility>

#include "common/base/hash.h"

namespace thalweg::mapper {
namespace {

constexpr std::string_view kMagic = "THALWEGJ";
constexpr std::size_t kHashBytes = 8;

/// Hashes a record's bytes without the hash itself.
std::uint64_t HashOfRecord(std::uint64_t map, Bytes before_hash, Bytes content) {
  ByteWriter of_map;
  of_map.U64(map);
  return HashOf(TextOf(content), HashOf(TextOf(before_hash), HashOf(TextOf(of_map.bytes()))));
}

}  // namespace

std::vector<std::uint8_t> EncodeHead(const JournalHead& head) {
  ByteWriter out;
  for (const char c : kMagic) out.U8(static_cast<std::uint8_t>(c));
  out.U64(std::bit_cast<std::uint64_t>(head.voxel_size));
  out.U64(head.base.map);
  out.U64(head.base.writer);
  out.U64(head.base.number);
  out.U64(HashOf(TextOf(out.bytes())));
  return out.Take();
}

std::vector<std::uint8_t> EncodeRecord(const MapPosition& position, Bytes content) {
  ByteWriter out;
  out.U32(static_cast<std::uint32_t>(content.size()));
  out.U64(position.writer);
  out.U64(position.number);
  out.U64(HashOfRecord(position.map, out.bytes(), content));
  out.Append(content);
  return out.Take();
}

Result<JournalReader> JournalReader::Open(Bytes journal) {
  if (!TextOf(journal).starts_with(kMagic)) return Error{"is not a journal of thalweg's mapper"};
  if (journal.size() < kJournalHeadBytes) return Error{"is truncated within its head"};
  ByteReader in(journal.subspan(kMagic.size()));
  JournalHead head;
  head.voxel_size = std::bit_cast<double>(in.U64());
  head.base.map = in.U64();
  head.base.writer = in.U64();
  head.base.number = in.U64();
  if (in.U64() != HashOf(TextOf(journal.first(kJournalHeadBytes - kHashBytes)))) {
    return Error{"is corrupt: the checksum of its head does not match"};
  }
  if (!(head.voxel_size > 0.0 && std::isfinite(head.voxel_size))) return Error{"has no voxel size"};
  return JournalReader(journal, head);
}

JournalReader::JournalReader(Bytes journal, const JournalHead& head)
    : journal_(journal), head_(head), number_(head.base.number) {}

std::optional<JournalRecord> JournalReader::Next() {
  const Bytes rest = journal_.subspan(whole_until_);
  if (rest.empty() || !problem_.empty()) return std::nullopt;
  if (rest.size() < kJournalRecordBytes) return Stop("is cut off");
  ByteReader in(rest);
  const std::uint32_t length = in.U32();
  MapPosition position{.map = head_.base.map};
  position.writer = in.U64();
  position.number = in.U64();
  const std::uint64_t hash = in.U64();
  if (in.rest().size() < length) return Stop("is cut off");
  const Bytes content = in.Take(length);
  if (HashOfRecord(position.map, rest.first(kJournalRecordBytes - kHashBytes), content) != hash) {
    return Stop("is corrupt: its checksum does not match");
  }
  if (position.number != number_ + 1) {
    return Stop("is out of order: it is of scan " + std::to_string(position.number));
  }
  number_ = position.number;
  whole_until_ += kJournalRecordBytes + length;
  return JournalRecord{position, content};
}

std::optional<JournalRecord> JournalReader::Stop(std::string problem) {
  problem_ = "the record after scan " + std::to_string(number_) + ' ' + std::move(problem);
  return std::nullopt;
}

}  // namespace thalweg::mapper
