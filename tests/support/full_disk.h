#pragma once

#include <sys/resource.h>

#include <csignal>

namespace thalweg::test {

/// Limits the size of the files that this process, and whatever it starts meanwhile, may write, until
/// destroyed; a stand-in for a full disk that needs no rights. A process that does not ignore SIGXFSZ is
/// killed by its first write beyond the limit.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit lower{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &lower);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

/// The same for tests that write in this process: here a write beyond the limit only fails, as it does on a
/// full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : limit_(bytes) {}

 private:
  class IgnoredSignal {
   public:
    IgnoredSignal() : before_(std::signal(SIGXFSZ, SIG_IGN)) {}
    ~IgnoredSignal() { std::signal(SIGXFSZ, before_); }
    IgnoredSignal(const IgnoredSignal&) = delete;
    IgnoredSignal& operator=(const IgnoredSignal&) = delete;

   private:
    void (*before_)(int);
  };

  IgnoredSignal signal_;  // before the limit, so that it is ignored as long as the limit holds
  FileSizeLimit limit_;
};

}  // namespace thalweg::test
