#include "common/dds/type_hash.h"

#include <openssl/sha.h>
#include <spdlog/fmt/fmt.h>

#include <array>

#include "common/dds/schema.h"

namespace thalweg::dds {

std::string TypeHash(std::string_view wire_type) {
  const std::string_view description = TypeDescription(Ros2TypeName(wire_type));
  if (description.empty()) return "";
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(description.data()), description.size(), digest.data());
  std::string hash = "RIHS01_";
  for (const unsigned char octet : digest) hash += fmt::format("{:02x}", octet);
  return hash;
}

}  // namespace thalweg::dds
