#include "services/simulator/adapter/load_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "common/scenario/models.h"
#include "tests/support/places.h"

namespace thalweg::simulator {
namespace {

using testing::HasSubstr;

/// A folder of its own for the files of one test.
class LoadMesh : public testing::Test {
 protected:
  LoadMesh() { std::filesystem::create_directories(folder_); }
  ~LoadMesh() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::string ErrorOf(const std::filesystem::path& file) const {
    try {
      LoadObj(file, UpAxis::kZ, 1.0);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  (std::string("thalweg_load_mesh_") + std::to_string(getpid()) + "_" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

constexpr auto kTriangle = "v 1 2 3\nv 4 5 6\nv 7 8 10\nf 1 2 3\n";

TEST_F(LoadMesh, KeepsZUpAndTurnsYUpByAProperRotation) {
  const auto file = Write("a.obj", kTriangle);
  const Mesh z_up = LoadObj(file, UpAxis::kZ, 1.0).mesh;
  EXPECT_EQ(z_up.vertices[0], Eigen::Vector3f(1, 2, 3));
  const Mesh y_up = LoadObj(file, UpAxis::kY, 0.5).mesh;
  EXPECT_EQ(y_up.vertices[0], Eigen::Vector3f(0.5F, -1.5F, 1.0F));
  // The signed volume spanned by the three corners keeps its sign: nothing is mirrored.
  const auto volume = [](const Mesh& mesh) {
    return mesh.vertices[0].dot(mesh.vertices[1].cross(mesh.vertices[2]));
  };
  EXPECT_NEAR(volume(y_up), 0.125F * volume(z_up), 1e-5F);
}

TEST_F(LoadMesh, SplitsPolygonsIntoTrianglesOfTheSameArea) {
  // An L of area 3, and a square whose corners are given by negative indices.
  const auto file = Write("a.obj",
                          "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n"
                          "v 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\nf -4 -3 -2 -1\n");
  const Mesh mesh = LoadObj(file, UpAxis::kZ, 1.0).mesh;
  float area = 0.0F;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f ab = mesh.vertices[b] - mesh.vertices[a];
    const Eigen::Vector3f ac = mesh.vertices[c] - mesh.vertices[a];
    area += 0.5F * ab.cross(ac).norm();
  }
  EXPECT_EQ(mesh.triangles.size(), 6U);
  EXPECT_NEAR(area, 4.0F, 1e-5F);
}

TEST_F(LoadMesh, ReadsMaterialsAndTexturesWithBackslashesInTheirPaths) {
  std::filesystem::create_directories(folder_ / "images");
  cv::imwrite((folder_ / "images" / "red.png").string(), cv::Mat(2, 4, CV_8UC3, cv::Scalar(0, 0, 250)));
  Write("a.mtl", "newmtl plain\nKd 1 0.5 0\nnewmtl image\nKd 1 1 1\nmap_Kd images\\red.png\n");
  const auto file = Write("a.obj",
                          "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                          "usemtl plain\nf 1 2 3\nusemtl image\nf 1/1 2/2 3/3\n");
  const LoadedMesh loaded = LoadObj(file, UpAxis::kZ, 1.0);
  EXPECT_THAT(loaded.warnings, testing::IsEmpty());
  const Mesh& mesh = loaded.mesh;
  ASSERT_EQ(mesh.material_table.size(), 2U);
  EXPECT_EQ(mesh.material_table[0].diffuse, (Rgb{255, 128, 0}));
  EXPECT_EQ(mesh.material_table[0].texture, -1);
  ASSERT_EQ(mesh.textures.size(), 1U);
  EXPECT_EQ(mesh.textures[0].width_px, 4);
  EXPECT_EQ(mesh.textures[0].height_px, 2);
  EXPECT_EQ(mesh.textures[0].pixels[0], (Rgb{250, 0, 0}));
  EXPECT_EQ(mesh.materials, (std::vector<int>{0, 1}));
  EXPECT_EQ(mesh.uvs[1][1], Eigen::Vector2f(1, 0));
}

TEST_F(LoadMesh, AMissingTextureOrMaterialFileIsAWarning) {
  Write("a.mtl", "newmtl image\nmap_Kd nowhere.png\n");
  const auto file = Write("a.obj", "mtllib a.mtl\nusemtl image\n" + std::string(kTriangle));
  EXPECT_THAT(LoadObj(file, UpAxis::kZ, 1.0).warnings, testing::ElementsAre(HasSubstr("nowhere.png")));
  const auto other = Write("b.obj", "mtllib nowhere.mtl\nusemtl image\n" + std::string(kTriangle));
  EXPECT_THAT(LoadObj(other, UpAxis::kZ, 1.0).warnings, testing::ElementsAre(HasSubstr("nowhere.mtl")));
}

TEST_F(LoadMesh, AMissingFileIsNamed) {
  EXPECT_THAT(ErrorOf(folder_ / "none.obj"), HasSubstr("none.obj"));
}

TEST_F(LoadMesh, AFaceWithACornerThatIsNotThereIsNamedWithItsLine) {
  EXPECT_THAT(ErrorOf(Write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n# more\nf 1 2 4\n")), HasSubstr("a.obj:5:"));
  EXPECT_THAT(ErrorOf(Write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n")), HasSubstr("b.obj:4:"));
  EXPECT_THAT(ErrorOf(Write("c.obj", "v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n")), HasSubstr("c.obj:3:"));
  EXPECT_THAT(ErrorOf(Write("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf one two three\n")), HasSubstr("d.obj:4:"));
  EXPECT_THAT(ErrorOf(Write("e.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n")), HasSubstr("e.obj:3:"));
  for (const char* index : {"99999999999999999999", "-99999999999999999999"}) {
    EXPECT_THAT(ErrorOf(Write("f.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 ") + index + "\n")),
                HasSubstr("f.obj:4:"));
  }
}

TEST_F(LoadMesh, AVertexThatIsNoPlaceIsNamedWithItsLineAndWhatIsWrong) {
  const auto error_of = [this](const std::string& vertex) {
    return ErrorOf(Write("a.obj", "v 0 0 0\nv 1 0 0\n" + vertex + "\nf 1 2 3\n"));
  };
  for (const char* number : {"nan", "NaN", "-nan", "inf", "-INF", "1e999", "x", "1.2.3", "0,5"}) {
    for (const int axis : {0, 1, 2}) {
      std::string vertex = "v";
      for (int k = 0; k < 3; ++k) vertex += k == axis ? std::string(" ") + number : " 0.5";
      EXPECT_THAT(error_of(vertex), testing::AllOf(HasSubstr("a.obj:3: the vertex's "),
                                                   HasSubstr(std::string("xyz").substr(axis, 1) + " is '" +
                                                             number + "', must be a finite number")));
    }
  }
  EXPECT_THAT(error_of("v 0 1"), HasSubstr("a.obj:3: the vertex has 2 coordinates, must have 3"));
  EXPECT_THAT(error_of("v 0 2e5 0"), HasSubstr("a.obj:3: the vertex's y is '2e5', with world.scale 1 more"));
  EXPECT_THAT(error_of("v 0 9e4 -1e-3 0.5 0.5 0.5\r"), HasSubstr("no error"));  // with a color
}

TEST_F(LoadMesh, AFarVertexIsJudgedInMeters) {
  const auto file = Write("a.obj", "v 0 0 0\nv 2e5 0 0\nv 0 2e5 0\nf 1 2 3\n");  // in millimeters
  EXPECT_EQ(LoadObj(file, UpAxis::kZ, 0.001).mesh.triangles.size(), 1U);
  EXPECT_THROW(LoadObj(file, UpAxis::kZ, 1.0), std::runtime_error);
}

TEST_F(LoadMesh, AFileWithoutFacesOrWithBrokenNumbersIsRefused) {
  EXPECT_THAT(ErrorOf(Write("a.obj", "v 0 0 0\n")), HasSubstr("no faces"));
  EXPECT_THAT(ErrorOf(Write("b.obj", "v 0 0 0\nv 1e99 0 0\nv 0 1 0\nf 1 2 3\n")), HasSubstr("b.obj"));
}

struct RealScene {
  const char* file;
  UpAxis up_axis;
  double scale;
  std::size_t triangles;
  Eigen::Vector3d size;  ///< [m] as given in its SOURCE.md, in our axes.
};

class RealScenes : public testing::TestWithParam<RealScene> {};

TEST_P(RealScenes, HaveTheTrianglesAndTheExtentThatTheirSourceStates) {
  const char* const data = std::getenv("THALWEG_DATA");
  if (data == nullptr) GTEST_SKIP() << "THALWEG_DATA does not name the folder of real data";
  const RealScene& scene = GetParam();
  const Mesh mesh =
      LoadObj(std::filesystem::path(data) / "scenes" / scene.file, scene.up_axis, scene.scale).mesh;
  EXPECT_EQ(mesh.triangles.size(), scene.triangles);
  Eigen::AlignedBox3d extent;
  for (const Eigen::Vector3f& vertex : mesh.vertices) extent.extend(vertex.cast<double>());
  EXPECT_LT((extent.sizes() - scene.size).norm(), 0.03) << extent.sizes().transpose();
}

INSTANTIATE_TEST_SUITE_P(
    LoadMesh, RealScenes,
    testing::Values(RealScene{"living_room/living_room.obj", UpAxis::kY, 1.0, 28650, {9.33, 9.70, 7.16}},
                    RealScene{"apartment/apartment.obj", UpAxis::kY, 1.0, 12154, {7.16, 14.27, 2.77}},
                    RealScene{"cornell_box/cornell_box.obj", UpAxis::kY, 0.01, 36, {5.56, 5.59, 5.49}},
                    RealScene{"t_scene/t_scene.obj", UpAxis::kY, 1.0, 1094, {14.0, 14.0, 3.85}}));

class ShippedScenarios : public testing::TestWithParam<const char*> {};

TEST_P(ShippedScenarios, StartInTheOpenWithinTheirBounds) {
  if (GetParam() == std::string("living_room") && std::getenv("THALWEG_DATA") == nullptr) {
    GTEST_SKIP() << "THALWEG_DATA does not name the folder of real data";
  }
  const Scenario scenario = LoadScenario(test::SourceFolder() + "/deploy/scenarios/" + GetParam() + ".txtpb");
  const World world = LoadWorld(scenario);
  const RigidTransform start = StartFrom(scenario, world, {});
  EXPECT_TRUE(world.bounds().contains(start.translation()));
  EXPECT_GE(world.DistanceToSurface(start.translation(), 1.0), 0.3);
}

TEST_P(ShippedScenarios, AStartSeedPicksAnotherStart) {
  if (GetParam() == std::string("living_room") && std::getenv("THALWEG_DATA") == nullptr) {
    GTEST_SKIP() << "THALWEG_DATA does not name the folder of real data";
  }
  const std::string file = test::SourceFolder() + "/deploy/scenarios/" + GetParam() + ".txtpb";
  const Scenario seeded = LoadScenario(file, {"simulator.start_seed=7"});
  const World world = LoadWorld(seeded);
  const RigidTransform start = StartFrom(seeded, world, {});
  EXPECT_GE(world.DistanceToSurface(start.translation(), 1.0), 0.3);
  EXPECT_FALSE(start.isApprox(StartFrom(LoadScenario(file), world, {})));
}

INSTANTIATE_TEST_SUITE_P(LoadMesh, ShippedScenarios,
                         testing::Values("car", "gallery", "kitchen", "hall", "flat", "flat_doors", "garage",
                                         "office", "maze", "bridge", "comb", "open_hall", "shaft", "tiny",
                                         "living_room"));

TEST_F(LoadMesh, ARobotThatDrivesStartsInItsPlaneAVoxelAboveTheFloor) {
  const std::string file = test::SourceFolder() + "/deploy/scenarios/flat_ground.txtpb";
  const Scenario scenario = LoadScenario(file);
  const World world = LoadWorld(scenario);
  const RobotModel robot = RobotFrom(scenario);
  ASSERT_TRUE(robot.drives);
  const Eigen::Vector3d start = StartFrom(scenario, world, robot).translation();
  EXPECT_GE(world.ClearanceOf(robot, start, 1.0), 0.1);
  for (const Eigen::Vector3d& place : StartPlacesFrom(scenario, world, robot)) {
    ASSERT_EQ(place.z(), start.z());
    ASSERT_GE(world.ClearanceOf(robot, place, 1.0), 0.1);
  }
  EXPECT_THROW(StartFrom(LoadScenario(file, {"robot.height_m=0.7"}), world,
                         RobotFrom(LoadScenario(file, {"robot.height_m=0.7"}))),
               std::invalid_argument)
      << "it would reach into the floor";
}

TEST_F(LoadMesh, AStartInsideAWallIsRefusedByItsField) {
  const std::string file = test::SourceFolder() + "/deploy/scenarios/tiny.txtpb";
  const Scenario scenario = LoadScenario(file, {"simulator.start_position_m.x=0.05"});
  const World world = LoadWorld(scenario);
  try {
    StartFrom(scenario, world, {});
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("simulator.start_position_m"));
  }
}

TEST_F(LoadMesh, AWorldInMillimetersIsRefusedByItsSize) {
  const std::string file = test::SourceFolder() + "/deploy/scenarios/tiny.txtpb";
  Scenario scenario = LoadScenario(file, {"world.scale=1000"});
  scenario.mutable_world()->clear_bounds_min_m();
  scenario.mutable_world()->clear_bounds_max_m();
  const World world = LoadWorld(scenario);
  EXPECT_THAT(DescriptionOf(scenario, world), HasSubstr("world tiny.obj: 3400 x 2900 x 2000 m, "));
  const auto error_with = [&](double voxel_size) {
    try {
      CheckExtent(world, voxel_size);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(error_with(0.1), HasSubstr("world.scale"));
  EXPECT_THAT(error_with(0.1), HasSubstr("3400 x 2900 x 2000 m"));
  EXPECT_EQ(error_with(10.0), "");
  EXPECT_THROW(StartPlacesFrom(scenario, world, {}), std::invalid_argument);
}

TEST_F(LoadMesh, AScenarioWithoutAWorldIsRefused) {
  EXPECT_THROW(LoadWorld(Scenario()), std::runtime_error);
}

}  // namespace
}  // namespace thalweg::simulator
