#include "services/gateway/adapter/surface_copy.h"

#include <algorithm>
#include <cmath>

#include "common/base/text.h"
#include "common/dds/convert.h"

namespace thalweg::gateway {
namespace {

std::optional<Error> CheckBlock(const thalweg_msgs::msg::SurfaceBlock& block) {
  const std::string name = "block (" + std::to_string(block.x()) + ", " + std::to_string(block.y()) + ", " +
                           std::to_string(block.z()) + ")";
  const std::size_t vertices = block.views().size();
  if (block.points_m().size() != 3 * vertices || block.normals().size() != 3 * vertices ||
      block.colors().size() != 3 * vertices) {
    return Error{name + " has points, normals, colors and views of different numbers"};
  }
  if (block.faces().size() % 3 != 0) return Error{name + " has a part of a triangle"};
  const auto exists = [vertices](std::uint16_t vertex) { return vertex < vertices; };
  if (!std::all_of(block.faces().begin(), block.faces().end(), exists)) {
    return Error{name + " has a triangle of vertices that it has not"};
  }
  const auto is_place = [](float c) { return std::abs(c) <= 1e6F; };
  if (!std::all_of(block.points_m().begin(), block.points_m().end(), is_place)) {
    return Error{name + " has a point that is not finite and within 1e6 m"};
  }
  return std::nullopt;
}

}  // namespace

Result<std::optional<SurfaceChange>> SurfaceCopy::Apply(const thalweg_msgs::msg::SurfaceUpdate& update) {
  const Result<Time> stamp = dds::FromIdl(update.header(), dds::kMapFrame);
  if (!stamp) return Error{stamp.error()};
  if (update.session() == 0) return Error{"session is 0"};
  if (!(update.voxel_size_m() > 0.0 && std::isfinite(update.voxel_size_m()))) {
    return Error{"voxel_size_m is " + NumberText(update.voxel_size_m()) + ", must be > 0"};
  }
  if (update.blocks().size() > kMostBlocks) return Error{"has more blocks than a mesh may have"};
  for (const auto& block : update.blocks()) {
    if (auto error = CheckBlock(block)) return *std::move(error);
  }
  if (update.full()) {
    // One for another reader replaces nothing that is complete.
    if (complete_ && update.session() == session_ && update.number() <= number_) {
      return std::optional<SurfaceChange>();
    }
  } else {
    const bool follows = update.session() == session_ && update.number() == number_ + 1;
    const bool is_old = update.session() == session_ && update.number() <= number_;
    if (!complete_ || !follows) {
      complete_ = complete_ && is_old;
      return std::optional<SurfaceChange>();
    }
  }
  complete_ = true;
  session_ = update.session();
  number_ = update.number();
  SurfaceChange change{
      .stamp = *stamp, .voxel_size = update.voxel_size_m(), .replaced = update.full(), .blocks = {}};
  change.blocks.reserve(update.blocks().size());
  for (const auto& block : update.blocks()) {
    change.blocks.push_back(
        std::make_shared<const SurfaceMeshBlock>(SurfaceMeshBlock{.block = {block.x(), block.y(), block.z()},
                                                                  .points_m = block.points_m(),
                                                                  .normals = block.normals(),
                                                                  .colors = block.colors(),
                                                                  .views = block.views(),
                                                                  .faces = block.faces()}));
  }
  return std::optional(std::move(change));
}

thalweg_msgs::msg::MapRequest SurfaceCopy::MakeRequest(Time now, const std::string& reader) const {
  thalweg_msgs::msg::MapRequest request;
  request.header(dds::MakeHeader(now, dds::kMapFrame));
  request.reader(reader);
  request.session(session_);
  request.number(number_);
  request.reason(session_ == 0 ? "no mesh yet" : "updates were lost");
  return request;
}

}  // namespace thalweg::gateway
