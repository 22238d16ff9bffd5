#include "services/evaluator/core/cover_tour.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/base/check.h"

namespace thalweg::evaluator {
namespace {

constexpr std::size_t kCandidates = 48;   // places compared for an insertion
constexpr std::size_t kMostSeers = 256;   // places remembered per item
constexpr double kGreatestRuin = 0.4;     // share of the stops
constexpr double kFirstThreshold = 0.03;  // share of the length
constexpr double kShorter = 1e-3;         // [m] less may be rounding of sums of floats

std::size_t CountOf(const std::vector<std::uint64_t>& bits) {
  std::size_t count = 0;
  for (const std::uint64_t word : bits) count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

}  // namespace

CoverTourSearch::CoverTourSearch(ShortestPaths& paths, const BitTable& seen, std::size_t start)
    : paths_(paths), seen_(seen), start_(start), seers_(seen.columns()), scratch_(seen.words(), 0) {
  THALWEG_CHECK(seen.rows() == paths.graph().size() && start < seen.rows());
  std::vector<std::size_t> count(seen.columns(), 0);
  SplitMix random{1};
  Bits all(seen.words(), 0);
  for (std::size_t place = 0; place < seen.rows(); ++place) {
    if (!std::isfinite(paths_.Length(start_, place))) continue;
    AddPlace(place, all);
    const std::uint64_t* row = seen.Of(place);
    for (std::size_t w = 0; w < seen.words(); ++w) {
      for (std::uint64_t word = row[w]; word != 0; word &= word - 1) {
        const std::size_t item = 64 * w + static_cast<std::size_t>(std::countr_zero(word));
        // Reservoir sampling, so that each place that sees the item is as likely to be kept.
        const std::size_t k = count[item]++;
        if (k < kMostSeers) {
          seers_[item].push_back(static_cast<std::uint32_t>(place));
        } else if (const std::size_t slot = random.Below(k + 1); slot < kMostSeers) {
          seers_[item][slot] = static_cast<std::uint32_t>(place);
        }
      }
    }
  }
  most_ = CountOf(all);
}

double CoverTourSearch::LengthOf(const Stops& stops) {
  double length = 0.0;
  for (std::size_t n = 1; n < stops.size(); ++n) length += paths_.Length(stops[n - 1], stops[n]);
  return length;
}

void CoverTourSearch::AddPlace(std::size_t place, Bits& bits) const {
  Unite(bits, seen_.Of(place));
}

void CoverTourSearch::AddLeg(std::size_t from, std::size_t to, Bits& bits) {
  paths_.ForEachBetween(from, to, [&](std::size_t place) { AddPlace(place, bits); });
  AddPlace(to, bits);
}

std::size_t CoverTourSearch::SeenBy(const Stops& stops, Bits& bits) {
  bits.assign(seen_.words(), 0);
  AddPlace(stops.front(), bits);
  for (std::size_t n = 1; n < stops.size(); ++n) AddLeg(stops[n - 1], stops[n], bits);
  return CountOf(bits);
}

void CoverTourSearch::CumulateInto(const Stops& stops, std::vector<Bits>& befores,
                                   std::vector<Bits>& afters) {
  befores.resize(stops.size());
  afters.resize(stops.size());
  befores[0].assign(seen_.words(), 0);
  AddPlace(stops.front(), befores[0]);
  for (std::size_t n = 1; n < stops.size(); ++n) {
    befores[n] = befores[n - 1];
    AddLeg(stops[n - 1], stops[n], befores[n]);
  }
  afters.back().assign(seen_.words(), 0);
  for (std::size_t n = stops.size() - 1; n > 0; --n) {
    afters[n - 1] = afters[n];
    AddLeg(stops[n - 1], stops[n], afters[n - 1]);
  }
}

void CoverTourSearch::Ruin(Stops& stops, SplitMix& random) {
  const std::size_t removable = stops.size() - 1;
  if (removable == 0) return;
  const auto most =
      std::max<std::size_t>(1, static_cast<std::size_t>(kGreatestRuin * static_cast<double>(removable)));
  const std::size_t count =
      1 + random.Below(std::max<std::size_t>(most, std::min<std::size_t>(3, removable)));
  switch (random.Below(3)) {
    case 0: {  // stops that follow each other
      const std::size_t first = 1 + random.Below(removable);
      const std::size_t last = std::min(stops.size(), first + count);
      stops.erase(stops.begin() + static_cast<std::ptrdiff_t>(first),
                  stops.begin() + static_cast<std::ptrdiff_t>(last));
      break;
    }
    case 1:  // any stops
      for (std::size_t k = 0; k < count && stops.size() > 1; ++k) {
        stops.erase(stops.begin() + static_cast<std::ptrdiff_t>(1 + random.Below(stops.size() - 1)));
      }
      break;
    default: {  // stops that are near each other
      const std::size_t center = stops[1 + random.Below(removable)];
      std::vector<std::pair<double, std::size_t>> near;
      for (std::size_t n = 1; n < stops.size(); ++n) near.emplace_back(paths_.Length(center, stops[n]), n);
      std::sort(near.begin(), near.end());
      near.resize(std::min(count, near.size()));
      std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
      for (const auto& [length, n] : near) stops.erase(stops.begin() + static_cast<std::ptrdiff_t>(n));
      break;
    }
  }
}

std::size_t CoverTourSearch::RandomSeerOf(std::size_t item, SplitMix& random) const {
  return seers_[item][random.Below(seers_[item].size())];
}

void CoverTourSearch::Recreate(Stops& stops, std::size_t wanted, SplitMix& random) {
  // How much more the items count than the length differs from one recreation to the next.
  const double power = 0.5 + 1.5 * random.Share();
  Bits bits;
  std::size_t seen = SeenBy(stops, bits);
  std::vector<std::size_t> unseen;
  while (seen < wanted) {
    unseen.clear();
    for (std::size_t item = 0; item < seen_.columns(); ++item) {
      if (((bits[item / 64] >> (item % 64)) & 1U) == 0 && !seers_[item].empty()) unseen.push_back(item);
    }
    THALWEG_CHECK(!unseen.empty());
    std::size_t best = 0;
    std::size_t best_before = 0;  // stop after which to insert
    double best_score = -1.0;
    for (std::size_t k = 0; k < kCandidates; ++k) {
      const std::size_t candidate = RandomSeerOf(unseen[random.Below(unseen.size())], random);
      double added = std::numeric_limits<double>::infinity();
      std::size_t before = 0;
      for (std::size_t n = 0; n < stops.size(); ++n) {
        double cost = paths_.Length(stops[n], candidate);
        if (n + 1 < stops.size()) {
          cost += paths_.Length(stops[n + 1], candidate) - paths_.Length(stops[n], stops[n + 1]);
        }
        if (cost < added) {
          added = cost;
          before = n;
        }
      }
      const auto gain = static_cast<double>(std::min(wanted - seen, CountNew(bits, seen_.Of(candidate))));
      const double score = std::pow(gain, power) / (std::max(0.0, added) + 0.02);
      if (score > best_score) {
        best_score = score;
        best = candidate;
        best_before = before;
      }
    }
    stops.insert(stops.begin() + static_cast<std::ptrdiff_t>(best_before) + 1, best);
    seen = SeenBy(stops, bits);
  }
}

void CoverTourSearch::ImproveOrder(Stops& stops) {
  const auto length = [&](std::size_t a, std::size_t b) { return paths_.Length(stops[a], stops[b]); };
  bool improved = true;
  while (improved) {
    improved = false;
    // Reverse the stops from i to j.
    for (std::size_t i = 1; i + 1 < stops.size(); ++i) {
      for (std::size_t j = i + 1; j < stops.size(); ++j) {
        double change = length(i - 1, j) - length(i - 1, i);
        if (j + 1 < stops.size()) change += length(i, j + 1) - length(j, j + 1);
        if (change > -kShorter) continue;
        std::reverse(stops.begin() + static_cast<std::ptrdiff_t>(i),
                     stops.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        improved = true;
      }
    }
    // Move the stops from i to i + count - 1 elsewhere.
    for (std::size_t count = 1; count <= 3; ++count) {
      for (std::size_t i = 1; i + count <= stops.size(); ++i) {
        Stops without = stops;
        const auto first = stops.begin() + static_cast<std::ptrdiff_t>(i);
        const Stops moved(first, first + static_cast<std::ptrdiff_t>(count));
        without.erase(without.begin() + static_cast<std::ptrdiff_t>(i),
                      without.begin() + static_cast<std::ptrdiff_t>(i + count));
        double saved = length(i - 1, i);
        if (i + count < stops.size()) {
          saved += length(i + count - 1, i + count) - length(i - 1, i + count);
        }
        double least = saved - kShorter;
        std::size_t after = without.size();
        bool turned = false;
        for (std::size_t n = 0; n < without.size(); ++n) {
          for (const bool turn : {false, true}) {
            const std::size_t head = turn ? moved.back() : moved.front();
            const std::size_t tail = turn ? moved.front() : moved.back();
            double cost = paths_.Length(without[n], head);
            if (n + 1 < without.size()) {
              cost += paths_.Length(tail, without[n + 1]) - paths_.Length(without[n], without[n + 1]);
            }
            if (cost >= least) continue;
            least = cost;
            after = n;
            turned = turn;
          }
        }
        if (after == without.size()) continue;
        stops = std::move(without);
        Stops placed = moved;
        if (turned) std::reverse(placed.begin(), placed.end());
        stops.insert(stops.begin() + static_cast<std::ptrdiff_t>(after) + 1, placed.begin(), placed.end());
        improved = true;
      }
    }
  }
}

void CoverTourSearch::Drop(Stops& stops, std::size_t wanted) {
  bool dropped = true;
  while (dropped && stops.size() > 1) {
    dropped = false;
    CumulateInto(stops, befores_, afters_);
    double most_saved = -1.0;
    std::size_t drop = 0;
    for (std::size_t n = 1; n < stops.size(); ++n) {
      double saved = paths_.Length(stops[n - 1], stops[n]);
      const bool last = n + 1 == stops.size();
      if (!last) {
        saved += paths_.Length(stops[n], stops[n + 1]) - paths_.Length(stops[n - 1], stops[n + 1]);
      }
      if (saved <= most_saved) continue;
      scratch_ = befores_[n - 1];
      if (!last) {
        AddLeg(stops[n - 1], stops[n + 1], scratch_);
        Unite(scratch_, afters_[n + 1].data());
      }
      if (CountOf(scratch_) < wanted) continue;
      most_saved = saved;
      drop = n;
    }
    if (drop == 0) continue;
    stops.erase(stops.begin() + static_cast<std::ptrdiff_t>(drop));
    dropped = true;
  }
}

void CoverTourSearch::Slide(Stops& stops, std::size_t wanted) {
  for (std::size_t n = 1; n < stops.size(); ++n) {
    const bool last = n + 1 == stops.size();
    CumulateInto(stops, befores_, afters_);
    const auto length_by = [&](std::size_t place) {
      return paths_.Length(stops[n - 1], place) + (last ? 0.0 : paths_.Length(stops[n + 1], place));
    };
    std::vector<std::pair<double, std::size_t>> shorter;
    const double present = length_by(stops[n]);
    for (const PlaceGraph::Link& link : paths_.graph().links[stops[n]]) {
      const double length = length_by(link.to);
      if (length < present - kShorter) shorter.emplace_back(length, link.to);
    }
    std::sort(shorter.begin(), shorter.end());
    for (const auto& [length, place] : shorter) {
      scratch_ = befores_[n - 1];
      AddLeg(stops[n - 1], place, scratch_);
      if (!last) {
        // From the next stop, whose paths are known: the length is the same, though the path may be another.
        paths_.ForEachBetween(stops[n + 1], place, [&](std::size_t p) { AddPlace(p, scratch_); });
        AddPlace(stops[n + 1], scratch_);
        Unite(scratch_, afters_[n + 1].data());
      }
      if (CountOf(scratch_) < wanted) continue;
      stops[n] = place;
      break;
    }
  }
}

CoverTour CoverTourSearch::Search(std::size_t wanted, const CoverTour& from, const Options& options,
                                  const std::function<bool()>& stop) {
  THALWEG_CHECK(wanted <= most_);
  SplitMix random{options.seed};
  const auto finish = [&](Stops& stops) {
    Recreate(stops, wanted, random);
    ImproveOrder(stops);
    Recreate(stops, wanted, random);  // another order passes through other places
    Drop(stops, wanted);
    Slide(stops, wanted);
    if (SeenBy(stops, scratch_) < wanted) Recreate(stops, wanted, random);
    return LengthOf(stops);
  };
  Stops present = from.stops.empty() ? Stops{start_} : from.stops;
  double length = finish(present);
  Stops best = present;
  double least = length;
  for (int k = 0; k < options.iterations && !(stop && stop()); ++k) {
    ++iterations_;
    Stops next = present;
    Ruin(next, random);
    const double next_length = finish(next);
    const double left = 1.0 - static_cast<double>(k) / options.iterations;
    if (next_length <= length + kFirstThreshold * left * left * least) {
      present = std::move(next);
      length = next_length;
    }
    if (length < least - kShorter) {
      best = present;
      least = length;
    }
  }
  CoverTour tour{.stops = best, .length = least};
  tour.seen = SeenBy(best, scratch_);
  return tour;
}

std::vector<std::size_t> CoverTourSearch::PlacesOf(const CoverTour& tour) {
  std::vector<std::size_t> places = {tour.stops.front()};
  for (std::size_t n = 1; n < tour.stops.size(); ++n) {
    std::vector<std::size_t> between;
    paths_.ForEachBetween(tour.stops[n - 1], tour.stops[n], [&](std::size_t p) { between.push_back(p); });
    places.insert(places.end(), between.rbegin(), between.rend());
    places.push_back(tour.stops[n]);
  }
  return places;
}

CoverTour CoverTourSearch::BeginningOf(const CoverTour& tour, std::size_t wanted) {
  CoverTour beginning{.stops = {tour.stops.front()}};
  Bits bits(seen_.words(), 0);
  const std::vector<std::size_t> places = PlacesOf(tour);
  std::size_t next_stop = 1;
  for (std::size_t n = 0; n < places.size(); ++n) {
    AddPlace(places[n], bits);
    beginning.seen = CountOf(bits);
    const bool at_stop = next_stop < tour.stops.size() && n > 0 && places[n] == tour.stops[next_stop];
    if (at_stop) ++next_stop;
    if (n > 0 && (at_stop || beginning.seen >= wanted)) beginning.stops.push_back(places[n]);
    if (beginning.seen >= wanted) break;
  }
  beginning.length = LengthOf(beginning.stops);
  return beginning;
}

}  // namespace thalweg::evaluator
