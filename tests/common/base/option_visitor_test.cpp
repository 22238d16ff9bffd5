#include "common/base/option_visitor.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/recording_visitor.h"

namespace thalweg {
namespace {

using std::chrono_literals::operator""ms;

enum class Color { kRed, kGreen };

struct Options {
  double length = 1.0;
  float weight = 0.5F;
  double angle = 0.3;
  Duration period = 200ms;
  std::size_t count = 7;
  bool on = false;
  std::string name = "a";
  Color color = Color::kRed;
  std::array<double, 3> place = {1, 2, 3};

  bool operator==(const Options&) const = default;
};

void Visit(OptionVisitor& visitor, Options& options) {
  visitor.Number("length_m", options.length);
  visitor.Number("weight", options.weight);
  visitor.Degrees("angle_deg", options.angle);
  visitor.Block("inner", [&](OptionVisitor& inner) {
    inner.Seconds("period_s", options.period);
    inner.Whole("count", options.count);
    inner.Switch("on", options.on);
  });
  visitor.Text("name", options.name);
  visitor.Choice("color", options.color, {{"RED", Color::kRed}, {"GREEN", Color::kGreen}});
  visitor.Vector("place_m", options.place);
}

TEST(OptionVisitor, LeavesWhatIsNotGivenAsItIsToTheLastBit) {
  Options options;
  options.angle = 0.1 + 0.2;  // a value that a conversion to degrees and back would change
  const Options before = options;
  test::RecordingVisitor visitor;
  Visit(visitor, options);
  EXPECT_EQ(options, before);
  EXPECT_EQ(visitor.fields().size(), 9U);
}

TEST(OptionVisitor, ConvertsTheUnitsOfFieldsIntoThoseOfOptions) {
  test::RecordingVisitor visitor;
  visitor.Give("length_m", 2.5);
  visitor.Give("weight", 0.25);
  visitor.Give("angle_deg", 90.0);
  visitor.Give("inner.period_s", 1.5);
  visitor.Give("inner.count", std::int64_t{9});
  visitor.Give("inner.on", true);
  visitor.Give("name", std::string("b"));
  visitor.Give("color", std::string("GREEN"));
  visitor.Give("place_m", std::array{4.0, 5.0, 6.0});
  Options options;
  Visit(visitor, options);
  EXPECT_EQ(options.length, 2.5);
  EXPECT_EQ(options.weight, 0.25F);
  EXPECT_DOUBLE_EQ(options.angle, std::numbers::pi / 2);
  EXPECT_EQ(options.period, 1500ms);
  EXPECT_EQ(options.count, 9U);
  EXPECT_TRUE(options.on);
  EXPECT_EQ(options.name, "b");
  EXPECT_EQ(options.color, Color::kGreen);
  EXPECT_EQ(options.place, (std::array{4.0, 5.0, 6.0}));
}

TEST(OptionVisitorDeathTest, ANameThatTheBindingLacksAborts) {
  test::RecordingVisitor visitor;
  visitor.Give("color", std::string("BLUE"));
  Options options;
  EXPECT_DEATH(Visit(visitor, options), "binding lacks");
}

}  // namespace
}  // namespace thalweg
