#pragma once

#include <cstddef>
#include <vector>

#include "services/explorer/core/gaps/visibility.h"

namespace thalweg::explorer::test {

inline std::vector<std::size_t> VerticesOf(const std::vector<Gap>& gaps) {
  std::vector<std::size_t> vertices;
  for (const Gap& gap : gaps) vertices.push_back(gap.vertex);
  return vertices;
}

}  // namespace thalweg::explorer::test
