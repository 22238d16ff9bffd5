#include <benchmark/benchmark.h>

#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/core/depth_sensor.h"
#include "services/simulator/core/robot.h"
#include "services/simulator/core/stereo_rig.h"
#include "services/simulator/core/truth.h"
#include "tests/support/places.h"

namespace thalweg::simulator {
namespace {

struct Kitchen {
  Scenario scenario = LoadScenario(test::SourceFolder() + "/deploy/scenarios/kitchen.txtpb");
  World world = LoadWorld(scenario);
  RigidTransform T_WB = StartFrom(scenario, world, {});
};

/// The view from the start, rotated a little farther in each step.
RigidTransform TurnedCamera(const Kitchen& kitchen, int step) {
  RigidTransform T_WC = kitchen.T_WB;
  T_WC.linear() = RotationFromYawPitch(0.3 * step, 0.0) * BodyFromOptical();
  return T_WC;
}

void DepthCapture(benchmark::State& state) {
  const Kitchen kitchen;
  DepthSensor sensor({});
  int step = 0;
  for (auto _ : state) benchmark::DoNotOptimize(sensor.Capture(kitchen.world, TurnedCamera(kitchen, step++)));
}
BENCHMARK(DepthCapture)->Unit(benchmark::kMillisecond);

void StereoCapture(benchmark::State& state) {
  const Kitchen kitchen;
  StereoRig rig({});
  int step = 0;
  for (auto _ : state) benchmark::DoNotOptimize(rig.Capture(kitchen.world, TurnedCamera(kitchen, step++)));
}
BENCHMARK(StereoCapture)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

/// @param state  Its range is the cylinder's height in mm; 0 = a sphere.
void RobotStep(benchmark::State& state) {
  const Kitchen kitchen;
  SimulatedRobot robot(kitchen.world, {.height = 1e-3 * static_cast<double>(state.range(0))}, kitchen.T_WB);
  RigidTransform target = kitchen.T_WB;
  int step = 0;
  for (auto _ : state) {
    target.translation().x() = kitchen.T_WB.translation().x() + (step++ / 50 % 2 == 0 ? 0.3 : -0.3);
    robot.Command(target);
    robot.Step(0.02);
  }
}
BENCHMARK(RobotStep)->Arg(0)->Arg(400)->Unit(benchmark::kMicrosecond);

void Truth(benchmark::State& state) {
  const Kitchen kitchen;
  for (auto _ : state) benchmark::DoNotOptimize(TrueMap(kitchen.world, kitchen.T_WB.translation(), {}));
}
BENCHMARK(Truth)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

}  // namespace
}  // namespace thalweg::simulator
