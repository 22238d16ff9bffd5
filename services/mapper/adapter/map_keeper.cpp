#include "services/mapper/adapter/map_keeper.h"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/base/fresh_id.h"
#include "common/base/stopwatch.h"
#include "common/files/descriptor.h"
#include "common/files/write_file.h"

namespace thalweg::mapper {
namespace {

std::size_t BytesOf(const MapPatch& patch) {
  return sizeof(patch) + patch.voxels.size() * sizeof(VoxelChange) +
         patch.colors.size() * sizeof(ColorChange);
}

}  // namespace

MapKeeper::MapKeeper(Options options, double voxel_size, const MapPosition& at,
                     std::optional<JournalEnds> journal, std::function<void(const Event&)> report)
    : options_(std::move(options)),
      journal_file_(JournalOf(options_.checkpoint_file)),
      voxel_size_(voxel_size),
      report_(std::move(report)),
      position_(at),
      map_(at.map != 0 ? at.map : FreshId()),
      writer_(FreshId()),
      checkpoint_number_(journal ? journal->base_number : at.number),
      stored_(at.number) {
  if (at.map == 0) position_ = {.map = map_, .writer = writer_, .number = 0};
  std::error_code unknown;
  for (const std::filesystem::path& file : {options_.checkpoint_file, journal_file_}) {
    std::filesystem::remove(UnfinishedOf(file), unknown);
  }
  const std::uintmax_t checkpoint_bytes = std::filesystem::file_size(options_.checkpoint_file, unknown);
  if (!unknown) checkpoint_bytes_ = checkpoint_bytes;
  try {
    if (journal) {
      journal_.emplace(journal_file_, *std::move(journal));
      has_journal_ = true;
      NoteJournal();
    }
  } catch (const std::runtime_error& error) {
    Fail(error.what());
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { Work(stop); });
}

MapKeeper::~MapKeeper() = default;

void MapKeeper::Add(MapPatch patch) {
  Waiting waiting{.number = position_.number + 1, .patch = std::move(patch)};
  waiting.bytes = BytesOf(waiting.patch);
  std::unique_lock lock(mutex_);
  if (patient_ && !failing_) {
    patient_ = changed_.wait_for(lock, options_.patience,
                                 [this] { return stored_ == position_.number || failing_; });
  }
  position_.writer = writer_;
  position_.number = waiting.number;
  const bool too_many = waiting_bytes_ + waiting.bytes > options_.most_waiting_bytes;
  if (too_many) {
    waiting_.clear();
    waiting_bytes_ = 0;
  } else {
    waiting_bytes_ += waiting.bytes;
    waiting_.push_back(std::move(waiting));
  }
  lock.unlock();
  changed_.notify_all();
  if (too_many) Forget(position_.number, "the disk is too slow");
}

bool MapKeeper::NeedsCheckpoint() const {
  const std::lock_guard lock(mutex_);
  const bool is_needed = !has_journal_ || checkpoint_fails_ || forgotten_ > stored_ ||
                         journal_bytes_ > std::max(options_.most_journal_bytes, checkpoint_bytes_);
  return is_needed && may_try_checkpoint_;
}

void MapKeeper::WriteCheckpoint(const Checkpoint& copy) {
  const std::lock_guard one_at_a_time(checkpoint_mutex_);
  if (copy.position.number < checkpoint_number_) return;  // the one on disk contains this one's scans
  try {
    const std::string bytes = EncodeCheckpoint(copy.grid, copy.colors, copy.position);
    WriteFile(options_.checkpoint_file, bytes);
    checkpoint_number_ = copy.position.number;
    BeginJournal(copy.position);
    const std::lock_guard lock(mutex_);
    checkpoint_bytes_ = bytes.size();
    checkpoint_fails_ = false;
  } catch (const std::runtime_error& error) {
    {
      const std::lock_guard lock(mutex_);
      checkpoint_fails_ = true;
      may_try_checkpoint_ = false;
    }
    Fail(error.what());
    throw;
  }
  TryAgain();
}

void MapKeeper::BeginJournal(const MapPosition& base) {
  JournalFile next(journal_file_, JournalHead{.voxel_size = voxel_size_, .base = base});
  std::optional<JournalEnds> until;
  {
    const std::lock_guard lock(journal_mutex_);
    if (journal_) until = journal_->ends();
  }
  // Most of what is to be kept is copied and synced while appending goes on; only what came meanwhile holds
  // it up. journal_ is not replaced meanwhile, since checkpoint_mutex_ is held.
  if (until) next.AppendFrom(*journal_, *until);
  next.Sync();
  {
    const std::lock_guard lock(journal_mutex_);
    if (journal_) next.AppendFrom(*journal_, journal_->ends());
    next.Publish();
    journal_.emplace(std::move(next));
    {
      const std::lock_guard state(mutex_);
      has_journal_ = true;
    }
    NoteJournal();
  }
  journal_->Sync();
  if (const int error = SyncFolder(journal_file_.parent_path())) throw CannotWrite(journal_file_, error);
}

void MapKeeper::Maintain() {
  const std::lock_guard one_at_a_time(checkpoint_mutex_);  // so that journal_ is not replaced
  std::error_code unknown;
  try {
    if (journal_ && (!journal_->IsInPlace() || !std::filesystem::exists(options_.checkpoint_file, unknown))) {
      {
        const std::lock_guard lock(mutex_);
        has_journal_ = false;
      }
      Fail(options_.checkpoint_file.string() + " or its journal was removed: the whole map is written again");
    } else if (journal_) {
      journal_->Sync();
    }
  } catch (const std::runtime_error& error) {
    Fail(error.what());
  }
  TryAgain();
}

void MapKeeper::TryAgain() {
  {
    const std::lock_guard lock(mutex_);
    retry_ = true;
    may_try_checkpoint_ = true;
  }
  changed_.notify_all();
  RecoverIfWhole();
}

void MapKeeper::Work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return retry_ || !waiting_.empty(); })) {
    const bool appends = std::exchange(retry_, false) || !append_fails_;
    std::optional<Waiting> next;
    if (!waiting_.empty()) {
      next = std::move(waiting_.front());
      waiting_.pop_front();
      waiting_bytes_ -= next->bytes;
    }
    lock.unlock();
    if (next) Code(*next);
    if (appends) AppendRecords();
    lock.lock();
  }
}

void MapKeeper::Code(const Waiting& waiting) {
  const Stopwatch stopwatch;
  const Result<std::vector<std::uint8_t>> content = Encode(waiting.patch);
  if (!content) return Forget(waiting.number, content.error());
  const MapPosition position{.map = map_, .writer = writer_, .number = waiting.number};
  Record record{.number = waiting.number, .bytes = EncodeRecord(position, *content)};
  record.milliseconds = stopwatch.Milliseconds();
  record_bytes_ += record.bytes.size();
  records_.push_back(std::move(record));
  if (record_bytes_ <= options_.most_waiting_bytes) return;
  records_.clear();
  record_bytes_ = 0;
  Forget(waiting.number, "too many scans wait for the disk");
}

void MapKeeper::AppendRecords() {
  const std::lock_guard lock(journal_mutex_);
  while (!records_.empty() && journal_) {
    Record& record = records_.front();
    const std::uint64_t last = journal_->ends().last_number();
    if (record.number > last + 1) break;  // one before it was forgotten: a checkpoint is needed
    if (record.number == last + 1) {
      const Stopwatch stopwatch;
      options_.before_append();
      try {
        journal_->Append(record.bytes);
      } catch (const std::runtime_error& error) {
        {
          const std::lock_guard state(mutex_);
          append_fails_ = true;
        }
        return Fail(error.what());
      }
      report_({.kind = Event::Kind::kStored,
               .text = {},
               .milliseconds = record.milliseconds + stopwatch.Milliseconds(),
               .bytes = record.bytes.size()});
    }
    record_bytes_ -= record.bytes.size();
    records_.pop_front();
    NoteJournal();
  }
  {
    const std::lock_guard state(mutex_);
    append_fails_ = false;
  }
  RecoverIfWhole();
}

void MapKeeper::Forget(std::uint64_t number, const std::string& why) {
  {
    const std::lock_guard lock(mutex_);
    forgotten_ = std::max(forgotten_, number);
  }
  Fail(journal_file_.string() + ": cannot be written: " + why);
}

void MapKeeper::Fail(const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    failing_ = true;
  }
  changed_.notify_all();
  report_({.kind = Event::Kind::kFailed, .text = text});
}

void MapKeeper::NoteJournal() {
  {
    const std::lock_guard lock(mutex_);
    journal_bytes_ = journal_->size();
    stored_ = std::max(stored_, journal_->ends().last_number());
    patient_ = patient_ || stored_ == position_.number;
  }
  changed_.notify_all();
}

void MapKeeper::RecoverIfWhole() {
  {
    const std::lock_guard lock(mutex_);
    const bool is_whole = has_journal_ && !append_fails_ && !checkpoint_fails_ && forgotten_ <= stored_ &&
                          stored_ == position_.number;
    if (!failing_ || !is_whole) return;
    failing_ = false;
  }
  report_({.kind = Event::Kind::kRecovered});
}

}  // namespace thalweg::mapper
