// Compares the run times of our matchers and OpenCV's on the same images, window and range, one thread each.
// They alternate, so that other load on the machine affects both; prints minimum and median times and their
// ratios.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/stopwatch.h"
#include "services/stereo/core/opencv_matchers.h"
#include "services/stereo/core/opencv_view.h"
#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

struct Times {
  std::vector<double> ms;
  double Least() const { return *std::min_element(ms.begin(), ms.end()); }
  double Median() const {
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// Runs all in turn; the first round does not count.
std::vector<Times> Race(const std::vector<std::function<void()>>& runners, int rounds) {
  std::vector<Times> times(runners.size());
  for (int round = 0; round <= rounds; ++round) {
    for (std::size_t i = 0; i < runners.size(); ++i) {
      const Stopwatch stopwatch;
      runners[i]();
      if (round > 0) times[i].ms.push_back(stopwatch.Milliseconds());
    }
  }
  return times;
}

void PrintRatio(const char* name, const Times& ours, const Times& peer) {
  std::printf("  %-34s least %.2f, median %.2f\n", name, ours.Least() / peer.Least(),
              ours.Median() / peer.Median());
}

void RaceAt(int width, int height, int max_disparity, int rounds) {
  const test::Pair pair = test::PlanePair(width, height, 0.05, 0.02, 6.0, 1);
  const cv::Mat left = ViewOf(pair.left);
  const cv::Mat right = ViewOf(pair.right);
  MatcherOptions options;
  options.max_disparity = max_disparity;
  options.threads = 1;
  const auto sad5 = MakeMatcher("sad5-dog", options);
  const auto best = MakeMatcher("best", options);
  options.threads = 2;
  const auto sad5_on_two = MakeMatcher("sad5-dog", options);
  const auto best_on_two = MakeMatcher("best", options);
  // Direct calls of OpenCV with its usual parameters and checks.
  const auto bm = UsualBlockMatcher(max_disparity);
  const auto sgbm = UsualSemiGlobalMatcher(max_disparity);
  cv::Mat out;
  const std::vector<Times> times =
      Race({[&] { bm->compute(left, right, out); }, [&] { sgbm->compute(left, right, out); },
            [&] { sad5->Match(pair.left, pair.right); }, [&] { best->Match(pair.left, pair.right); },
            [&] { sad5_on_two->Match(pair.left, pair.right); },
            [&] { best_on_two->Match(pair.left, pair.right); }},
           rounds);
  const char* const names[] = {"opencv-bm", "opencv-sgbm",           "sad5-dog",
                               "best",      "sad5-dog, two threads", "best, two threads"};
  std::printf("%d x %d x %d\n", width, height, max_disparity);
  for (std::size_t i = 0; i < times.size(); ++i) {
    std::printf("  %-22s least %7.2f ms, median %7.2f ms, %6.1f pairs/s\n", names[i], times[i].Least(),
                times[i].Median(), 1e3 / times[i].Median());
  }
  PrintRatio("sad5-dog / opencv-bm (goal <= 3)", times[2], times[0]);
  PrintRatio("best / opencv-sgbm (goal <= 2)", times[3], times[1]);
}

}  // namespace
}  // namespace thalweg::stereo

int main(int argc, char** argv) {
  int rounds = 15;
  CLI::App app("Matchers beside OpenCV's");
  app.add_option("--rounds", rounds, "Turns of each")->check(CLI::PositiveNumber)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  thalweg::stereo::RaceAt(512, 384, 64, rounds);
  thalweg::stereo::RaceAt(1024, 768, 64, rounds);
  return 0;
}
