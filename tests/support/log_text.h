#pragma once

#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <string>

#ifndef SPDLOG_COMPILED_LIB
#error "A target without spdlog::spdlog has a logger of its own: what services log does not come here."
#endif

namespace thalweg::test {

/// Collects the log in memory until destroyed.
class LogText {
 public:
  LogText() { spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", lines_)); }
  ~LogText() { spdlog::set_default_logger(before_); }
  LogText(const LogText&) = delete;
  LogText& operator=(const LogText&) = delete;

  std::string Text() const {
    std::string text;
    for (const std::string& line : lines_->last_formatted()) text += line;
    return text;
  }
  int Count(const std::string& part) const {
    const std::string text = Text();
    int count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
  }

 private:
  static constexpr std::size_t kMostLines = 1000;
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt> lines_ =
      std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(kMostLines);
};

}  // namespace thalweg::test
