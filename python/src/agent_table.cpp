#include "agent_table.hpp"

#include <algorithm>
#include <type_traits>

#include "column_lender.hpp"

namespace gridlock::python {

namespace {

/// Returns the values of these rows, in their order.
template <class Values>
Values gathered(Values const& values, std::span<std::uint32_t const> rows) {
  Values ordered(rows.size());
  std::ranges::transform(rows, ordered.begin(), [&](std::uint32_t row) { return values[row]; });
  return ordered;
}

}  // namespace

void AgentTable::add(std::span<double const> x, std::span<double const> y, std::vector<ColumnValues> const& others) {
  for (std::size_t k = 0; k < x.size(); ++k) places_.add(x[k], y[k]);
  for (std::size_t k = 0; k < others_.size(); ++k) {
    std::visit(
        [&](auto& values) {
          auto const& more = std::get<std::remove_reference_t<decltype(values)>>(others[k]);
          values.insert(values.end(), more.begin(), more.end());
        },
        others_[k].values);
  }
}

void AgentTable::remove(std::span<Id const> ids) {
  for (Id const id : ids) {
    std::size_t const row = places_.index_of(id);
    places_.remove(id);
    // The last row moves into the row of the removed agent.
    for (TableColumn& column : others_) {
      std::visit(
          [&](auto& values) {
            values[row] = values.back();
            values.pop_back();
          },
          column.values);
    }
  }
}

void AgentTable::reorder(std::span<std::uint32_t const> rows) {
  LargeArray<Id> ids(rows.size());
  Population<X, Y>::AllValues values;
  values.resize(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ids[k] = places_.ids()[rows[k]];
    values.copy(k, places_.values(), rows[k]);
  }
  places_.reorder(ids, values);
  places_.find_again(0, rows.size());
  for (TableColumn& column : others_) {
    std::visit([&](auto& all) { all = gathered(all, rows); }, column.values);
  }
}

void AgentTable::take_values(AgentTable const& table) {
  std::ranges::copy(table.x(), x().begin());
  std::ranges::copy(table.y(), y().begin());
  for (std::size_t k = 0; k < others_.size(); ++k) {
    std::visit(
        [&](auto& values) {
          auto const& others = std::get<std::remove_reference_t<decltype(values)>>(table.others_[k].values);
          std::ranges::copy(others, values.begin());
        },
        others_[k].values);
  }
}

AgentsView AgentTable::view() const {
  std::vector<std::pair<std::string_view, AgentsView::Values>> columns{{X::name, x()}, {Y::name, y()}};
  for (TableColumn const& column : others_) {
    std::visit([&](auto const& values) { columns.emplace_back(column.name, std::span(values)); }, column.values);
  }
  return {ids(), std::move(columns)};
}

std::vector<NamedColumn> AgentTable::columns() {
  std::vector<NamedColumn> columns{{X::name, x()}, {Y::name, y()}};
  for (TableColumn& column : others_) {
    std::visit([&](auto& values) { columns.push_back({column.name, std::span(values)}); }, column.values);
  }
  return columns;
}

std::uint64_t AgentTable::sum_of_hashes() const {
  std::uint64_t sum = 0;
  std::vector<std::uint64_t> record(3 + others_.size());
  for (std::size_t row = 0; row < size(); ++row) {
    record[0] = ids()[row];
    record[1] = word_of(x()[row]);
    record[2] = word_of(y()[row]);
    for (std::size_t k = 0; k < others_.size(); ++k) {
      record[3 + k] = std::visit([&](auto const& values) { return word_of(values[row]); }, others_[k].values);
    }
    sum += hash_words(record);
  }
  return sum;
}

void AgentTable::serialize(Archive& archive) {
  places_.serialize(archive);
  serialize_inside(archive, "columns", [&] {
    for (TableColumn& column : others_) {
      std::visit(
          [&](auto& values) {
            std::vector<typename std::remove_reference_t<decltype(values)>::value_type> plain(values.begin(),
                                                                                              values.end());
            archive.visit(column.name, plain);
            archive.require(plain.size() == size(), "the columns of the agents differ in length");
            if (archive.is_restoring()) values.assign(plain.begin(), plain.end());
          },
          column.values);
    }
  });
}

void AgentTable::put_vectors_side_by_side() {
  if (!has_vectors_side_by_side(columns())) static_cast<void>(release());
}

std::shared_ptr<void> AgentTable::release() {
  std::size_t room = 0;
  for (TableColumn const& column : others_) {
    room += std::visit([](auto const& values) { return SideBySide::room_for(values.size() * sizeof(values[0])); },
                       column.values);
  }
  SideBySide const scope(room);
  auto old = std::make_shared<std::pair<std::shared_ptr<void>, std::vector<TableColumn>>>(places_.release(), others_);
  std::swap(old->second, others_);
  return old;
}

}  // namespace gridlock::python
