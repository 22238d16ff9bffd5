#include "common/geometry/inspection_criterion.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(InspectionCriterion, AViewMayHaveNoSmallerCosineThanItsLargestAngle) {
  EXPECT_NEAR(InspectionCriterion{.max_angle = 60.0 * kDegree}.least_cosine(), 0.5, 1e-15);
}

}  // namespace
}  // namespace thalweg
