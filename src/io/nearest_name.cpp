#include "io/nearest_name.hpp"

#include <algorithm>
#include <vector>

namespace gridlock {

namespace {

std::string folded(std::string_view word) {
  std::string result(word);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == '-') c = '_';
  }
  return result;
}

std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      std::size_t const substituted = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      current[j] = std::min({substituted, last[j] + 1, current[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        current[j] = std::min(current[j], before[j - 2] + 1);
      }
    }
    std::swap(before, last);
    std::swap(last, current);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view word, std::span<std::string const> names) {
  // A longer word is not a misspelled name, and the time for a distance grows with the product of the lengths.
  constexpr std::size_t longest_word = 64;
  if (word.size() > longest_word) return "";
  std::string const wanted = folded(word);
  std::string best;
  std::size_t least = std::max<std::size_t>(1, (wanted.size() + 1) / 3) + 1;
  for (std::string const& name : names) {
    std::size_t const d = distance(wanted, folded(name));
    // A word of one letter is at distance 1 from every letter, so the distance must be less than the word's length.
    if (d < least && d < wanted.size()) {
      least = d;
      best = name;
    }
  }
  if (!best.empty() || wanted.size() < 3) return best;
  auto const begins_alike = [&](std::string const& name) { return folded(name).starts_with(wanted); };
  if (std::ranges::count_if(names, begins_alike) == 1) best = *std::ranges::find_if(names, begins_alike);
  return best;
}

}  // namespace gridlock
