#include "services/inspector/core/cdr.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "common/base/check.h"

namespace thalweg::inspector {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kHeaderBytes = 4;
constexpr std::size_t kCountBytes = 4;
/// So many values that are not packed take a few hundred megabytes; a map of a large building has one in
/// twenty of them.
constexpr std::size_t kMostValues = 4U << 20;

std::size_t Aligned(std::size_t at, std::size_t size) {
  return (at + size - 1) / size * size;
}

/// Number of bytes that one value takes at least.
std::size_t LeastBytes(Kind kind) {
  if (kind == Kind::kString) return kCountBytes;
  return kind == Kind::kMessage ? 1 : SizeOf(kind);  // each message has a field, and each field a byte
}

class Decoder {
 public:
  Decoder(const Schema& schema, std::span<const std::uint8_t> body, bool swaps)
      : schema_(schema), body_(body), swaps_(swaps) {}

  Result<Value> Decode() {
    Value value;
    if (!Read(schema_.root(), value)) return Error{path_ + ": " + error_};
    const std::size_t rest = body_.size() - at_;
    constexpr std::size_t kPadding = 3;  // a writer may fill the last four bytes
    if (rest > kPadding) {
      return Error{std::to_string(rest) + " bytes follow the end of a " + schema_.message(0).name +
                   ": the writer's type has other fields"};
    }
    return value;
  }

 private:
  bool Fail(const std::string& text) {
    error_ = text;
    return false;
  }
  /// Moves to the next multiple of `size`, and checks that `bytes` are there.
  bool Reach(std::size_t size, std::size_t bytes) {
    at_ = Aligned(at_, size);
    if (at_ <= body_.size() && bytes <= body_.size() - at_) return true;
    return Fail("the message ends after " + std::to_string(body_.size()) + " bytes, before this field does");
  }
  bool Count(std::uint32_t& count) {
    if (!Reach(kCountBytes, kCountBytes)) return false;
    std::memcpy(&count, body_.data() + at_, sizeof count);
    if (swaps_) count = __builtin_bswap32(count);
    at_ += sizeof count;
    return true;
  }

  bool ReadNumbers(Kind kind, std::size_t count, Numbers& out) {
    if (count == 0) return true;
    const std::size_t size = SizeOf(kind);
    if (!Reach(size, count * size)) return false;
    const auto first = body_.begin() + static_cast<std::ptrdiff_t>(at_);
    out.bytes().assign(first, first + static_cast<std::ptrdiff_t>(count * size));
    at_ += count * size;
    if (swaps_ && size > 1) {
      for (std::size_t k = 0; k < count; ++k) {
        const auto begin = out.bytes().begin() + static_cast<std::ptrdiff_t>(k * size);
        std::reverse(begin, begin + static_cast<std::ptrdiff_t>(size));
      }
    }
    if (kind == Kind::kBool && std::ranges::any_of(out.bytes(), [](std::uint8_t b) { return b > 1; })) {
      return Fail("a bool is neither 0 nor 1");
    }
    return true;
  }

  bool ReadText(std::string& out) {
    std::uint32_t length = 0;
    if (!Count(length)) return false;
    if (length > body_.size() - at_) {
      return Fail("its length of " + std::to_string(length) + " bytes is more than the " +
                  std::to_string(body_.size() - at_) + " that are left");
    }
    const auto first = body_.begin() + static_cast<std::ptrdiff_t>(at_);
    out.assign(first, first + static_cast<std::ptrdiff_t>(length));
    if (!out.empty() && out.back() == '\0') out.pop_back();  // the end that CDR counts
    at_ += length;
    return true;
  }

  bool ReadOne(const FieldType& type, Value& out) {
    if (++values_ > kMostValues) return Fail("the message holds too many values to be shown");
    if (type.kind == Kind::kString) return ReadText(out.content.emplace<std::string>());
    if (type.kind != Kind::kMessage) {
      Numbers one(type.kind);
      if (!ReadNumbers(type.kind, 1, one)) return false;
      out.content = one.At(0);
      return true;
    }
    const std::vector<Field>& fields = schema_.message(type).fields;
    auto& values = out.content.emplace<std::vector<Value>>(fields.size());
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const std::size_t outer = path_.size();
      path_ += (path_.empty() ? "" : ".") + fields[k].name;
      if (!Read(fields[k].type, values[k])) return false;
      path_.resize(outer);
    }
    return true;
  }

  bool Read(const FieldType& type, Value& out) {
    if (type.arity == Arity::kOne) return ReadOne(type, out);
    std::uint64_t count = type.length;
    if (type.arity == Arity::kSequence) {
      std::uint32_t stated = 0;
      if (!Count(stated)) return false;
      count = stated;
      const std::size_t left = body_.size() - at_;
      if (count * LeastBytes(type.kind) > left) {
        return Fail("its " + std::to_string(count) + " elements do not fit into the " + std::to_string(left) +
                    " bytes that are left");
      }
    }
    if (IsNumber(type.kind)) {
      return ReadNumbers(type.kind, count, out.content.emplace<Numbers>(type.kind));
    }
    auto& values = out.content.emplace<std::vector<Value>>();
    const std::size_t outer = path_.size();
    for (std::size_t k = 0; k < count; ++k) {
      path_ += '[' + std::to_string(k) + ']';
      if (!ReadOne(type.element(), values.emplace_back())) return false;
      path_.resize(outer);
    }
    return true;
  }

  const Schema& schema_;
  std::span<const std::uint8_t> body_;
  bool swaps_;
  std::size_t at_ = 0;
  std::size_t values_ = 0;
  std::string path_;
  std::string error_;
};

class Encoder {
 public:
  explicit Encoder(const Schema& schema) : schema_(schema), out_({0, 1, 0, 0}) {}  // little endian

  std::vector<std::uint8_t> Encode(const Value& value) {
    Write(schema_.root(), value);
    return std::move(out_);
  }

 private:
  void Align(std::size_t size) { out_.resize(kHeaderBytes + Aligned(out_.size() - kHeaderBytes, size)); }
  void Append(const void* data, std::size_t size) {
    const auto* const bytes = static_cast<const std::uint8_t*>(data);
    out_.insert(out_.end(), bytes, bytes + size);
  }
  void Count(std::size_t count) {
    THALWEG_CHECK(count <= UINT32_MAX);
    Align(kCountBytes);
    const auto stated = static_cast<std::uint32_t>(count);
    Append(&stated, sizeof stated);
  }
  void WriteNumbers(const Numbers& numbers) {
    if (numbers.size() == 0) return;
    Align(SizeOf(numbers.kind()));
    Append(numbers.bytes().data(), numbers.bytes().size());
  }

  void WriteOne(const FieldType& type, const Value& value) {
    if (type.kind == Kind::kString) {
      Count(value.text().size() + 1);
      Append(value.text().c_str(), value.text().size() + 1);
    } else if (type.kind != Kind::kMessage) {
      Numbers one(type.kind);
      one.Append(value.number());
      WriteNumbers(one);
    } else {
      const std::vector<Field>& fields = schema_.message(type).fields;
      THALWEG_CHECK(value.values().size() == fields.size());
      for (std::size_t k = 0; k < fields.size(); ++k) Write(fields[k].type, value.values()[k]);
    }
  }

  void Write(const FieldType& type, const Value& value) {
    if (type.arity == Arity::kOne) return WriteOne(type, value);
    if (type.arity == Arity::kSequence) Count(value.size());
    THALWEG_CHECK(type.arity == Arity::kSequence || value.size() == type.length);
    if (IsNumber(type.kind)) return WriteNumbers(value.numbers());
    for (const Value& element : value.values()) WriteOne(type.element(), element);
  }

  const Schema& schema_;
  std::vector<std::uint8_t> out_;
};

}  // namespace

Result<Value> DecodeCdr(const Schema& schema, std::span<const std::uint8_t> sample) {
  if (sample.size() < kHeaderBytes) return Error{"it has no encapsulation header"};
  // The second byte names the representation; its lowest bit, the byte order. The others are options.
  if (sample[0] != 0 || sample[1] > 1) {
    return Error{"its representation is " + std::to_string(256 * sample[0] + sample[1]) +
                 ", neither 0 nor 1 (plain CDR)"};
  }
  return Decoder(schema, sample.subspan(kHeaderBytes), sample[1] == 0).Decode();
}

std::vector<std::uint8_t> EncodeCdr(const Schema& schema, const Value& value) {
  return Encoder(schema).Encode(value);
}

}  // namespace thalweg::inspector
