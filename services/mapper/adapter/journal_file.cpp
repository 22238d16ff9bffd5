#include "services/mapper/adapter/journal_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>
#include <vector>

#include "common/files/write_file.h"

namespace thalweg::mapper {

JournalFile::JournalFile(std::filesystem::path file, const JournalHead& head)
    : file_(std::move(file)),
      published_(false),
      descriptor_(UnfinishedOf(file_), O_RDWR | O_CREAT | O_TRUNC | O_APPEND),
      ends_{.base_number = head.base.number, .offsets = {kJournalHeadBytes}} {
  const std::vector<std::uint8_t> bytes = EncodeHead(head);
  if (const int error = WriteAll(descriptor_, TextOf(bytes))) {
    if (descriptor_.get() >= 0) unlink(UnfinishedOf(file_).c_str());
    throw CannotWrite(file_, error);
  }
}

JournalFile::JournalFile(std::filesystem::path file, JournalEnds ends)
    : file_(std::move(file)),
      published_(true),
      descriptor_(file_, O_RDWR | O_APPEND),
      ends_(std::move(ends)) {
  if (descriptor_.get() < 0) throw CannotWrite(file_, descriptor_.error());
  if (ftruncate(descriptor_.get(), static_cast<off_t>(size())) != 0) throw CannotWrite(file_, errno);
}

JournalFile::~JournalFile() {
  if (!published_) unlink(UnfinishedOf(file_).c_str());
}

JournalFile::JournalFile(JournalFile&& other) noexcept
    : file_(other.file_),
      published_(std::exchange(other.published_, true)),
      descriptor_(std::move(other.descriptor_)),
      ends_(std::move(other.ends_)),
      torn_(other.torn_) {}

JournalFile& JournalFile::operator=(JournalFile&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(published_, other.published_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(ends_, other.ends_);
  std::swap(torn_, other.torn_);
  return *this;
}

void JournalFile::Append(Bytes record) {
  const auto cut = [this] { return ftruncate(descriptor_.get(), static_cast<off_t>(size())) == 0; };
  if (torn_ && !cut()) throw CannotWrite(file_, errno);
  torn_ = false;
  if (const int error = WriteAll(descriptor_, TextOf(record))) {
    torn_ = !cut();
    throw CannotWrite(file_, error);
  }
  ends_.offsets.push_back(size() + record.size());
}

void JournalFile::AppendFrom(const JournalFile& other, const JournalEnds& until) {
  for (std::uint64_t number = ends_.last_number() + 1;
       number > until.base_number && number <= until.last_number(); ++number) {
    const std::uint64_t k = number - until.base_number;
    std::vector<std::uint8_t> record(until.offsets[k] - until.offsets[k - 1]);
    std::size_t filled = 0;
    while (filled < record.size()) {
      const ssize_t count = pread(other.descriptor_.get(), record.data() + filled, record.size() - filled,
                                  static_cast<off_t>(until.offsets[k - 1] + filled));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) throw CannotWrite(file_, count < 0 ? errno : EIO);
      filled += static_cast<std::size_t>(count);
    }
    Append(record);
  }
}

void JournalFile::Sync() const {
  if (fdatasync(descriptor_.get()) != 0) throw CannotWrite(file_, errno);
}

void JournalFile::Publish() {
  if (std::rename(UnfinishedOf(file_).c_str(), file_.c_str()) != 0) throw CannotWrite(file_, errno);
  published_ = true;
}

bool JournalFile::IsInPlace() const {
  struct stat mine {};
  struct stat named {};
  return fstat(descriptor_.get(), &mine) == 0 && stat(file_.c_str(), &named) == 0 &&
         mine.st_ino == named.st_ino && mine.st_dev == named.st_dev;
}

}  // namespace thalweg::mapper
