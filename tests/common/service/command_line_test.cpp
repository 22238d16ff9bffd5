#include "common/service/command_line.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

enum class Drink { kTea, kCoffee };
const NamedValues<Drink> kDrinks = {{"tea", Drink::kTea}, {"coffee", Drink::kCoffee}};

TEST(OneOf, TakesEachNameThatAValueHasAndNoOther) {
  Drink drink = Drink::kTea;
  CLI::App app;
  app.add_option("--drink", drink)->transform(OneOf(kDrinks));
  for (const Drink chosen : {Drink::kCoffee, Drink::kTea}) {
    app.parse("--drink " + NameAmong(kDrinks, chosen));
    EXPECT_EQ(drink, chosen);
  }
  EXPECT_THROW(app.parse("--drink milk"), CLI::ValidationError);
}

}  // namespace
}  // namespace thalweg
