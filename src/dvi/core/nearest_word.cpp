#include "dvi/core/nearest_word.h"

#include <algorithm>
#include <numeric>

namespace dvi {
namespace {

// Computes the optimal string alignment distance.
std::size_t count_typing_errors(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = last;
    last = row;
  }
  return last.back();
}

}  // namespace

std::string nearest_word(const std::string& typed, const std::vector<std::string>& words) {
  constexpr std::size_t kMinPrefix = 3;  // letters that identify a word
  std::string best;
  std::size_t fewest = (typed.size() + 2) / 3 + 1;
  for (const std::string& word : words) {
    if (typed.size() >= kMinPrefix && word.starts_with(typed)) return word;
    const std::size_t errors = count_typing_errors(typed, word);
    if (errors < fewest) fewest = errors, best = word;
  }
  return best;
}

}  // namespace dvi
