#include "services/simulator/tools/furnisher.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/angles.h"
#include "services/simulator/tools/furniture.h"

namespace thalweg::simulator {
namespace {

/// [m] Gap between pieces, and beside free-standing ones, so that a robot gets past and nothing is closed
/// off.
constexpr double kBetween = 0.5;
constexpr int kTries = 8;

}  // namespace

Eigen::Vector2d Furnisher::Niche::Before(double distance) const {
  const double yaw = yaw_deg * kDegree;
  return at - distance * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
}

Furnisher::Furnisher(BoxWorld& world, Chance& chance, double height)
    : world_(world), chance_(chance), height_(height) {}

const char* Furnisher::Color() {
  constexpr std::array kColors{"red", "green", "blue", "yellow", "wood", "white"};
  return kColors[chance_.Below(kColors.size())];
}

void Furnisher::LeaveFree(const Eigen::Vector2d& middle, double radius) {
  taken_.push_back({middle, radius - kBetween});
}

bool Furnisher::IsTaken(const FloorArea& area, double beside, int axis, double at, double within) const {
  return std::ranges::any_of(taken_, [&](const Disc& disc) {
    return (disc.middle.array() > area.low.array() - beside).all() &&
           (disc.middle.array() < area.high.array() + beside).all() &&
           std::abs(disc.middle[axis] - at) < within;
  });
}

void Furnisher::Furnish(const Space& space, int pieces) {
  for (int n = 0; n < pieces; ++n) AddPiece(space);
}

bool Furnisher::Take(const Eigen::Vector2d& middle, double radius) {
  const bool taken = std::any_of(taken_.begin(), taken_.end(), [&](const Disc& disc) {
    return (disc.middle - middle).norm() < disc.radius + radius + kBetween;
  });
  if (!taken) taken_.push_back({middle, radius});
  return !taken;
}

std::optional<Eigen::Vector2d> Furnisher::Place(const FloorArea& room, double radius) {
  const Eigen::Vector2d low = room.low.array() + (radius + kBetween);
  const Eigen::Vector2d high = room.high.array() - (radius + kBetween);
  if ((low.array() >= high.array()).any()) return std::nullopt;
  for (int n = 0; n < kTries; ++n) {
    const Eigen::Vector2d middle = chance_.Within(low, high);
    if (Take(middle, radius)) return middle;
  }
  return std::nullopt;
}

/// Finds a position at a wall for something of this width and depth.
std::optional<Furnisher::Niche> Furnisher::PlaceAtWall(const Space& space, double width, double depth) {
  const FloorArea& room = space.area;
  for (int n = 0; n < kTries; ++n) {
    const std::size_t side = chance_.Below(4);
    const int axis = side % 2 == 0 ? 0 : 1;
    const double low = room.low[1 - axis] + 0.5 * width + 0.1;
    const double high = room.high[1 - axis] - 0.5 * width - 0.1;
    if (side == space.open_side || low >= high || room.high[axis] - room.low[axis] < depth + kBetween)
      continue;
    Niche niche{.at = {}, .yaw_deg = std::array{0.0, 90.0, 180.0, -90.0}[side]};
    niche.at[axis] = side == Space::kHighX || side == Space::kHighY ? room.high[axis] : room.low[axis];
    niche.at[1 - axis] = chance_.Between(low, high);
    if (Take(niche.Before(0.5 * depth), 0.5 * std::max(width, depth))) return niche;
  }
  return std::nullopt;
}

void Furnisher::AddPiece(const Space& space) {
  constexpr std::array kPieces{&Furnisher::AddDeskTo,   &Furnisher::AddCotTo,    &Furnisher::AddShelfTo,
                               &Furnisher::AddTableTo,  &Furnisher::AddStoolTo,  &Furnisher::AddBoxTo,
                               &Furnisher::AddScreenTo, &Furnisher::AddColumnTo, &Furnisher::AddCupboardTo};
  (this->*kPieces[chance_.Below(kPieces.size())])(space);
}

void Furnisher::AddDeskTo(const Space& space) {
  if (const auto niche = PlaceAtWall(space, 1.4, 1.4))
    AddDesk(world_, niche->Before(0.5), niche->yaw_deg + chance_.Between(-5.0, 5.0));
}

void Furnisher::AddCotTo(const Space& space) {
  if (const auto niche = PlaceAtWall(space, 1.2, 2.2))
    AddCot(world_, On(niche->Before(1.2), 0.0), niche->yaw_deg + chance_.Between(-4.0, 4.0));
}

void Furnisher::AddShelfTo(const Space& space) {
  const double half = 0.5 * chance_.Between(1.0, 2.0);
  const auto niche = PlaceAtWall(space, 2.0 * half, 0.4);
  if (!niche) return;
  const Eigen::Vector2d middle = niche->Before(0.22);
  const bool along_y = std::abs(niche->at.x() - middle.x()) > std::abs(niche->at.y() - middle.y());
  const Eigen::Vector2d reach = along_y ? Eigen::Vector2d(0.18, half) : Eigen::Vector2d(half, 0.18);
  const double top = chance_.Between(1.1, height_ - 0.2);
  const int boards = 3 + static_cast<int>(chance_.Below(3));
  AddShelf(world_, On(middle - reach, 0.05), On(middle + reach, top), boards);
}

void Furnisher::AddTableTo(const Space& space) {
  const Eigen::Vector2d reach = chance_.Within({0.4, 0.35}, {0.7, 0.5});
  const auto place = Place(space.area, 1.05);
  if (!place) return;
  AddTable(world_, *place - reach, *place + reach, chance_.Between(0.45, 0.8));
  AddChair(world_, *place - Eigen::Vector2d(0.1, reach.y() + 0.25), chance_.Between(60.0, 120.0));
  AddChair(world_, *place + Eigen::Vector2d(0.15, reach.y() + 0.25), chance_.Between(-120.0, -60.0));
}

void Furnisher::AddStoolTo(const Space& space) {
  if (const auto place = Place(space.area, 0.25)) AddStool(world_, *place);
}

void Furnisher::AddBoxTo(const Space& space) {
  const double half = chance_.Between(0.2, 0.35);
  const auto place = Place(space.area, 1.5 * half);
  if (!place) return;
  const char* const color = Color();
  const double top = chance_.Between(0.4, 1.2);
  const Eigen::Vector2d reach(half, half);
  world_.TurnedBox(color, On(*place - reach, 0.0), On(*place + reach, top), chance_.Between(0.0, 90.0));
}

void Furnisher::AddScreenTo(const Space& space) {
  const auto place = Place(space.area, 0.71);
  if (!place) return;
  const char* const color = Color();
  const double top = chance_.Between(1.2, height_ - 0.1);
  const Eigen::Vector2d reach(0.03, 0.7);
  world_.TurnedBox(color, On(*place - reach, 0.05), On(*place + reach, top), chance_.Between(0.0, 180.0));
}

void Furnisher::AddColumnTo(const Space& space) {
  const double radius = chance_.Between(0.12, 0.3);
  const auto place = Place(space.area, radius);
  if (!place) return;
  const char* const color = Color();
  world_.Column(color, On(*place, 0.0), On(*place, chance_.Between(0.6, height_)), radius);
}

void Furnisher::AddCupboardTo(const Space& space) {
  const auto place = Place(space.area, 0.5);
  if (!place) return;
  const char* const color = Color();
  const double foot = chance_.Between(0.4, 0.9);
  const double top = foot + chance_.Between(0.3, 0.8);
  const Eigen::Vector2d reach(0.4, 0.3);
  world_.Box(color, On(*place - reach, foot), On(*place + reach, top));
  world_.Column("dark", On(*place, 0.0), On(*place, foot + 0.01), 0.06, 8);
}

}  // namespace thalweg::simulator
