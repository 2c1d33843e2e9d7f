#include "gridlock/model/fields.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <tuple>

#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/model/detail/checks.hpp"

namespace gridlock {

namespace {

void require_finite_value(Field const& field, std::size_t cell, double value, std::uint64_t step) {
  if (std::isfinite(value)) return;
  throw RunFailure(
      fmt::format("step {}: the field {} has the value {} in row {}, column {}\n  hint: this is a mistake of the "
                  "model: its numbers overflow, or are none",
                  step, field.name(), gridlock::in_words(value), cell / field.columns(), cell % field.columns()));
}

/// Agents that take from one cell, `value` in all.
struct Rivals {
  double value;
  std::uint64_t seed;
  std::uint64_t step;

  /// Sets what each of some takes gets, and returns what is left.
  double share(std::span<Take> takes, std::span<std::uint32_t const> places) const {
    ExactSum demand;
    ExactSum left;
    left.add(value);
    for (std::uint32_t const place : places) {
      demand.add(takes[place].amount);
      left.add(-takes[place].amount);
    }
    if (demand.value() <= value) return std::max(left.value(), 0.0);
    return take_in_turn(takes, places);
  }

 private:
  double take_in_turn(std::span<Take> takes, std::span<std::uint32_t const> places) const {
    std::vector<std::tuple<double, Id, std::uint32_t>> order;
    for (std::uint32_t const place : places) {
      RandomStream random(seed, step, takes[place].agent, Purpose::model_take);
      order.emplace_back(random.uniform(), takes[place].agent, place);
    }
    std::ranges::sort(order);
    double left = value;
    for (auto const& [chance, agent, place] : order) {
      double& amount = takes[place].amount;
      amount = std::min(std::max(left, 0.0), amount);
      left -= amount;
    }
    return left;
  }
};

double sum_of(double value, std::span<Deposit const> deposits, std::span<std::uint32_t const> places,
              std::size_t first_place) {
  if (places.size() == 1) return value + deposits[places.front() - first_place].amount;
  ExactSum sum;
  sum.add(value);
  for (std::uint32_t const place : places) sum.add(deposits[place - first_place].amount);
  return sum.value();
}

}  // namespace

std::vector<ChangedCell> resolve(Field const& field, FieldRequests& requests, std::uint64_t seed, std::uint64_t step) {
  std::size_t const takes = requests.takes.size();
  std::vector<std::uint64_t> cells;
  cells.reserve(takes + requests.deposits.size());
  for (Take const& take : requests.takes) cells.push_back(take.cell);
  for (Deposit const& deposit : requests.deposits) cells.push_back(deposit.cell);
  // Takes come before deposits in each cell, since the order keeps that of equal cells.
  std::vector<std::uint32_t> const places = rows_in_order(cells);
  std::vector<ChangedCell> changes;
  for (std::size_t first = 0; first < places.size();) {
    auto const cell = static_cast<std::size_t>(cells[places[first]]);
    std::size_t middle = first;
    while (middle < places.size() && cells[places[middle]] == cell && places[middle] < takes) ++middle;
    std::size_t end = middle;
    while (end < places.size() && cells[places[end]] == cell) ++end;
    std::span<std::uint32_t const> const all(places);
    double value = field.values()[cell];
    if (middle > first) {
      Rivals const rivals{.value = value, .seed = seed, .step = step};
      value = rivals.share(requests.takes, all.subspan(first, middle - first));
    }
    if (end > middle) value = sum_of(value, requests.deposits, all.subspan(middle, end - middle), takes);
    require_finite_value(field, cell, value, step);
    changes.push_back({cell, value});
    first = end;
  }
  return changes;
}

void deposit_now(Field& field, std::size_t cell, double amount, std::uint64_t step) {
  double const sum = field.values()[cell] + amount;
  require_finite_value(field, cell, sum, step);
  field.values()[cell] = sum;
}

double take_now(Field& field, std::size_t cell, double amount) {
  double& left = field.values()[cell];
  double const taken = std::min(std::max(left, 0.0), amount);
  left -= taken;
  return taken;
}

std::size_t cell_around(Field const& field, Box const& box, Vector point, std::uint64_t step) {
  Vector const place = is_finite(point) && !is_inside(box, point) ? box.inside(point) : point;
  if (is_inside(box, place)) return field.cell_of(box, place);
  throw RunFailure(
      fmt::format("step {}: the model asks for the field {} at ({}, {}), outside the box of {} × {}\n  hint: this is a "
                  "mistake of the model: a field has values in the box only",
                  step, field.name(), in_words(point.x), in_words(point.y), box.width(), box.height()));
}

void require_amount_to_take(Field const& field, double amount, std::uint64_t step, std::optional<Id> agent) {
  if (amount >= 0.0) return;
  throw RunFailure(
      fmt::format("step {}: {} is to take {} from the field {}\n  hint: this is a mistake of the model: amounts are "
                  "numbers from 0 on; deposit() gives",
                  step, agent ? fmt::format("agent {}", *agent) : "the model", in_words(amount), field.name()));
}

void require_finite(Field const& field, std::uint64_t step) {
  std::size_t const cell = field.find_not_finite();
  if (cell < field.size()) require_finite_value(field, cell, field.values()[cell], step);
}

Vector centre_of_cell(Field const& field, Box const& box, std::size_t cell) {
  auto const middle = [](std::size_t place, double side, std::size_t cells) {
    return (static_cast<double>(place) + 0.5) * (side / static_cast<double>(cells));
  };
  return {middle(cell % field.columns(), box.width(), field.columns()),
          middle(cell / field.columns(), box.height(), field.rows())};
}

std::size_t rows_of_squares(Box const& box, std::size_t columns) {
  double const rows = std::nearbyint(static_cast<double>(columns) * box.height() / box.width());
  return static_cast<std::size_t>(std::clamp(rows, 1.0, 0x1p60));
}

void require_good_fields(std::span<Field const> fields, std::span<FieldShape const> shapes) {
  bool is_good = fields.size() == shapes.size();
  for (std::size_t k = 0; is_good && k < fields.size(); ++k) {
    is_good = fields[k].name() == shapes[k].name && fields[k].columns() == shapes[k].columns &&
              fields[k].rows() == shapes[k].rows;
  }
  if (!is_good) {
    throw Error(Problem{.what = "a world has other fields than its model",
                        .hint = "start_agents() makes those of the model",
                        .key = "model.kind"});
  }
  for (Field const& field : fields) require_finite(field, 0);
}

}  // namespace gridlock
