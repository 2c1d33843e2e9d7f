#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/field.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

struct FieldShape;

/// A deposit and a take of agents that take their turns at the same time; both are carried out after the turns.
struct Deposit {
  std::size_t cell = 0;
  double amount = 0.0;
};
struct Take {
  std::size_t cell = 0;
  double amount = 0.0;  ///< asked for; after resolve() the amount that the agent gets
  Id agent = 0;
  std::uint32_t row = 0;     ///< of the agent
  std::uint32_t column = 0;  ///< the column that gets the amount, its place among those of the agents
};

/// The changes that agents request of one field.
struct FieldRequests {
  std::vector<Deposit> deposits;
  std::vector<Take> takes;

  void append(FieldRequests const& part) {
    deposits.insert(deposits.end(), part.deposits.begin(), part.deposits.end());
    takes.insert(takes.end(), part.takes.begin(), part.takes.end());
  }
  void clear() {
    deposits.clear();
    takes.clear();
  }
};

/// A new value of a cell.
struct ChangedCell {
  std::size_t cell = 0;
  double value = 0.0;
};

/// Sets the amount of each take to that which the agent gets, and returns the new values of the cells; the field stays.
///
/// First agents take from the values before the step. Where a cell has too little for all, they take one after the
/// other, in an order that is drawn anew in each step; then all deposits are added. Sums are exact and rounded once, so
/// that the bits depend on the requests of each agent alone, not on the order in which agents took their turns.
/// Errors: RunFailure for a new value that is infinite or no number. Cost: about 100 ns a request.
/// Contract: the requests of one agent have the order in which it made them.
std::vector<ChangedCell> resolve(Field const& field, FieldRequests& requests, std::uint64_t seed, std::uint64_t step);

/// Return the new value of a cell at once, and take at most what is there. Errors: RunFailure for a new value that is
/// infinite or no number.
void deposit_now(Field& field, std::size_t cell, double amount, std::uint64_t step);
double take_now(Field& field, std::size_t cell, double amount);

/// Returns the cell around a point; beyond a periodic edge that around its image. Errors: RunFailure for a point beyond
/// a wall or one that is not finite.
std::size_t cell_around(Field const& field, Box const& box, Vector point, std::uint64_t step);

/// Throws RunFailure unless an amount to take is a number from 0 on.
void require_amount_to_take(Field const& field, double amount, std::uint64_t step, std::optional<Id> agent);

/// Throws RunFailure for a value that is infinite or no number.
void require_finite(Field const& field, std::uint64_t step);

/// Throws Error unless fields have these shapes and finite values.
void require_good_fields(std::span<Field const> fields, std::span<FieldShape const> shapes);

}  // namespace gridlock
