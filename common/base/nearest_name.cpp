#include "common/base/nearest_name.h"

#include <algorithm>
#include <numeric>

namespace thalweg {
namespace {

/// Number of letters to insert, remove or replace, or neighbors to swap, that turn one word into the other:
/// optimal string alignment [Damerau 1964].
std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1);  // distances of the beginning of a, two letters shorter
  std::vector<std::size_t> above(b.size() + 1);   // one letter shorter
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(above);
    above.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, above[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::string DidYouMean(const std::vector<std::string>& names, const std::string& name) {
  const auto nearest = std::ranges::min_element(
      names, {}, [&](const std::string& known) { return EditDistance(known, name); });
  const std::size_t most = std::max<std::size_t>(1, name.size() / 3);  // beyond this, it is a different word
  const bool near = nearest != names.end() && EditDistance(*nearest, name) <= most;
  return near ? "; did you mean " + *nearest + '?' : "";
}

}  // namespace thalweg
