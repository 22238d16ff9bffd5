#include "services/visual_odometry/core/stereo_matcher.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>

namespace thalweg::visual_odometry {
namespace {

constexpr float kMatchReach = 2.5F;  // [px] of an alignment
constexpr float kOffRow = 0.75F;     // [px] largest distance of a match from its row
constexpr float kBackAgain = 0.5F;   // [px] largest error after matching back to the left image
// Assumed orientations of a surface: facing the camera; a near wall on either side; a near floor; a near
// ceiling. Each is the stretch of the left image along the row and its shear, relative to the right image.
constexpr std::array<std::pair<float, float>, 5> kSlants = {
    {{1.0F, 0.0F}, {0.75F, 0.0F}, {1.35F, 0.0F}, {1.0F, 0.35F}, {1.0F, -0.35F}}};
constexpr int kWorstMatch = 30 * SearchPatch::kSize * SearchPatch::kSize;  // SAD on doubled contrast

}  // namespace

StereoMatcher::StereoMatcher(const Frame& frame, const Levels& levels, const StereoMatcherOptions& options,
                             double row_offset)
    : frame_(frame), levels_(levels), options_(options), row_offset_(static_cast<float>(row_offset)) {}

std::optional<double> StereoMatcher::Search(const Eigen::Vector2f& left) {
  const auto level = static_cast<std::size_t>(levels_.stereo);
  if (left_search_.empty()) {
    left_search_ = WithoutLight(frame_.left[level]);
    right_search_ = WithoutLight(frame_.right[level]);
  }
  const float scale = 1.0F / static_cast<float>(1 << levels_.stereo);
  const Eigen::Vector2f start = left * scale;
  const float row_there = start.y() + row_offset_ * scale;
  const auto patch = SearchPatch::Cut(left_search_, start, Eigen::Matrix2f::Identity());
  if (!patch) return std::nullopt;
  const int range = static_cast<int>(options_.max_disparity * left_search_.cols);
  const cv::Rect row(static_cast<int>(std::lround(start.x())) - range,
                     static_cast<int>(std::lround(row_there)), range + 2, 1);
  const auto found = patch->Search(right_search_, row);
  if (!found || found->difference > kWorstMatch ||
      static_cast<float>(found->difference) > options_.uniqueness * static_cast<float>(found->rival)) {
    return std::nullopt;
  }
  Eigen::Vector2f right(found->position.x(), row_there);
  for (int at = levels_.stereo; at > 0; --at) {
    const float own = 1.0F / static_cast<float>(1 << at);
    const auto aligned_patch =
        Patch::Cut(frame_.left[static_cast<std::size_t>(at)], left * own, Eigen::Matrix2f::Identity());
    if (!aligned_patch) return std::nullopt;
    const auto aligned =
        aligned_patch->FindAlongRow(frame_.right[static_cast<std::size_t>(at)], right, kMatchReach);
    if (!aligned) return std::nullopt;
    right = 2.0F * aligned->position;
    right.y() = (left.y() + row_offset_) * own * 2.0F;
  }
  return Refine(left, right.x());
}

std::optional<double> StereoMatcher::Refine(const Eigen::Vector2f& left, double expected) {
  for (const auto& [stretch, shear] : kSlants) {
    Eigen::Matrix2f left_from_right;
    left_from_right << stretch, shear, 0.0F, 1.0F;
    if (const auto right = RefineAs(left_from_right, left, expected)) return right;
  }
  return std::nullopt;
}

std::optional<double> StereoMatcher::RefineAs(const Eigen::Matrix2f& left_from_right,
                                              const Eigen::Vector2f& left, double expected) {
  const auto patch = Patch::Cut(frame_.left[0], left, left_from_right);
  if (!patch) return std::nullopt;
  const Eigen::Vector2f start(static_cast<float>(expected), left.y() + row_offset_);
  const auto right = patch->FindAlongRow(frame_.right[0], start, kMatchReach);
  if (!right || right->correlation < options_.least_correlation) return std::nullopt;
  const auto free = patch->Find(frame_.right[0], right->position, kMatchReach);
  if (!free) return std::nullopt;
  const float offset = free->position.y() - left.y();
  if (free->correlation >= options_.least_correlation) row_offsets_.push_back(static_cast<double>(offset));
  if (std::abs(offset - row_offset_) > kOffRow) return std::nullopt;
  const auto back_patch = Patch::Cut(frame_.right[0], right->position, left_from_right.inverse());
  if (!back_patch) return std::nullopt;
  const auto back = back_patch->FindAlongRow(frame_.left[0], left, kMatchReach);
  if (!back || std::abs(back->position.x() - left.x()) > kBackAgain) return std::nullopt;
  const auto disparity = static_cast<double>(left.x() - right->position.x());
  if (disparity <= 0.0 || disparity > options_.max_disparity * frame_.left[0].cols) return std::nullopt;
  return static_cast<double>(right->position.x());
}

}  // namespace thalweg::visual_odometry
