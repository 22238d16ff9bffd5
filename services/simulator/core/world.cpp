#include "services/simulator/core/world.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "services/simulator/core/surface_color.h"
#include "services/simulator/core/upright_cylinder.h"

namespace thalweg::simulator {
namespace {

void CheckMesh(const Mesh& mesh, const Eigen::AlignedBox3d& bounds_W) {
  if (mesh.triangles.empty()) throw std::invalid_argument("world: the mesh has no triangles");
  if (bounds_W.isEmpty() || bounds_W.volume() <= 0.0) {
    throw std::invalid_argument("world: the bounds are empty");
  }
  for (const auto& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) {
      if (corner >= mesh.vertices.size()) {
        throw std::invalid_argument("world: a triangle refers to vertex " + std::to_string(corner) + " of " +
                                    std::to_string(mesh.vertices.size()));
      }
    }
  }
}

RTCRay MakeRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double length) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tfar = static_cast<float>(length);
  ray.mask = ~0U;
  return ray;
}

/// State that VisitTriangle updates during a nearest-surface query.
struct NearestSearch {
  const Mesh* mesh;
  Eigen::Vector3d p;
  double distance;
};

bool VisitTriangle(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<NearestSearch*>(arguments->userPtr);
  const double distance = DistanceToTriangle(search.p, TriangleOf(*search.mesh, arguments->primID));
  if (distance >= search.distance) return false;
  search.distance = distance;
  arguments->query->radius = static_cast<float>(distance);
  return true;  // the radius has shrunk
}

/// As NearestSearch, for a cylinder instead of a point.
struct CylinderSearch {
  const Mesh* mesh;
  UprightCylinder cylinder;
  double distance;

  /// [m] Radius of a sphere about the cylinder's center that contains everything nearer than `distance`.
  float Radius() const {
    constexpr double kSinglePrecision = 1e-4;  // Embree's, with a margin
    return static_cast<float>(std::hypot(cylinder.radius + distance, 0.5 * cylinder.height + distance) +
                              kSinglePrecision);
  }
};

bool VisitTriangleBesideCylinder(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<CylinderSearch*>(arguments->userPtr);
  const Triangle triangle = TriangleOf(*search.mesh, arguments->primID);
  const double distance = Distance(search.cylinder, triangle, search.distance);
  if (distance >= search.distance) return false;
  search.distance = distance;
  arguments->query->radius = search.Radius();
  return true;  // the radius has shrunk
}

void QueryPoint(RTCScene scene, const Eigen::Vector3d& p_W, float radius, RTCPointQueryFunction visit,
                void* search) {
  RTCPointQuery query{};
  query.x = static_cast<float>(p_W.x());
  query.y = static_cast<float>(p_W.y());
  query.z = static_cast<float>(p_W.z());
  query.radius = radius;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene, &query, &context, visit, search);
}

}  // namespace

struct World::State {
  State(Mesh mesh_in, const Eigen::AlignedBox3d& bounds_in) : mesh(std::move(mesh_in)), bounds(bounds_in) {
    device = rtcNewDevice("threads=1");
    if (device == nullptr) throw std::runtime_error("world: Embree has no device");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Eigen::Vector3f*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(Eigen::Vector3f), mesh.vertices.size()));
    std::copy(mesh.vertices.begin(), mesh.vertices.end(), vertices);
    auto* triangles = static_cast<std::array<std::uint32_t, 3>*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(std::array<std::uint32_t, 3>), mesh.triangles.size()));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE) {
      Release();
      throw std::runtime_error("world: Embree rejects the mesh, error " + std::to_string(error));
    }
  }
  ~State() { Release(); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void Release() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  Mesh mesh;
  Eigen::AlignedBox3d bounds;
  std::vector<Eigen::AlignedBox3d> no_go;
  std::vector<PartInMotion> parts;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

World::World(Mesh mesh, const Eigen::AlignedBox3d& bounds_W, std::vector<Eigen::AlignedBox3d> no_go_W,
             std::vector<MovingPart> parts) {
  CheckMesh(mesh, bounds_W);
  state_ = std::make_unique<State>(std::move(mesh), bounds_W);
  state_->no_go = std::move(no_go_W);
  for (MovingPart& part : parts) state_->parts.emplace_back(std::move(part));
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const Mesh& World::mesh() const {
  return state_->mesh;
}
const Eigen::AlignedBox3d& World::bounds() const {
  return state_->bounds;
}

const std::vector<Eigen::AlignedBox3d>& World::no_go() const {
  return state_->no_go;
}

const std::vector<PartInMotion>& World::parts() const {
  return state_->parts;
}

World World::WithoutParts() const {
  return {state_->mesh, state_->bounds, state_->no_go};
}

World World::AtStart() const {
  std::vector<MovingPart> parts;
  for (const PartInMotion& part : state_->parts) parts.push_back(part.part());
  return {state_->mesh, state_->bounds, state_->no_go, std::move(parts)};
}

double World::MoveParts(double dt, const RobotModel& robot, const Eigen::Vector3d& p_W) {
  double farthest = 0.0;
  for (PartInMotion& part : state_->parts) farthest = std::max(farthest, part.Advance(dt, robot, p_W));
  return farthest;
}

std::optional<Hit> World::CastRay(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W,
                                  double max_distance) const {
  RTCRayHit query{};
  query.ray = MakeRay(origin_W, direction_W, max_distance);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(state_->scene, &context, &query);
  const bool on_mesh = query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  std::optional<PartInMotion::Meeting> on_part;
  for (const PartInMotion& part : state_->parts) {
    const double nearest = on_part   ? on_part->distance
                           : on_mesh ? static_cast<double>(query.ray.tfar)
                                     : max_distance;
    if (const auto met = part.CastRay(origin_W, direction_W, nearest)) on_part = met;
  }
  Hit hit;
  if (on_part) {
    hit.distance = on_part->distance;
    hit.normal_W = on_part->normal_W;
    hit.at_rest_W = on_part->at_rest_W;
    return hit;
  }
  if (!on_mesh) return std::nullopt;
  hit.distance = static_cast<double>(query.ray.tfar);
  hit.normal_W = Eigen::Vector3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).cast<double>().normalized();
  if (hit.normal_W.dot(direction_W) > 0.0) hit.normal_W = -hit.normal_W;
  hit.triangle = query.hit.primID;
  hit.barycentric = {static_cast<double>(query.hit.u), static_cast<double>(query.hit.v)};
  return hit;
}

double World::DistanceToSurface(const Eigen::Vector3d& p_W, double max_distance) const {
  NearestSearch search{&state_->mesh, p_W, max_distance};
  QueryPoint(state_->scene, p_W, static_cast<float>(max_distance), VisitTriangle, &search);
  for (const PartInMotion& part : state_->parts) {
    search.distance = std::min(search.distance, part.DistanceTo(p_W));
  }
  return search.distance;
}

double World::ClearanceOf(const RobotModel& robot, const Eigen::Vector3d& p_W, double limit) const {
  if (robot.height <= 0.0) return DistanceToSurface(p_W, robot.radius + limit) - robot.radius;
  CylinderSearch search{&state_->mesh, {p_W, robot.radius, robot.height}, limit};
  QueryPoint(state_->scene, p_W, search.Radius(), VisitTriangleBesideCylinder, &search);
  for (const PartInMotion& part : state_->parts) {
    search.distance = std::min(search.distance, part.DistanceTo(robot, p_W));
  }
  return search.distance;
}

bool World::InSight(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const {
  const Eigen::Vector3d segment = b_W - a_W;
  const double length = segment.norm();
  if (length <= 0.0) return true;
  for (const PartInMotion& part : state_->parts) {
    if (part.CastRay(a_W, segment / length, length)) return false;
  }
  RTCRay ray = MakeRay(a_W, segment / length, length);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(state_->scene, &context, &ray);
  return ray.tfar >= 0.0F;  // Embree marks an occluded ray by -inf
}

Rgb World::ColorAt(const Hit& hit, double footprint) const {
  if (hit.at_rest_W) return PatternedColor(Material{}.diffuse, *hit.at_rest_W, footprint);
  return SurfaceColor(state_->mesh, hit.triangle, hit.barycentric, footprint);
}

bool World::HasTexture(const Hit& hit) const {
  return !hit.at_rest_W && TextureOf(state_->mesh, hit.triangle) != nullptr;
}

}  // namespace thalweg::simulator
