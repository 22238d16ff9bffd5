#include "services/surface/evaluation/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "common/base/text.h"

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;
using Edge = SurfaceGraph::Edge;

constexpr int kWidth = 960;
constexpr int kHeight = 720;
constexpr int kZoom = 2;  // drawn larger and scaled down, so that lines are smooth
constexpr Rgb kRed{214, 30, 38};
constexpr Rgb kYellow{255, 214, 10};
constexpr Rgb kBlue{30, 90, 220};
constexpr Rgb kPaper{255, 255, 255};
constexpr Rgb kSurface{205, 205, 205};

Rgb Mixed(const Rgb& a, const Rgb& b, double share) {
  const auto mix = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(std::lerp(from, to, share)));
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

/// Colors that differ: hues a golden angle apart, away from red.
Rgb HueOf(std::size_t index) {
  const double hue = 40.0 + std::fmod(137.508 * static_cast<double>(index), 280.0);
  const auto channel = [hue](double offset) {
    const double k = std::fmod(offset + hue / 60.0, 6.0);
    return static_cast<std::uint8_t>(std::lround(210.0 * (1.0 - std::clamp(std::min(k, 4.0 - k), 0.0, 1.0))));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

/// Draws points in W with a depth buffer.
class Sheet {
 public:
  explicit Sheet(const Viewpoint& from)
      : camera_(from.camera),
        T_CW_(from.T_WC.inverse()),
        eye_W_(from.T_WC.translation()),
        picture_(from.camera.height_px, from.camera.width_px, cv::Vec3b(kPaper.b, kPaper.g, kPaper.r)),
        depth_(from.camera.height_px, from.camera.width_px, std::numeric_limits<float>::infinity()) {}

  const Eigen::Vector3d& eye() const { return eye_W_; }

  void Triangle(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, const Eigen::Vector3d& c_W,
                const Rgb& color) {
    const Eigen::Vector3d a = InPicture(a_W);
    const Eigen::Vector3d b = InPicture(b_W);
    const Eigen::Vector3d c = InPicture(c_W);
    if (std::min({a.z(), b.z(), c.z()}) <= 0.0) return;
    const double area = Cross(b - a, c - a);
    if (area == 0.0) return;
    const int left = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}) - 0.5)));
    const int right = std::min(picture_.cols - 1, static_cast<int>(std::max({a.x(), b.x(), c.x()}) + 0.5));
    const int top = std::max(0, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}) - 0.5)));
    const int bottom = std::min(picture_.rows - 1, static_cast<int>(std::max({a.y(), b.y(), c.y()}) + 0.5));
    constexpr double kSlack = 0.35;  // [px] so that neighboring triangles leave no seam
    const double slack =
        kSlack * std::max({(b - a).head<2>().norm(), (c - b).head<2>().norm(), 1.0}) / std::abs(area);
    for (int v = top; v <= bottom; ++v) {
      for (int u = left; u <= right; ++u) {
        const Eigen::Vector3d p(u, v, 0.0);
        const double w_b = Cross(p - a, c - a) / area;
        const double w_c = Cross(b - a, p - a) / area;
        if (w_b < -slack || w_c < -slack || w_b + w_c > 1.0 + slack) continue;
        Dot(u, v, a.z() + w_b * (b.z() - a.z()) + w_c * (c.z() - a.z()), color);
      }
    }
  }

  /// @param width  [px]
  /// @param lift   Share of the depth by which the line is drawn before what it lies on.
  void Line(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, const Rgb& color, int width,
            double lift) {
    const Eigen::Vector3d a = InPicture(a_W);
    const Eigen::Vector3d b = InPicture(b_W);
    if (std::min(a.z(), b.z()) <= 0.0) return;
    const double length = (b - a).head<2>().cwiseAbs().maxCoeff();
    if (length > 4.0 * kZoom * (kWidth + kHeight)) return;  // ends just before the camera
    const int steps = std::max(1, static_cast<int>(std::ceil(length)));
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector3d p = a + (b - a) * i / steps;
      Stamp(p, width, color, lift);
    }
  }

  void Disc(const Eigen::Vector3d& p_W, int radius, const Rgb& color) {
    const Eigen::Vector3d p = InPicture(p_W);
    if (p.z() <= 0.0) return;
    for (int dv = -radius; dv <= radius; ++dv) {
      for (int du = -radius; du <= radius; ++du) {
        if (du * du + dv * dv > radius * radius) continue;
        Dot(static_cast<int>(std::lround(p.x())) + du, static_cast<int>(std::lround(p.y())) + dv, 0.0, color);
      }
    }
  }

  cv::Mat Picture() const {
    cv::Mat small;
    cv::resize(picture_, small, {}, 1.0 / kZoom, 1.0 / kZoom, cv::INTER_AREA);
    return small;
  }

 private:
  static double Cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.x() * b.y() - a.y() * b.x();
  }
  /// (u, v, depth); a depth <= 0 if it is behind the viewer.
  Eigen::Vector3d InPicture(const Eigen::Vector3d& p_W) const {
    const Eigen::Vector3d p_C = T_CW_ * p_W;
    if (p_C.z() <= 1e-3) return {0.0, 0.0, -1.0};
    return {camera_.fx * p_C.x() / p_C.z() + camera_.cx, camera_.fy * p_C.y() / p_C.z() + camera_.cy,
            p_C.z()};
  }
  void Stamp(const Eigen::Vector3d& p, int width, const Rgb& color, double lift) {
    const int u = static_cast<int>(std::lround(p.x())) - (width - 1) / 2;
    const int v = static_cast<int>(std::lround(p.y())) - (width - 1) / 2;
    for (int dv = 0; dv < width; ++dv) {
      for (int du = 0; du < width; ++du) Dot(u + du, v + dv, p.z() * (1.0 - lift), color);
    }
  }
  void Dot(int u, int v, double depth, const Rgb& color) {
    if (u < 0 || v < 0 || u >= picture_.cols || v >= picture_.rows) return;
    if (static_cast<float>(depth) > depth_(v, u)) return;
    depth_(v, u) = static_cast<float>(depth);
    picture_(v, u) = cv::Vec3b(color.b, color.g, color.r);
  }

  PinholeCamera camera_;
  RigidTransform T_CW_;
  Eigen::Vector3d eye_W_;
  cv::Mat_<cv::Vec3b> picture_;
  cv::Mat_<float> depth_;
};

/// Draws the cells that face the viewer.
/// @param color(vertex)  Before lighting.
template <class Color>
void DrawCells(const Surface& surface, Sheet& sheet, Color&& color) {
  surface.ForEachCell([&](const Vertex(&corners)[4]) {
    Eigen::Vector3d p[4];
    for (int k = 0; k < 4; ++k) p[k] = surface.graph().Position(corners[k]).template cast<double>();
    const Vertex newest = *std::max_element(corners, corners + 4);
    Eigen::Vector3d normal = (p[2] - p[0]).cross(p[3] - p[1]);
    const Eigen::Vector3d to_camera = surface.CameraOf(newest) - p[0];
    if (normal.dot(to_camera) < 0.0) normal = -normal;
    const Eigen::Vector3d to_eye = sheet.eye() - p[0];
    if (normal.dot(to_eye) <= 0.0) return;
    const double light = normal.normalized().dot(to_eye.normalized());
    const Rgb lit = Mixed({0, 0, 0}, color(newest), 0.55 + 0.45 * light);
    sheet.Triangle(p[0], p[1], p[2], lit);
    sheet.Triangle(p[0], p[2], p[3], lit);
  });
}

void DrawRift(const Surface& surface, const Rift& rift, const Rgb& color, int width, Sheet& sheet) {
  const SurfaceGraph& graph = surface.graph();
  for (const Edge edge : rift.edges) {
    sheet.Line(graph.Position(graph.End(edge, 0)).cast<double>(),
               graph.Position(graph.End(edge, 1)).cast<double>(), color, width, 0.002);
  }
}

void DrawCamera(const RigidTransform& T_WC, double size, Sheet& sheet) {
  const auto corner = [&](double x, double y) -> Eigen::Vector3d {
    return T_WC * Eigen::Vector3d(0.66 * size * x, 0.5 * size * y, size);
  };
  const Eigen::Vector3d corners[4] = {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
  for (int k = 0; k < 4; ++k) {
    sheet.Line(corners[k], corners[(k + 1) % 4], kBlue, 4, 0.3);
    sheet.Line(T_WC.translation(), corners[k], kBlue, 4, 0.3);
  }
}

}  // namespace

Viewpoint BesideFirstCamera(const Surface& surface) {
  Viewpoint from;
  from.camera = PinholeCamera::FromFieldOfView(kZoom * kWidth, kZoom * kHeight, 0.9);
  if (surface.views().empty() || surface.vertex_count() == 0) return from;
  const RigidTransform& T_WC = surface.views().front().view.T_WC;
  // Stray points far behind must not make all else small: nine tenths of each coordinate decide.
  Eigen::Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (Vertex vertex = 0; vertex < surface.vertex_count(); ++vertex) {
      values.push_back(surface.graph().Position(vertex)[axis]);
    }
    const auto at = [&](double share) {
      const auto nth =
          values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), nth, values.end());
      return static_cast<double>(*nth);
    };
    low[axis] = at(0.05);
    high[axis] = at(0.95);
  }
  const Eigen::Vector3d center_W = 0.5 * (low + high);
  const double radius = 0.5 * (high - low).norm();
  const double yaw = std::atan2(T_WC.linear()(1, 2), T_WC.linear()(0, 2)) - 0.5;
  const Eigen::Vector3d forward_W = RotationFromYawPitch(yaw, -0.6).col(0);
  const double distance = radius / std::tan(0.5 * 0.75 * 0.9);
  from.T_WC = LookingAlong(center_W - distance * forward_W, forward_W, T_WC);
  return from;
}

std::vector<Rgb> VertexColors(const Surface& surface) {
  constexpr Rgb kGray{170, 170, 170};
  std::vector<Rgb> colors(surface.graph().vertex_count(), kGray);
  // Later views do not repaint what an earlier one showed: from the last to the first.
  for (auto it = surface.views().rbegin(); it != surface.views().rend(); ++it) {
    if (it->view.colors.empty()) continue;
    for (std::size_t pixel = 0; pixel < it->vertex_of_pixel.size(); ++pixel) {
      const Vertex vertex = it->vertex_of_pixel[pixel];
      if (vertex != SurfaceGraph::kNone) colors[vertex] = it->view.colors[pixel];
    }
  }
  return colors;
}

Rgb WeightColor(double weight, double delta_m) {
  constexpr Rgb kGreen{20, 150, 60};
  const double share = std::clamp(weight / delta_m, 0.0, 1.0);
  return share < 0.5 ? Mixed(kGreen, kYellow, 2.0 * share) : Mixed(kYellow, kRed, 2.0 * share - 1.0);
}

cv::Mat DrawEdges(const Surface& surface, const Viewpoint& from) {
  Sheet sheet(from);
  const SurfaceGraph& graph = surface.graph();
  for (Edge edge = 0; edge < graph.edge_numbers(); ++edge) {
    if (!graph.Exists(edge)) continue;
    const Vertex a = graph.End(edge, 0);
    const Vertex b = graph.End(edge, 1);
    if (std::max(a, b) >= surface.vertex_count()) continue;  // of a rift vertex
    sheet.Line(graph.Position(a).cast<double>(), graph.Position(b).cast<double>(),
               WeightColor(graph.Weight(edge), surface.options().rift_edge), 1, 0.0);
  }
  return sheet.Picture();
}

std::vector<Meaning> LegendOfEdges(double delta_m) {
  return {{WeightColor(0.0, delta_m), "edge of no length"},
          {WeightColor(0.5 * delta_m, delta_m), NumberText(0.5 * delta_m) + " m"},
          {WeightColor(delta_m, delta_m), NumberText(delta_m) + " m and more: of a rift"}};
}

cv::Mat DrawRifts(const Surface& surface, const Move& move, const Viewpoint& from) {
  Sheet sheet(from);
  DrawCells(surface, sheet, [](Vertex) { return kSurface; });
  if (move.rifts.empty()) return sheet.Picture();
  const std::size_t dominant = move.ranked.empty() ? move.rifts.size() : move.ranked.front().rift;
  std::size_t most = 0;
  for (const Rift& rift : move.rifts) most = std::max(most, rift.edges.size());
  for (std::size_t i = 0; i < move.rifts.size(); ++i) {
    const bool is_dominant = i == dominant;
    DrawRift(surface, move.rifts[i], is_dominant ? kRed : HueOf(i), is_dominant ? 4 : 2, sheet);
  }
  for (std::size_t i = 0; i < move.rifts.size(); ++i) {
    if (i != dominant && 100 * move.rifts[i].edges.size() < most) continue;
    const Eigen::Vector3d center_W = move.rifts[i].center_W.cast<double>();
    sheet.Disc(center_W, i == dominant ? 16 : 10, {0, 0, 0});
    sheet.Disc(center_W, i == dominant ? 12 : 7, i == dominant ? kRed : HueOf(i));
  }
  return sheet.Picture();
}

std::vector<Meaning> LegendOfRifts() {
  return {{kSurface, "surface"},
          {kRed, "dominant rift"},
          {HueOf(0), "another rift, each in a color of its own; disc: rift vertex"}};
}

cv::Mat DrawTrajectory(const Surface& surface, const Move& move, int views, const Viewpoint& from) {
  Sheet sheet(from);
  const std::vector<Rgb> colors = VertexColors(surface);
  DrawCells(surface, sheet, [&](Vertex vertex) { return colors[vertex]; });
  if (move.ranked.empty()) return sheet.Picture();
  const Rift& dominant = move.rifts[move.ranked.front().rift];
  DrawRift(surface, dominant, kRed, 3, sheet);
  const auto position = [&](Vertex vertex) -> Eigen::Vector3d {
    return surface.graph().Position(vertex).cast<double>();
  };
  for (std::size_t i = 1; i < move.path.vertices.size(); ++i) {
    sheet.Line(position(move.path.vertices[i - 1]), position(move.path.vertices[i]), kYellow, 5, 0.05);
  }
  for (std::size_t i = 1; i < move.poses.size(); ++i) {
    sheet.Line(move.poses[i - 1].T_WC.translation(), move.poses[i].T_WC.translation(), kBlue, 2, 0.3);
  }
  DrawCamera(surface.views().back().view.T_WC, 0.3, sheet);
  for (const CameraPose& pose : PosesToLookFrom(move.poses, views)) DrawCamera(pose.T_WC, 0.3, sheet);
  sheet.Disc(dominant.center_W.cast<double>(), 14, {0, 0, 0});
  sheet.Disc(dominant.center_W.cast<double>(), 10, kRed);
  return sheet.Picture();
}

std::vector<Meaning> LegendOfTrajectory() {
  return {{kRed, "dominant rift"},
          {kYellow, "path over the surface"},
          {kBlue, "the camera's way, and the poses from which it looks"}};
}

}  // namespace thalweg::surface
