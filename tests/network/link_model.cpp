#include "tests/network/link_model.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace thalweg::network {
namespace {

void Require(bool condition, const std::string& what) {
  if (!condition) throw std::invalid_argument("link: " + what);
}

void RequireProbability(double value, const std::string& name) {
  Require(value >= 0.0 && value <= 1.0, name + " is a probability, 0 to 1, is " + std::to_string(value));
}

LinkTime FromSeconds(double seconds) {
  return std::chrono::duration_cast<LinkTime>(std::chrono::duration<double>(seconds));
}

double Seconds(LinkTime time) {
  return std::chrono::duration<double>(time).count();
}

constexpr double kBitsPerByte = 8.0;

}  // namespace

LinkModel::LinkModel(const LinkOptions& options, std::uint64_t seed) : options_(options), random_(seed) {
  constexpr LinkTime kZero{0};
  RequireProbability(options.loss, "loss");
  RequireProbability(options.duplicate, "duplicate");
  RequireProbability(options.reorder, "reorder");
  Require(options.jitter >= kZero && options.jitter <= options.delay, "jitter must be 0 to delay");
  Require(options.held_back >= kZero, "held_back must not be negative");
  Require(options.reorder == 0.0 || options.held_back > kZero, "reorder needs held_back");
  Require(options.rate >= 0.0, "rate must not be negative");
  Require(options.rate == 0.0 || options.queue_bytes > 0, "rate needs queue_bytes");
  for (const Cut& cut : options.cuts) {
    Require(cut.from >= kZero && cut.length > kZero, "a cut must begin at 0 or later and last");
    Require(cut.every == kZero || cut.every > cut.length, "a cut must be shorter than its period");
  }
}

LinkModel::Passage LinkModel::Send(LinkTime now, std::size_t bytes) {
  if (IsCut(now)) return {.fate = Fate::kCut};

  const bool lost = Uniform() < options_.loss;
  const double place_in_jitter = 2.0 * Uniform() - 1.0;
  // One number serves both: a packet that is held back is not the one that arrives twice, unless the two
  // probabilities exceed 1 together.
  const double special = Uniform();
  const bool held_back = special < options_.reorder;
  const bool twice = special >= 1.0 - options_.duplicate;

  LinkTime sent = now;
  if (options_.rate > 0.0) {
    const LinkTime begins = std::max(now, line_free_);
    const double waiting = Seconds(begins - now) * options_.rate / kBitsPerByte;
    if (waiting + static_cast<double>(bytes) > static_cast<double>(options_.queue_bytes)) {
      return {.fate = Fate::kQueueFull};
    }
    line_free_ = begins + FromSeconds(static_cast<double>(bytes) * kBitsPerByte / options_.rate);
    sent = line_free_;
  }
  if (lost) return {.fate = Fate::kLost};

  const LinkTime delay = options_.delay + FromSeconds(place_in_jitter * Seconds(options_.jitter));
  Passage passage{
      .fate = Fate::kArrives, .arrival = std::max(sent + delay, last_arrival_), .copies = twice ? 2 : 1};
  if (held_back) {
    passage.arrival += options_.held_back;
  } else {
    last_arrival_ = passage.arrival;
  }
  return passage;
}

bool LinkModel::IsCut(LinkTime now) const {
  return std::ranges::any_of(options_.cuts, [now](const Cut& cut) {
    if (now < cut.from) return false;
    const LinkTime since = now - cut.from;
    return (cut.every > LinkTime{0} ? since % cut.every : since) < cut.length;
  });
}

double LinkModel::Uniform() {
  return std::generate_canonical<double, 53>(random_);
}

}  // namespace thalweg::network
