#include "common/base/environment.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(Environment, IsEmptyForAVariableThatIsNotSet) {
  constexpr auto kName = "THALWEG_ENVIRONMENT_TEST";
  setenv(kName, "a value", 1);
  EXPECT_EQ(Environment(kName), "a value");
  unsetenv(kName);
  EXPECT_EQ(Environment(kName), "");
}

}  // namespace
}  // namespace thalweg
