#include "common/dds/security.h"

#include <openssl/asn1.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <string_view>

namespace thalweg::dds {
namespace {

namespace fs = std::filesystem;
using SystemTime = std::chrono::system_clock::time_point;

template <auto Free>
struct Deleter {
  template <class Object>
  void operator()(Object* object) const {
    Free(object);
  }
};
using Bio = std::unique_ptr<BIO, Deleter<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Deleter<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Deleter<EVP_PKEY_free>>;
using Signature = std::unique_ptr<PKCS7, Deleter<PKCS7_free>>;
using Store = std::unique_ptr<X509_STORE, Deleter<X509_STORE_free>>;

// The programs by which a person watches and steers, rather than services with work of their own.
constexpr std::array<std::string_view, 4> kPersonal = {"thalweg", "gateway", "gateway channels", "recorder"};

// Certificate and permissions cross in one RTPS message of 8192 bytes (qos.cpp), with some 1.5 kB of other
// properties. Fast DDS 2.9 logs an introduction that is longer, and then aborts when the peer repeats its
// own.
constexpr std::uintmax_t kMostIntroductionBytes = 5000;

fs::path AuthorityIn(const fs::path& folder) {
  return folder / "ca.pem";
}
fs::path GovernanceIn(const fs::path& folder) {
  return folder / "governance.p7s";
}
fs::path CertificateOf(const fs::path& folder, const std::string& role) {
  return folder / role / "certificate.pem";
}
fs::path KeyOf(const fs::path& folder, const std::string& role) {
  return folder / role / "key.pem";
}
fs::path PermissionsOf(const fs::path& folder, const std::string& role) {
  return folder / role / "permissions.p7s";
}

std::runtime_error Bad(const fs::path& path, const std::string& what) {
  return std::runtime_error("security: " + path.string() + ": " + what);
}

Bio Open(const fs::path& path) {
  Bio file(BIO_new_file(path.c_str(), "r"));
  if (file) return file;
  throw Bad(path, fs::exists(path) ? "cannot be read: do its owner and mode allow it?"
                                   : "is missing; deploy/make-keys makes it");
}

Certificate ReadCertificate(const fs::path& path) {
  Certificate certificate(PEM_read_bio_X509(Open(path).get(), nullptr, nullptr, nullptr));
  if (!certificate) throw Bad(path, "is no certificate in PEM format");
  return certificate;
}

Key ReadKey(const fs::path& path) {
  Key key(PEM_read_bio_PrivateKey(Open(path).get(), nullptr, nullptr, nullptr));
  if (!key) throw Bad(path, "is no private key in PEM format");
  return key;
}

/// Checks that `path` is a document that the authority signed.
void CheckDocument(const fs::path& path, X509* authority) {
  const Bio file = Open(path);
  BIO* content = nullptr;
  const Signature signature(SMIME_read_PKCS7(file.get(), &content));
  const Bio signed_text(content);
  if (!signature || !signed_text) throw Bad(path, "is no signed document in S/MIME format");
  const Store store(X509_STORE_new());
  std::unique_ptr<STACK_OF(X509), void (*)(STACK_OF(X509)*)> signers(
      sk_X509_new_null(), [](STACK_OF(X509) * stack) { sk_X509_free(stack); });
  sk_X509_push(signers.get(), authority);
  const Bio text(BIO_new(BIO_s_mem()));
  if (PKCS7_verify(signature.get(), signers.get(), store.get(), signed_text.get(), text.get(),
                   PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN) != 1) {
    throw Bad(path, "was not signed by the authority, or was changed since");
  }
}

SystemTime TimeFrom(const ASN1_TIME* time) {
  std::tm fields{};
  ASN1_TIME_to_tm(time, &fields);
  return std::chrono::system_clock::from_time_t(timegm(&fields));
}

std::string DateOf(SystemTime time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
  std::tm fields{};
  gmtime_r(&seconds, &fields);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", &fields);
  return text.data();
}

void CheckDates(const fs::path& path, const X509* certificate, SystemTime now) {
  const SystemTime first = TimeFrom(X509_get0_notBefore(certificate));
  const SystemTime last = TimeFrom(X509_get0_notAfter(certificate));
  const std::string clock = "; this machine's clock says " + DateOf(now);
  if (now < first) throw Bad(path, "is not valid before " + DateOf(first) + clock);
  if (now > last) throw Bad(path, "expired on " + DateOf(last) + clock);
}

std::string CommonNameOf(const X509* certificate) {
  std::array<char, 65> name{};
  const int length = X509_NAME_get_text_by_NID(X509_get_subject_name(certificate), NID_commonName,
                                               name.data(), static_cast<int>(name.size()));
  return length > 0 ? name.data() : "";
}

}  // namespace

std::string RoleOf(const std::string& participant, const fs::path& folder) {
  if (std::ranges::find(kPersonal, participant) == kPersonal.end()) return participant;
  return fs::is_directory(folder / "operator") ? "operator" : "listener";
}

SecurityKeys CheckKeys(const fs::path& folder, const std::string& participant, SystemTime now) {
  if (!fs::is_directory(folder)) throw Bad(folder, "there is no such folder; deploy/make-keys makes it");
  const std::string role = RoleOf(participant, folder);
  if (!fs::is_directory(folder / role)) {
    throw Bad(folder / role, "is missing: there are no keys for \"" + participant +
                                 "\"; deploy/make-keys --role " + role + " makes them");
  }
  const Certificate authority = ReadCertificate(AuthorityIn(folder));
  CheckDates(AuthorityIn(folder), authority.get(), now);

  const fs::path path = CertificateOf(folder, role);
  const Certificate certificate = ReadCertificate(path);
  if (X509_verify(certificate.get(), X509_get0_pubkey(authority.get())) != 1) {
    throw Bad(path, "was not signed by the authority " + AuthorityIn(folder).string());
  }
  if (CommonNameOf(certificate.get()) != role) {
    throw Bad(path, "belongs to role \"" + CommonNameOf(certificate.get()) + "\"");
  }
  CheckDates(path, certificate.get(), now);
  if (X509_check_private_key(certificate.get(), ReadKey(KeyOf(folder, role)).get()) != 1) {
    throw Bad(KeyOf(folder, role), "is not the key of " + path.string());
  }
  CheckDocument(GovernanceIn(folder), authority.get());
  const fs::path permissions = PermissionsOf(folder, role);
  CheckDocument(permissions, authority.get());
  const std::uintmax_t bytes = fs::file_size(path) + fs::file_size(permissions);
  if (bytes > kMostIntroductionBytes) {
    throw Bad(permissions, "is too long: with the certificate it has " + std::to_string(bytes) +
                               " bytes, participants introduce themselves with at most " +
                               std::to_string(kMostIntroductionBytes) + "; name fewer topics");
  }
  return {folder, role, TimeFrom(X509_get0_notAfter(certificate.get()))};
}

std::optional<std::string> FindExpiry(const SecurityKeys& keys, SystemTime now) {
  if (keys.expiry - now > std::chrono::days(30)) return std::nullopt;
  return "security: the keys of \"" + keys.role + "\" in " + keys.folder.string() +
         (now > keys.expiry ? " expired on " : " expire on ") + DateOf(keys.expiry) +
         "; deploy/make-keys --force renews them";
}

eprosima::fastrtps::rtps::PropertyPolicy PropertiesFrom(const SecurityKeys& keys) {
  eprosima::fastrtps::rtps::PropertyPolicy policy;
  const auto set = [&](const std::string& name, const std::string& value) {
    policy.properties().emplace_back("dds.sec." + name, value);
  };
  const auto set_file = [&](const std::string& name, const fs::path& path) {
    set(name, "file://" + fs::absolute(path).string());
  };
  set("auth.plugin", "builtin.PKI-DH");
  set_file("auth.builtin.PKI-DH.identity_ca", AuthorityIn(keys.folder));
  set_file("auth.builtin.PKI-DH.identity_certificate", CertificateOf(keys.folder, keys.role));
  set_file("auth.builtin.PKI-DH.private_key", KeyOf(keys.folder, keys.role));
  set("access.plugin", "builtin.Access-Permissions");
  set_file("access.builtin.Access-Permissions.permissions_ca", AuthorityIn(keys.folder));
  set_file("access.builtin.Access-Permissions.governance", GovernanceIn(keys.folder));
  set_file("access.builtin.Access-Permissions.permissions", PermissionsOf(keys.folder, keys.role));
  set("crypto.plugin", "builtin.AES-GCM-GMAC");
  return policy;
}

}  // namespace thalweg::dds
