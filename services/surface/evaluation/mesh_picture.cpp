#include "services/surface/evaluation/mesh_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "common/base/angles.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg::surface {
namespace {

constexpr int kWidth = 1200;
constexpr int kHeight = 900;
constexpr int kZoom = 2;                    // drawn larger and scaled down, so that edges are smooth
constexpr double kMargin = 0.02;            // of the picture on each side
constexpr double kYaw = 60.0 * kDegree;     // the viewer looks along this heading,
constexpr double kPitch = -50.0 * kDegree;  // down at this angle
constexpr float kAmbient = 0.45F;           // brightness of a face seen edge-on

struct Corner {
  Eigen::Vector3f p;      // [px], [px] and depth [m]
  Eigen::Vector3f color;  // blue, green, red, shaded
};

class Sheet {
 public:
  Sheet()
      : picture_(kZoom * kHeight, kZoom * kWidth, cv::Vec3b(255, 255, 255)),
        depth_(kZoom * kHeight, kZoom * kWidth, std::numeric_limits<float>::infinity()) {}

  void Draw(const Corner& a, const Corner& b, const Corner& c) {
    const auto cross = [](const Eigen::Vector3f& m, const Eigen::Vector3f& n) {
      return m.x() * n.y() - m.y() * n.x();
    };
    const float area = cross(b.p - a.p, c.p - a.p);
    if (!(area != 0.0F)) return;
    const auto low = [](float x, float y, float z) {
      return static_cast<int>(std::floor(std::min({x, y, z})));
    };
    const auto high = [](float x, float y, float z) {
      return static_cast<int>(std::ceil(std::max({x, y, z})));
    };
    for (int v = std::max(0, low(a.p.y(), b.p.y(), c.p.y()));
         v <= std::min(picture_.rows - 1, high(a.p.y(), b.p.y(), c.p.y())); ++v) {
      for (int u = std::max(0, low(a.p.x(), b.p.x(), c.p.x()));
           u <= std::min(picture_.cols - 1, high(a.p.x(), b.p.x(), c.p.x())); ++u) {
        const Eigen::Vector3f p(static_cast<float>(u), static_cast<float>(v), 0.0F);
        const float w_b = cross(p - a.p, c.p - a.p) / area;
        const float w_c = cross(b.p - a.p, p - a.p) / area;
        constexpr float kSlack = 1e-3F;  // so that neighbors leave no seam
        if (w_b < -kSlack || w_c < -kSlack || w_b + w_c > 1.0F + kSlack) continue;
        const float depth = a.p.z() + w_b * (b.p.z() - a.p.z()) + w_c * (c.p.z() - a.p.z());
        if (depth > depth_(v, u)) continue;
        depth_(v, u) = depth;
        const Eigen::Vector3f color = a.color + w_b * (b.color - a.color) + w_c * (c.color - a.color);
        for (int k = 0; k < 3; ++k) {
          picture_(v, u)[k] = static_cast<std::uint8_t>(std::lround(std::clamp(color[k], 0.0F, 255.0F)));
        }
      }
    }
  }
  cv::Mat Picture() const {
    cv::Mat small;
    cv::resize(picture_, small, {}, 1.0 / kZoom, 1.0 / kZoom, cv::INTER_AREA);
    return small;
  }

 private:
  cv::Mat_<cv::Vec3b> picture_;
  cv::Mat_<float> depth_;
};

}  // namespace

cv::Mat DrawMesh(const TriangleMesh& mesh) {
  Sheet sheet;
  if (mesh.vertices_W.empty()) return sheet.Picture();
  const Eigen::Matrix3f R_CW =
      (RotationFromYawPitch(kYaw, kPitch) * BodyFromOptical()).transpose().cast<float>();
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p_W : mesh.vertices_W) box.extend(Eigen::Vector3f(R_CW * p_W));
  const auto share = static_cast<float>(kZoom * (1.0 - 2.0 * kMargin));
  const float scale =
      share * std::min(kWidth / std::max(box.sizes().x(), 1e-3F), kHeight / std::max(box.sizes().y(), 1e-3F));
  const Eigen::Vector2f middle(0.5F * kZoom * kWidth, 0.5F * kZoom * kHeight);
  const auto corner = [&](std::uint32_t vertex) {
    const Eigen::Vector3f from_center = R_CW * mesh.vertices_W[vertex] - box.center();
    const float facing = std::abs((R_CW * mesh.normals_W[vertex]).z());
    const auto& [r, g, b] = mesh.colors[vertex];
    Corner in_picture;
    in_picture.p << middle + scale * from_center.head<2>(), from_center.z();
    in_picture.color = (kAmbient + (1.0F - kAmbient) * facing) * Eigen::Vector3f(b, g, r);
    return in_picture;
  };
  for (const auto& [a, b, c] : mesh.faces) {
    const Eigen::Vector3f p = mesh.vertices_W[a];
    const Eigen::Vector3f across = (mesh.vertices_W[b] - p).cross(mesh.vertices_W[c] - p);
    if ((R_CW * across).z() >= 0.0F) continue;  // faces away
    sheet.Draw(corner(a), corner(b), corner(c));
  }
  return sheet.Picture();
}

}  // namespace thalweg::surface
