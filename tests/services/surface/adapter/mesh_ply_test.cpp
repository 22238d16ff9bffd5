#include "services/surface/adapter/mesh_ply.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <assimp/Importer.hpp>
#include <cstring>

#include "tests/services/surface/core/fused/clouds.h"

namespace thalweg::surface {
namespace {

/// A sphere in colors that depend on the place.
TriangleMesh ColoredSphere() {
  FusedSurface surface({.voxel_size = 0.05});
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(80, 80, 1.0);
  const RigidTransform T_WC = test::LookingAlong({-2.0, 0.0, 0.0}, 0.0, 0.0);
  PointCloud cloud = test::CloudOf(camera, T_WC, [](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
    return test::ToSphere({0.01, 0.02, 0.03}, 0.6, o, d);
  });
  for (std::size_t i = 0; i < cloud.points_C.size(); ++i) {
    cloud.colors.push_back(
        {static_cast<std::uint8_t>(i % 80 * 3), static_cast<std::uint8_t>(i / 80 * 3), 77});
  }
  SurfaceMesh mesh({});
  mesh.Update(surface.volume(), surface.Fuse(cloud, camera, T_WC));
  return mesh.Joined();
}

TEST(MeshPly, AnotherLibraryReadsVerticesNormalsColorsAndFaces) {
  const TriangleMesh mesh = ColoredSphere();
  ASSERT_GT(mesh.faces.size(), 500U);
  const std::string bytes = PlyOf(mesh);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, "ply");
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1U);
  const aiMesh& read = *scene->mMeshes[0];
  ASSERT_EQ(read.mNumVertices, mesh.vertices_W.size());
  ASSERT_EQ(read.mNumFaces, mesh.faces.size());
  ASSERT_TRUE(read.HasNormals());
  ASSERT_TRUE(read.HasVertexColors(0));
  for (unsigned i = 0; i < read.mNumVertices; ++i) {
    const aiVector3D& p = read.mVertices[i];
    const aiVector3D& n = read.mNormals[i];
    const aiColor4D& c = read.mColors[0][i];
    ASSERT_EQ(Eigen::Vector3f(p.x, p.y, p.z), mesh.vertices_W[i]);
    ASSERT_EQ(Eigen::Vector3f(n.x, n.y, n.z), mesh.normals_W[i]);
    EXPECT_NEAR(c.r * 255.0F, mesh.colors[i].r, 0.01);
    EXPECT_NEAR(c.g * 255.0F, mesh.colors[i].g, 0.01);
    EXPECT_NEAR(c.b * 255.0F, mesh.colors[i].b, 0.01);
  }
  for (unsigned i = 0; i < read.mNumFaces; ++i) {
    const aiFace& face = read.mFaces[i];
    ASSERT_EQ(face.mNumIndices, 3U);
    for (unsigned k = 0; k < 3; ++k) ASSERT_EQ(face.mIndices[k], mesh.faces[i][k]);
  }
}

TEST(MeshPly, AnEmptyMeshIsAFileWithoutElements) {
  const std::string bytes = PlyOf({});
  EXPECT_NE(bytes.find("element vertex 0\n"), std::string::npos);
  EXPECT_NE(bytes.find("element face 0\n"), std::string::npos);
  EXPECT_TRUE(bytes.ends_with("end_header\n"));
}

}  // namespace
}  // namespace thalweg::surface
