#include "agent_table.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "column_lender.hpp"

namespace gridlock::python {

namespace {

/// Returns the values for which `keep` of their place is true, in their order.
template <class Values>
Values some_of(Values const& values, std::vector<bool> const& keep) {
  Values some;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (keep[k]) some.push_back(values[k]);
  }
  return some;
}

/// Returns the values of these rows, in their order.
template <class Values>
Values gathered(Values const& values, std::span<std::uint32_t const> rows) {
  Values ordered(rows.size());
  std::ranges::transform(rows, ordered.begin(), [&](std::uint32_t row) { return values[row]; });
  return ordered;
}

}  // namespace

bool TableColumn::is_of(std::size_t kind) const { return kinds.empty() || std::ranges::count(kinds, kind) != 0; }

RowSpan AgentTable::rows_of(std::optional<std::size_t> kind) const {
  if (!kind) return {0, size()};
  return places_in({}, *kind);
}

RowSpan AgentTable::places_in(TableColumn const& column, std::size_t kind) const {
  std::size_t first = 0;
  for (std::size_t k = 0; k < kind; ++k) first += column.is_of(k) ? counts_[k] : 0;
  return {first, first + (column.is_of(kind) ? counts_[kind] : 0)};
}

std::vector<std::uint32_t> AgentTable::places_of(TableColumn const& column, std::span<std::uint32_t const> rows) const {
  std::vector<std::uint32_t> places;
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    if (!column.is_of(kind)) continue;
    RowSpan const own = rows_of(kind);
    std::size_t const first = places_in(column, kind).first;
    for (std::size_t k = own.first; k < own.end; ++k) {
      places.push_back(static_cast<std::uint32_t>(first + rows[k] - own.first));
    }
  }
  return places;
}

bool AgentTable::has_kinds_in_order() const {
  if (kinds() == 1) return true;
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    RowSpan const own = rows_of(kind);
    auto const values = kind_of_rows().subspan(own.first, own.count());
    if (std::ranges::any_of(values, [&](std::uint32_t value) { return value != kind; })) return false;
  }
  return true;
}

std::vector<Id> AgentTable::add(std::size_t kind, std::span<double const> x, std::span<double const> y,
                                std::vector<ColumnValues> const& others) {
  std::vector<Id> ids(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) ids[k] = places_.add(x[k], y[k]);
  for (std::size_t k = 0; k < others_.size(); ++k) {
    if (!others_[k].is_of(kind)) continue;
    std::visit(
        [&](auto& values) {
          auto const& more = std::get<std::remove_reference_t<decltype(values)>>(others[k]);
          auto const end = static_cast<std::ptrdiff_t>(places_in(others_[k], kind).end);
          values.insert(values.begin() + end, more.begin(), more.end());
        },
        others_[k].values);
  }
  counts_[kind] += x.size();
  if (std::size_t const end = rows_of(kind).end; end < size()) {
    // The newborn are in the last rows as yet, and belong before the agents of the kinds after theirs.
    std::vector<std::uint32_t> rows(size());
    std::iota(rows.begin(), rows.end(), 0U);
    auto const own = rows.begin() + static_cast<std::ptrdiff_t>(end - x.size());
    std::rotate(own, rows.end() - static_cast<std::ptrdiff_t>(x.size()), rows.end());
    reorder_places(rows);
  }
  return ids;
}

void AgentTable::remove(std::span<Id const> ids) {
  if (kinds() == 1) {
    remove_by_last_row(ids);
  } else if (!ids.empty()) {
    remove_in_order(ids);
  }
}

void AgentTable::remove_by_last_row(std::span<Id const> ids) {
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
  counts_[0] = size();
}

/// Removes agents and keeps the others in the order of their rows, which is that of their kinds.
void AgentTable::remove_in_order(std::span<Id const> ids) {
  std::vector<bool> keep(size(), true);
  for (Id const id : ids) keep[places_.index_of(id)] = false;
  for (TableColumn& column : others_) {
    // The rows of the agents that have the column, in the order of its values.
    std::vector<bool> keep_values;
    for (std::size_t kind = 0; kind < kinds(); ++kind) {
      if (!column.is_of(kind)) continue;
      RowSpan const own = rows_of(kind);
      keep_values.insert(keep_values.end(), keep.begin() + static_cast<std::ptrdiff_t>(own.first),
                         keep.begin() + static_cast<std::ptrdiff_t>(own.end));
    }
    std::visit([&](auto& values) { values = some_of(values, keep_values); }, column.values);
  }
  for (std::size_t kind = kinds(); kind-- > 0;) {
    RowSpan const own = rows_of(kind);
    for (std::size_t row = own.first; row < own.end; ++row) counts_[kind] -= keep[row] ? 0 : 1;
  }
  std::vector<Id> const left = some_of(std::vector<Id>(places_.ids().begin(), places_.ids().end()), keep);
  for (Id const id : ids) places_.remove(id);
  std::vector<std::uint32_t> rows;
  for (Id const id : left) rows.push_back(static_cast<std::uint32_t>(places_.index_of(id)));
  reorder_places(rows);
}

void AgentTable::reorder(std::span<std::uint32_t const> rows) {
  std::vector<std::uint32_t> ordered(rows.begin(), rows.end());
  if (kinds() > 1) std::ranges::stable_sort(ordered, {}, [&](std::uint32_t row) { return kind_of_rows()[row]; });
  reorder_places(ordered);
  for (TableColumn& column : others_) {
    std::vector<std::uint32_t> const places = kinds() > 1 ? places_of(column, ordered) : ordered;
    std::visit([&](auto& all) { all = gathered(all, places); }, column.values);
  }
}

void AgentTable::reorder_places(std::span<std::uint32_t const> rows) {
  LargeArray<Id> ids(rows.size());
  Population<X, Y>::AllValues values;
  values.resize(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ids[k] = places_.ids()[rows[k]];
    values.copy(k, places_.values(), rows[k]);
  }
  places_.reorder(ids, values);
  places_.find_again(0, rows.size());
}

AgentsView AgentTable::view() const {
  std::vector<std::pair<std::string_view, AgentsView::Values>> columns{{X::name, x()}, {Y::name, y()}};
  expanded_.resize(others_.size());
  for (std::size_t k = 0; k < others_.size(); ++k) {
    TableColumn const& column = others_[k];
    std::visit(
        [&](auto const& values) {
          columns.emplace_back(column.name,
                               column.kinds.empty() ? std::span(values) : expand(column, values, expanded_[k]));
        },
        column.values);
  }
  return {ids(), std::move(columns)};
}

/// Copies the values of a column of some kinds to one with a value for each agent.
template <class Values>
std::span<typename Values::value_type const> AgentTable::expand(TableColumn const& column, Values const& values,
                                                                ColumnValues& expanded) const {
  if (!std::holds_alternative<Values>(expanded)) expanded = Values();
  auto& all = std::get<Values>(expanded);
  all.resize(size());
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    RowSpan const own = rows_of(kind);
    auto const to = all.begin() + static_cast<std::ptrdiff_t>(own.first);
    if (column.is_of(kind)) {
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(places_in(column, kind).first), own.count(), to);
    } else {
      std::fill_n(to, own.count(), typename Values::value_type());
    }
  }
  return all;
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
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    RowSpan const own = rows_of(kind);
    std::vector<TableColumn const*> columns;
    for (TableColumn const& column : others_) {
      if (column.is_of(kind)) columns.push_back(&column);
    }
    std::vector<std::size_t> first;
    for (TableColumn const* const column : columns) first.push_back(places_in(*column, kind).first);
    std::vector<std::uint64_t> record(3 + columns.size());
    for (std::size_t row = own.first; row < own.end; ++row) {
      record[0] = ids()[row];
      record[1] = word_of(x()[row]);
      record[2] = word_of(y()[row]);
      for (std::size_t k = 0; k < columns.size(); ++k) {
        record[3 + k] = std::visit([&](auto const& values) { return word_of(values[first[k] + row - own.first]); },
                                   columns[k]->values);
      }
      sum += hash_words(record);
    }
  }
  return sum;
}

void AgentTable::serialize(Archive& archive) {
  places_.serialize(archive);
  if (archive.is_restoring() && kinds() == 1) counts_[0] = size();
  serialize_inside(archive, "columns", [&] {
    for (TableColumn& column : others_) {
      std::visit(
          [&](auto& values) {
            std::vector<typename std::remove_reference_t<decltype(values)>::value_type> plain(values.begin(),
                                                                                              values.end());
            archive.visit(column.name, plain);
            if (archive.is_restoring()) values.assign(plain.begin(), plain.end());
          },
          column.values);
      // The column of the kinds comes first: it says how long the others are.
      if (archive.is_restoring() && kinds() > 1 && &column == others_.data()) count_kinds(archive);
      std::size_t const length = std::visit([](auto const& values) { return values.size(); }, column.values);
      archive.require(length == places_in(column, kinds() - 1).end, "the columns of the agents differ in length");
    }
  });
}

void AgentTable::count_kinds(Archive& archive) {
  auto const values = kind_of_rows();
  for (std::size_t kind = 0; kind < kinds(); ++kind) {
    counts_[kind] = static_cast<std::size_t>(std::ranges::count(values, kind));
  }
  archive.require(values.size() == size() && rows_of(kinds() - 1).end == size() && has_kinds_in_order(),
                  "the agents are not in the order of their kinds");
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
