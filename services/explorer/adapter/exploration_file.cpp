#include "services/explorer/adapter/exploration_file.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "services/explorer/core/no_go_boxes.h"

namespace thalweg::explorer {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 4;
constexpr int kOldest = 3;                     // which does not have gone_tight_way
constexpr std::size_t kMostAside = 2'000'000;  // more voxels than any planner's map has at its border
constexpr double kMostAmount = 1e8;            // [m] or [s]; three years
constexpr std::size_t kLongestText = kLongestPlace;

Json JsonOf(const Eigen::Vector3d& p_W) {
  return {p_W.x(), p_W.y(), p_W.z()};
}

Json JsonOf(const PauseCause& cause) {
  return {{"reason", std::string(NameOf(cause.reason))}, {"error", cause.error.substr(0, kLongestText)}};
}

double NumberFrom(const Json& json) {
  const double value = json.get<double>();
  if (!std::isfinite(value)) throw std::runtime_error("a number is not finite");
  return value;
}

double AmountFrom(const Json& json) {
  const double value = NumberFrom(json);
  if (!(value >= 0.0 && value <= kMostAmount)) throw std::runtime_error("an amount is negative or absurd");
  return value;
}

Eigen::Vector3d PointFrom(const Json& json) {
  if (!json.is_array() || json.size() != 3) throw std::runtime_error("a point needs three numbers");
  return {NumberFrom(json[0]), NumberFrom(json[1]), NumberFrom(json[2])};
}

std::string TextFrom(const Json& json) {
  std::string text = json.get<std::string>();
  if (text.size() > kLongestText) throw std::runtime_error("a text is too long");
  return text;
}

/// The enumerator that `find` has under that name.
template <class Find>
auto NamedFrom(const std::string& name, Find&& find) {
  const auto value = find(name);
  if (!value) throw std::runtime_error("unknown name \"" + name + "\"");
  return *value;
}

std::vector<SavedExploration::Aside> AsideFrom(const Json& json) {
  std::vector<SavedExploration::Aside> aside;
  for (const auto& [name, points] : json.items()) {
    const auto reason = NamedFrom(name, AsideReasonNamed);
    if (aside.size() + points.size() > kMostAside) throw std::runtime_error("too many points");
    for (const Json& point : points) aside.push_back({PointFrom(point), reason});
  }
  return aside;
}

SavedExploration From(const Json& json) {
  const int version = json.at("version").get<int>();
  if (version < kOldest || version > kVersion) throw std::runtime_error("written by another version");
  SavedExploration saved;
  saved.place = TextFrom(json.at("place"));
  if (!json.at("home").is_null()) saved.home_W = PointFrom(json["home"]);
  saved.distance = AmountFrom(json.at("distance_m"));
  saved.elapsed = FromSeconds(AmountFrom(json.at("elapsed_s")));
  if (!json.at("homeward").is_null()) saved.homeward = NamedFrom(TextFrom(json["homeward"]), OutcomeNamed);
  if (const Json& paused = json.at("paused"); !paused.is_null()) {
    saved.paused =
        PauseCause{NamedFrom(TextFrom(paused.at("reason")), PauseReasonNamed), TextFrom(paused.at("error"))};
  }
  if (version > kOldest) saved.gone_tight_way = json.at("gone_tight_way").get<bool>();
  saved.strategy = TextFrom(json.at("strategy"));
  if (json.at("no_go").size() > NoGoBoxes::kMostDrawn) throw std::runtime_error("too many boxes");
  for (const Json& box : json["no_go"]) {
    const Eigen::AlignedBox3d box_W(PointFrom(box.at("min")), PointFrom(box.at("max")));
    if (box_W.isEmpty()) throw std::runtime_error("a box is empty");
    saved.drawn.push_back(box_W);
  }
  saved.aside = AsideFrom(json.at("set_aside"));
  return saved;
}

}  // namespace

std::string EncodeExploration(const SavedExploration& saved) {
  Json boxes = Json::array();
  for (const Eigen::AlignedBox3d& box_W : saved.drawn)
    boxes.push_back({{"min", JsonOf(box_W.min())}, {"max", JsonOf(box_W.max())}});
  Json aside = Json::object();
  for (const SavedExploration::Aside& one : saved.aside)
    aside[std::string(NameOf(one.reason))].push_back(JsonOf(one.p_W));
  return Json{{"version", kVersion},
              {"place", saved.place},
              {"home", saved.home_W ? JsonOf(*saved.home_W) : Json(nullptr)},
              {"distance_m", saved.distance},
              {"elapsed_s", std::chrono::duration<double>(saved.elapsed).count()},
              {"homeward", saved.homeward ? Json(std::string(NameOf(*saved.homeward))) : Json(nullptr)},
              {"paused", saved.paused ? JsonOf(*saved.paused) : Json(nullptr)},
              {"gone_tight_way", saved.gone_tight_way},
              {"strategy", saved.strategy},
              {"no_go", boxes},
              {"set_aside", aside}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<SavedExploration> DecodeExploration(std::string_view text) try {
  return From(Json::parse(text));
} catch (const std::exception& error) {
  return Error{error.what()};
}

Result<SavedExploration> LoadExploration(const std::filesystem::path& file) {
  std::ostringstream text;
  if (!(text << std::ifstream(file, std::ios::binary).rdbuf()))
    return Error{file.string() + ": cannot be read"};
  Result<SavedExploration> saved = DecodeExploration(text.str());
  if (!saved) return Error{file.string() + ": " + saved.error()};
  return saved;
}

}  // namespace thalweg::explorer
