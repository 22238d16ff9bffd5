#pragma once

#include <fastdds/rtps/attributes/PropertyPolicy.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

namespace thalweg::dds {

/// The files by which a participant proves who it is and what it may do, as deploy/make-keys writes them:
///
///   DIR/ca.pem                the authority: who signed all the others
///   DIR/governance.p7s        how each topic is protected
///   DIR/ROLE/certificate.pem  the identity of a role
///   DIR/ROLE/key.pem          its private key
///   DIR/ROLE/permissions.p7s  what it may publish and subscribe to
///
/// Source: OMG DDS-SECURITY 1.1 [formal/18-04-01], sections 8.3, 8.4, 9.3 and 9.4.
struct SecurityKeys {
  std::filesystem::path folder;  ///< DIR
  std::string role;
  std::chrono::system_clock::time_point expiry;  ///< When the identity expires.
};

/// The role of a participant: its name. The programs of a person, such as `thalweg`, act as "operator", or as
/// "listener" where the folder holds only those keys.
std::string RoleOf(const std::string& participant, const std::filesystem::path& folder);

/// Checks the keys of a participant's role.
/// Throws std::runtime_error naming the file and what is wrong with it: it is missing; it was not signed by
/// the authority or was changed; key and certificate do not belong together; the certificate has expired, or
/// is not valid yet; it is that of another role; certificate and permissions are too long to be exchanged.
SecurityKeys CheckKeys(const std::filesystem::path& folder, const std::string& participant,
                       std::chrono::system_clock::time_point now);

/// A warning from 30 days before the keys expire.
std::optional<std::string> FindExpiry(const SecurityKeys& keys, std::chrono::system_clock::time_point now);

/// The settings by which Fast DDS uses the keys.
eprosima::fastrtps::rtps::PropertyPolicy PropertiesFrom(const SecurityKeys& keys);

}  // namespace thalweg::dds
