#pragma once

#include <string>
#include <utility>
#include <variant>

namespace thalweg {

/// Why an operation that is expected to fail now and then has failed. Names the item and its value.
struct Error {
  std::string text;
};

/// A value, or the reason why there is none. For failures that are part of normal operation; start-up
/// failures throw, and bugs abort (check.h).
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  explicit operator bool() const { return std::holds_alternative<T>(content_); }
  const T& operator*() const& { return std::get<T>(content_); }
  T& operator*() & { return std::get<T>(content_); }
  T&& operator*() && { return std::get<T>(std::move(content_)); }
  const T* operator->() const { return &std::get<T>(content_); }
  T* operator->() { return &std::get<T>(content_); }
  const std::string& error() const { return std::get<Error>(content_).text; }

 private:
  std::variant<T, Error> content_;
};

}  // namespace thalweg
