#include "gridlock/core/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "core/copy_if_finite.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

namespace {

/// Returns a number whose last bit is set for infinities and NaN: their exponents are all ones.
std::uint64_t mark_of_not_finite(double value) {
  constexpr std::uint64_t exponent = 0x7FF0000000000000;
  constexpr std::uint64_t one = 0x0010000000000000;
  return (std::bit_cast<std::uint64_t>(value) & exponent) + one;
}

}  // namespace

bool copy_if_finite(std::span<double const> from, std::span<double> to) {
  std::uint64_t bits = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    to[k] = from[k];
    bits |= mark_of_not_finite(from[k]);
  }
  return bits >> 63U == 0;
}

std::size_t find_not_finite(std::span<double const> values) {
  // Nearly always all values are finite, and this loop, unlike a search, takes registers.
  std::uint64_t bits = 0;
  for (double const value : values) bits |= mark_of_not_finite(value);
  if (bits >> 63U == 0) return values.size();
  auto const found = std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
  return static_cast<std::size_t>(found - values.begin());
}

Field::Field(std::string name, std::size_t columns, std::size_t rows, double value)
    : name_(std::move(name)), columns_(columns), rows_(rows) {
  constexpr std::size_t max_cells = std::size_t{1} << 30;
  if (columns == 0 || rows == 0 || columns > max_cells || rows > max_cells / columns) {
    throw Error({.what = fmt::format("the field {} has {} × {} cells", name_, columns, rows),
                 .hint = "use 1 to 1073741824 cells in all"});
  }
  values_.assign(columns * rows, value);
}

std::size_t Field::cell_of(Box const& box, Vector point) const {
  auto const along = [](double place, double side, std::size_t cells) {
    auto const cell = static_cast<std::size_t>(place / side * static_cast<double>(cells));
    return std::min(cell, cells - 1);
  };
  return along(point.y, box.height(), rows_) * columns_ + along(point.x, box.width(), columns_);
}

std::size_t Field::find_not_finite() const { return gridlock::find_not_finite(values_); }

void Field::serialize(Archive& archive) {
  std::vector<double> plain(values_.begin(), values_.end());
  archive.visit(name_, plain);
  archive.require(plain.size() == values_.size(), "a field has another number of cells");
  if (archive.is_restoring()) values_.assign(plain.begin(), plain.end());
}

LargeArray<double> Field::release() {
  LargeArray<double> copy = values_;
  std::swap(copy, values_);
  return copy;
}

std::uint64_t hash_with_fields(std::uint64_t hash_without, std::span<Field const> fields) {
  if (fields.empty()) return hash_without;
  std::vector<std::uint64_t> record{hash_without};
  std::vector<std::uint64_t> words;
  for (Field const& field : fields) {
    words.clear();
    words.reserve(field.size());
    for (double const value : field.values()) words.push_back(word_of(value));
    record.insert(record.end(), {field.columns(), field.rows(), hash_words(words)});
  }
  return hash_words(record);
}

}  // namespace gridlock
