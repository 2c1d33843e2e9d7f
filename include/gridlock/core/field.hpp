#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// Numbers on a grid of equal cells over the box, which agents read and change: food, heat, a scent.
///
/// The cell in column c and row r covers the box from c / columns() to (c + 1) / columns() of its width, and likewise
/// of its height. Values are stored row by row from the bottom: that of the cell is values()[r * columns() + c].
/// Errors: Error for a grid without cells.
///
/// ```cpp
/// Box const box(2.0, 1.0, Edge::periodic);
/// Field scent("scent", 200, 100);
/// scent.values()[scent.cell_of(box, {1.0, 0.5})] += 3.0;
/// ```
class Field {
 public:
  Field(std::string name, std::size_t columns, std::size_t rows, double value = 0.0);

  [[nodiscard]] std::string const& name() const { return name_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] std::span<double> values() { return values_; }
  [[nodiscard]] std::span<double const> values() const { return values_; }

  /// Returns the index in values() of the cell around a point of the box.
  [[nodiscard]] std::size_t cell_of(Box const& box, Vector point) const;
  /// Returns the index of the first value that is infinite or no number; size() if there is none.
  [[nodiscard]] std::size_t find_not_finite() const;
  /// Serializes the values. Errors: Error unless the restored ones are as many.
  void serialize(Archive& archive);
  /// Moves the values to other memory and returns the old memory, which keeps its values, for arrays that refer to it.
  [[nodiscard]] LargeArray<double> release();

  friend bool operator==(Field const&, Field const&) = default;

 private:
  std::string name_;
  std::size_t columns_;
  std::size_t rows_;
  LargeArray<double> values_;
};

/// Returns the state hash of a world with fields from that without them; the same if there are none.
std::uint64_t hash_with_fields(std::uint64_t hash_without, std::span<Field const> fields);

}  // namespace gridlock
