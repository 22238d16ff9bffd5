#include "services/visual_odometry/core/corners.h"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <queue>

namespace thalweg::visual_odometry {
namespace {

constexpr int kMargin = 10;              // [px] room for a patch
constexpr float kLeastStrength = 2e-5F;  // of cornerMinEigenVal on a CV_8U image: noise of two gray values
constexpr float kLeastShare = 0.003F;    // of the strongest corner's strength
constexpr float kApart = 6.0F;           // [px] smallest distance of a new corner from an existing one
constexpr float kSmallestLeaf = 8.0F;    // [px]

struct Corner {
  Eigen::Vector2f p;
  float strength;  ///< Infinite: an existing corner.
};

struct Leaf {
  cv::Rect2f area;
  std::vector<Corner> corners;
  bool operator<(const Leaf& other) const { return corners.size() < other.corners.size(); }
};

std::vector<Corner> LocalMaxima(const cv::Mat& image) {
  cv::Mat strength;
  cv::cornerMinEigenVal(image, strength, 5, 3);
  double strongest = 0.0;
  cv::minMaxLoc(strength, nullptr, &strongest);
  const float least = std::max(kLeastStrength, kLeastShare * static_cast<float>(strongest));
  cv::Mat highest;
  cv::dilate(strength, highest, cv::getStructuringElement(cv::MORPH_RECT, {5, 5}));
  std::vector<Corner> corners;
  for (int row = kMargin; row < image.rows - kMargin; ++row) {
    const float* const own = strength.ptr<float>(row);
    const float* const best = highest.ptr<float>(row);
    for (int column = kMargin; column < image.cols - kMargin; ++column) {
      if (own[column] < least || own[column] < best[column]) continue;
      corners.push_back({{static_cast<float>(column), static_cast<float>(row)}, own[column]});
    }
  }
  return corners;
}

/// Drops new corners that are too close to an existing one, using a mask of the blocked pixels.
void DropNear(std::vector<Corner>& corners, const std::vector<Eigen::Vector2f>& taken, const cv::Size& size) {
  cv::Mat blocked = cv::Mat::zeros(size, CV_8UC1);
  for (const Eigen::Vector2f& p : taken) {
    cv::circle(blocked, {cvRound(p.x()), cvRound(p.y())}, static_cast<int>(kApart), cv::Scalar(255), -1);
  }
  std::erase_if(corners, [&](const Corner& corner) {
    return blocked.at<std::uint8_t>(static_cast<int>(corner.p.y()), static_cast<int>(corner.p.x())) != 0;
  });
}

std::vector<Leaf> Split(Leaf leaf) {
  const float half_width = 0.5F * leaf.area.width;
  const float half_height = 0.5F * leaf.area.height;
  std::vector<Leaf> children(4);
  for (std::size_t k = 0; k < 4; ++k) {
    children[k].area = {leaf.area.x + (k % 2 == 1 ? half_width : 0.0F),
                        leaf.area.y + (k / 2 == 1 ? half_height : 0.0F), half_width, half_height};
  }
  for (const Corner& corner : leaf.corners) {
    const std::size_t right = corner.p.x() >= leaf.area.x + half_width ? 1 : 0;
    const std::size_t low = corner.p.y() >= leaf.area.y + half_height ? 2 : 0;
    children[right + low].corners.push_back(corner);
  }
  std::erase_if(children, [](const Leaf& child) { return child.corners.empty(); });
  return children;
}

}  // namespace

std::vector<Eigen::Vector2f> FindCorners(const cv::Mat& image, const std::vector<Eigen::Vector2f>& taken,
                                         int target) {
  std::vector<Corner> corners = LocalMaxima(image);
  DropNear(corners, taken, image.size());
  for (const Eigen::Vector2f& p : taken) corners.push_back({p, std::numeric_limits<float>::infinity()});

  std::priority_queue<Leaf> open;
  std::vector<Leaf> closed;
  open.push(
      {{0.0F, 0.0F, static_cast<float>(image.cols), static_cast<float>(image.rows)}, std::move(corners)});
  while (!open.empty() && open.size() + closed.size() < static_cast<std::size_t>(target)) {
    Leaf fullest = open.top();
    open.pop();
    if (fullest.corners.size() < 2 || std::min(fullest.area.width, fullest.area.height) < kSmallestLeaf) {
      closed.push_back(std::move(fullest));
      continue;
    }
    for (Leaf& child : Split(std::move(fullest))) open.push(std::move(child));
  }
  for (; !open.empty(); open.pop()) closed.push_back(open.top());

  std::vector<Corner> chosen;
  for (const Leaf& leaf : closed) {
    if (leaf.corners.empty()) continue;
    const Corner best =
        *std::max_element(leaf.corners.begin(), leaf.corners.end(),
                          [](const Corner& a, const Corner& b) { return a.strength < b.strength; });
    if (best.strength < std::numeric_limits<float>::infinity()) chosen.push_back(best);
  }
  std::sort(chosen.begin(), chosen.end(),
            [](const Corner& a, const Corner& b) { return a.strength > b.strength; });
  const std::size_t room =
      target > static_cast<int>(taken.size()) ? static_cast<std::size_t>(target) - taken.size() : 0;
  if (chosen.size() > room) chosen.resize(room);
  std::vector<Eigen::Vector2f> result;
  result.reserve(chosen.size());
  for (const Corner& corner : chosen) result.push_back(corner.p);
  return result;
}

}  // namespace thalweg::visual_odometry
