#include "services/evaluator/core/offline_tour.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>

#include "common/base/parallel.h"
#include "services/simulator/core/reachable.h"

namespace thalweg::evaluator {
namespace {

RobotModel Widened(RobotModel robot, double clearance) {
  robot.radius = clearance;
  return robot;
}

int LeastStep(double spacing, double voxel_size) {
  return std::max(1, static_cast<int>(std::lround(spacing / voxel_size)));
}

/// `count` of the numbers below `all` at random, in ascending order.
std::vector<std::size_t> RandomSample(std::size_t all, std::size_t count, std::uint32_t seed) {
  std::vector<std::size_t> numbers(all);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  if (count >= all) return numbers;
  std::mt19937 random(seed);
  for (std::size_t k = 0; k < count; ++k) std::swap(numbers[k], numbers[k + random() % (all - k)]);
  numbers.resize(count);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

/// The least number that is at least that share of all.
std::size_t NumberFor(double share, std::size_t all) {
  return static_cast<std::size_t>(std::ceil(share * static_cast<double>(all) - 1e-9));
}

}  // namespace

TourGround::TourGround(const simulator::World& world, std::shared_ptr<const simulator::TrueMap> truth,
                       const simulator::TrueMap::Options& options_of_truth, const Eigen::Vector3d& start_W,
                       const Options& options, const std::stop_token& stop)
    : options_(options),
      voxel_size_(options_of_truth.voxel_size),
      truth_(std::move(truth)),
      robot_(Widened(options_of_truth.robot, options.clearance)),
      first_start_W_(start_W),
      reachable_(simulator::ReachableVoxels(world, start_W, robot_, voxel_size_)),
      sight_(world, *truth_, start_W, options_of_truth),
      lattice_(
          LatticeOn(reachable_, voxel_size_, LeastStep(options.spacing, voxel_size_), options.max_places)),
      samples_(RandomSample(sight_.voxels().size(), options.max_samples, options.seed)),
      seen_(lattice_.places.size(), samples_.size()) {
  ParallelFor(lattice_.places.size(), 1, [&](std::size_t place) {
    if (stop.stop_requested()) return;
    const Eigen::Vector3d p_W = PositionOf(lattice_.places[place]);
    for (std::size_t n = 0; n < samples_.size(); ++n) {
      if (sight_.Sees(p_W, samples_[n])) seen_.Set(place, n);
    }
  });
}

bool TourGround::Fits(const simulator::World& world, const RobotModel& robot, const Eigen::Vector3d& start_W,
                      double clearance) try {
  simulator::CheckStart(world, start_W, Widened(robot, clearance));
  return true;
} catch (const std::invalid_argument&) {
  return false;
}

bool TourGround::HoldsFor(const Eigen::Vector3d& start_W) const {
  return truth_->HoldsFor(start_W) && reachable_.Get(VoxelAt(start_W, voxel_size_), 0) != 0;
}

Eigen::Vector3d TourGround::PositionOf(const VoxelIndex& place) const {
  return simulator::PlaceIn(place, voxel_size_, robot_, first_start_W_);
}

double TourGround::CoverageFrom(std::span<const Eigen::Vector3d> places_W) const {
  const std::size_t all = sight_.voxels().size();
  std::vector<std::uint8_t> seen(all, 0);
  ParallelFor(all, 256, [&](std::size_t n) {
    seen[n] = std::any_of(places_W.begin(), places_W.end(),
                          [&](const Eigen::Vector3d& p_W) { return sight_.Sees(p_W, n); });
  });
  const auto count = std::count(seen.begin(), seen.end(), 1);
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, all));
}

OfflineTours TourGround::ToursFrom(const Eigen::Vector3d& start_W, const std::stop_token& stop,
                                   const std::function<double()>& elapsed) const {
  OfflineTours tours;
  tours.spacing = lattice_.step * voxel_size_;
  tours.places = lattice_.places.size();
  if (samples_.empty()) return tours;
  ViewLattice lattice = lattice_;
  BitTable seen = seen_;
  const std::size_t start = lattice.Add(reachable_, VoxelAt(start_W, voxel_size_));
  if (start == lattice_.places.size()) {
    std::vector<std::size_t> items;
    for (std::size_t n = 0; n < samples_.size(); ++n) {
      if (sight_.Sees(PositionOf(lattice.places[start]), samples_[n])) items.push_back(n);
    }
    seen.AppendRow(items);
  }
  const double to_first_place = (PositionOf(lattice.places[start]) - start_W).norm();
  ShortestPaths paths(lattice.graph);
  CoverTourSearch search(paths, seen, start);
  const auto path_of = [&](const CoverTour& tour) {
    std::vector<Eigen::Vector3d> path_W = {start_W};
    for (const std::size_t place : search.PlacesOf(tour)) {
      path_W.push_back(PositionOf(lattice.places[place]));
    }
    return path_W;
  };

  // The longest first: its beginnings are where the search for the others starts.
  CoverTour longer;
  for (std::size_t k = kTourCoverages.size(); k-- > 0;) {
    // The share of the budget by whose end this search ends: the farther, the more time, here 4 : 3 : 2 : 1.
    const double share =
        1.0 - static_cast<double>(k * (k + 1)) / (kTourCoverages.size() * (kTourCoverages.size() + 1));
    const auto out_of_time = [&] {
      return stop.stop_requested() || (elapsed && elapsed() > share * options_.budget);
    };
    OfflineTour& best = tours.to.at(k);
    const std::size_t least_wanted = NumberFor(kTourCoverages.at(k), samples_.size());
    std::size_t wanted = least_wanted;
    CoverTour from;
    if (!longer.stops.empty()) from = search.BeginningOf(longer, wanted);
    for (int round = 0; wanted <= search.most() && (round < kRounds || !best.length); ++round) {
      if (round > 0 && best.length && out_of_time()) break;
      const CoverTour tour = search.Search(wanted, from,
                                           {.seed = options_.seed + static_cast<std::uint32_t>(round),
                                            .iterations = round < kRounds ? options_.iterations : 0},
                                           out_of_time);
      from = tour;
      const std::vector<Eigen::Vector3d> path_W = path_of(tour);
      const double coverage = CoverageFrom({path_W.begin() + 1, path_W.end()});
      const double length = to_first_place + tour.length;
      if (coverage >= kTourCoverages.at(k) && (!best.length || length < *best.length)) {
        best = {.length = length, .coverage = coverage, .stops = tour.stops.size() - 1, .path_W = path_W};
        longer = tour;
      }
      // The next round asks for as much more, or less, of the sample as this one missed, or exceeded, of all.
      const double missing = (kTourCoverages.at(k) - coverage) * static_cast<double>(samples_.size());
      const double next = static_cast<double>(wanted) + std::ceil(missing);
      wanted = std::max(least_wanted, static_cast<std::size_t>(std::max(0.0, next)));
    }
    if (out_of_time()) tours.out_of_time = true;
  }
  // Any tour that leads farther is a tour to there as well.
  for (std::size_t k = kTourCoverages.size() - 1; k-- > 0;) {
    OfflineTour& tour = tours.to.at(k);
    const OfflineTour& farther = tours.to.at(k + 1);
    if (farther.length && (!tour.length || *farther.length < *tour.length)) tour = farther;
  }
  tours.iterations = search.iterations();
  return tours;
}

}  // namespace thalweg::evaluator
