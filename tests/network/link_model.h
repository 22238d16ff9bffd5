#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace thalweg::network {

/// Time since the link began to work. No function here reads a clock.
using LinkTime = std::chrono::nanoseconds;

/// An interval in which everything is lost.
struct Cut {
  LinkTime from{0};
  LinkTime length{0};
  LinkTime every{0};  ///< Period of a link that flaps; 0 = the cut happens once.
};

/// What one direction of a link does to its packets.
struct LinkOptions {
  LinkTime delay{0};
  LinkTime jitter{0};           ///< Delays are uniform in delay +- jitter; at most `delay`.
  double loss = 0.0;            ///< Probability, independent for each packet.
  double duplicate = 0.0;       ///< Probability that a packet arrives twice.
  double reorder = 0.0;         ///< Probability that a packet is held back, so that later ones overtake it.
  LinkTime held_back{0};        ///< By how much.
  double rate = 0.0;            ///< [bit/s] 0 = unlimited.
  std::size_t queue_bytes = 0;  ///< Bytes that wait for their turn at most; only with a rate.
  std::vector<Cut> cuts{};
};

/// Decides the fate of each packet on one direction of a link.
///
/// A packet passes, in this order: a cut; a queue of bounded length before a line of limited rate, which
/// drops what does not fit; loss on the line; a random delay. A packet does not overtake an earlier one, as
/// on a single path, unless the earlier one is among those held back: close packets therefore share the
/// longest of their delays. Three random numbers are drawn for every packet, so that the fate of the n-th
/// packet that is not cut off depends on the seed alone, apart from the queue. Threading: one thread.
class LinkModel {
 public:
  /// Throws std::invalid_argument naming the option that is wrong.
  LinkModel(const LinkOptions& options, std::uint64_t seed);

  enum class Fate { kArrives, kCut, kQueueFull, kLost };
  struct Passage {
    Fate fate;
    LinkTime arrival{0};  ///< If it arrives.
    int copies = 0;       ///< 0, 1 or 2.
  };
  /// @param now    When the packet is sent; never earlier than at the previous call.
  /// @param bytes  Its length on the line.
  Passage Send(LinkTime now, std::size_t bytes);

 private:
  bool IsCut(LinkTime now) const;
  double Uniform();  ///< In [0, 1).

  LinkOptions options_;
  std::mt19937_64 random_;
  LinkTime line_free_{0};     ///< When the line has sent all that was accepted.
  LinkTime last_arrival_{0};  ///< When the last packet arrived that was not held back.
};

}  // namespace thalweg::network
