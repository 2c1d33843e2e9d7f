#pragma once

/// \file
/// Agents in columns. An Id names the same agent for its whole life, while its row may change.
///
/// ```cpp
/// struct Age {
///   using type = double;
///   static constexpr char const* name = "age";
/// };
/// inline void live() {
///   Population<Age> people;
///   Id const id = people.add(30.0);
///   people.column<Age>()[people.index_of(id)] += 1.0;
///   people.remove(id);
/// }
/// ```

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/detail/column_set.hpp"
#include "gridlock/core/detail/free_names.hpp"
#include "gridlock/core/detail/look_ahead.hpp"

namespace gridlock {

/// The number of an agent for its whole life; no other agent of the run gets the same number, even after its death.
///
/// The low 32 bits are the number of a slot. The high 32 bits count the earlier agents in this slot. The first N agents
/// have the Ids 0 … N−1. A newborn reuses the slot of a dead agent, so that memory does not grow with the number of
/// births.
using Id = std::uint64_t;

/// A structure of arrays: one contiguous column per property, one row per living agent.
///
/// A column is declared as a tag `struct Radius { using type = double; static constexpr char const* name = "radius";
/// };` and read as `population.column<Radius>()[index]`. remove() moves the last row into the gap: to find an agent
/// after births and deaths, keep its Id, not its row.
/// Cost: add and remove O(1), no allocation per agent. Contract: an Id passed in is alive (asserted).
template <class... Columns>
class Population {
 public:
  static constexpr std::size_t not_found = std::numeric_limits<std::size_t>::max();

  using Values = std::tuple<typename Columns::type...>;  ///< one value per column, in the order they are declared
  using AllValues = ColumnSet<Columns...>;

  template <class Column>
  static constexpr bool has = (std::is_same_v<Column, Columns> || ...);

  /// The index of a column in Values.
  template <class Column>
  static constexpr std::size_t place_of = [] {
    std::size_t place = 0;
    bool is_found = false;
    ((is_found = is_found || std::is_same_v<Column, Columns>, place += is_found ? 0U : 1U), ...);
    return place;
  }();

  [[nodiscard]] std::size_t size() const { return ids_.size(); }
  [[nodiscard]] bool empty() const { return ids_.empty(); }

  template <class Column>
  [[nodiscard]] std::span<typename Column::type> column() {
    return rows_.template values<Column>();
  }
  template <class Column>
  [[nodiscard]] std::span<typename Column::type const> column() const {
    return rows_.template values<Column>();
  }

  [[nodiscard]] AllValues const& values() const { return rows_; }

  [[nodiscard]] std::span<Id const> ids() const { return ids_; }

  [[nodiscard]] bool contains(Id id) const { return index_of(id) != not_found; }

  /// Returns the row of a living agent, or `not_found`.
  [[nodiscard]] std::size_t index_of(Id id) const {
    std::size_t const slot = slot_of(id);
    if (slot >= slots_.size()) return not_found;
    Slot const& s = slots_[slot];
    return s.is_alive() && s.generation == generation_of(id) ? s.index : not_found;
  }

  /// Adds an agent with one value per column, in the order the columns are declared, and returns its Id.
  Id add(typename Columns::type... values) {
    std::uint32_t const slot = take_free_slot();
    Id const id = (Id{slots_[slot].generation} << 32) | slot;
    append(slot, id, values...);
    return id;
  }

  /// Adds an agent under a given Id, for example one from a file. Returns false, and adds nothing, if a living agent
  /// has this Id or its slot, or if a dead agent of this population had the Id. Cost: O(1), and memory for every slot
  /// up to that of the Id: check the Ids of an untrusted file for a bound first.
  [[nodiscard]] bool add_as(Id id, typename Columns::type... values) {
    std::size_t const slot = slot_of(id);
    while (slots_.size() <= slot) {
      free_slots_.push_back(static_cast<std::uint32_t>(slots_.size()));
      slots_.emplace_back();
    }
    if (slots_[slot].is_alive() || generation_of(id) < slots_[slot].generation) return false;
    // The slot stays in free_slots_, since a search for it would cost O(N); take_free_slot() skips slots of living
    // agents.
    slots_[slot].generation = generation_of(id);
    append(static_cast<std::uint32_t>(slot), id, values...);
    return true;
  }

  /// Removes a living agent and moves the last row into its row.
  void remove(Id id) {
    std::size_t const index = index_of(id);
    assert(index != not_found);
    std::size_t const last = size() - 1;
    slots_[slot_of(ids_[last])].index = static_cast<std::uint32_t>(index);
    ids_[index] = ids_[last];
    ids_.pop_back();
    rows_.copy(index, rows_, last);
    rows_.resize(last);
    Slot& slot = slots_[slot_of(id)];
    slot.index = Slot::nobody;
    ++slot.generation;
    free_slots_.push_back(static_cast<std::uint32_t>(slot_of(id)));
  }

  /// Prefetches the memory that remove(id) needs, so that many removals do not wait for memory one after the other:
  /// prefetch() the slot and, some time later, prefetch_row() the row. Contract: the agent is alive.
  void prefetch(Id id) const { gridlock::prefetch(&slots_[slot_of(id)]); }
  void prefetch_row(Id id) const {
    std::size_t const row = slots_[slot_of(id)].index;
    gridlock::prefetch(ids_.data() + row);
    (gridlock::prefetch(rows_.template values<Columns>().data() + row), ...);
  }

  /// Swaps the values of all agents with `rows`. Cost: O(1).
  /// Contract: `rows` has one row for each agent (asserted).
  void exchange(AllValues& rows) {
    assert(rows.size() == size());
    std::swap(rows_, rows);
  }

  /// Puts the agents into another order: row k becomes that of agent ids[k] with the values rows[k]. Returns the old
  /// rows in `ids` and `rows`. index_of() works again only after find_again() was called for every row. Cost: O(1).
  /// Contract: `ids` are the Ids of this population (not checked).
  void reorder(LargeArray<Id>& ids, AllValues& rows) {
    assert(rows.size() == size() && ids.size() == size());
    std::swap(ids_, ids);
    std::swap(rows_, rows);
  }
  /// After reorder(): makes index_of() find the agents of rows first … end − 1. Several threads may each do some of the
  /// rows.
  void find_again(std::size_t first, std::size_t end) {
    for (std::size_t row = first; row < end; ++row) {
      slots_[slot_of(ids_[row])].index = static_cast<std::uint32_t>(row);
    }
  }

  /// Frees the memory of all values. Until give_values(), only the Ids may be read.
  void forget_values() { rows_ = AllValues(); }
  /// Sets the values of all agents. Contract: one value in each column for each row (asserted).
  void give_values(AllValues&& rows) {
    assert(rows.size() == size());
    rows_ = std::move(rows);
  }

  /// Swaps the Ids and values of all agents with `ids` and `rows`, and makes this population a part: the agents of one
  /// process out of several that share a population. index_of() does not work in a part. Contract: one value in each
  /// column for each Id (asserted).
  void become(LargeArray<Id>& ids, AllValues& rows) {
    assert(rows.size() == ids.size());
    slots_.clear();
    free_slots_.clear();
    is_part_ = true;
    std::swap(ids_, ids);
    std::swap(rows_, rows);
  }
  /// For a part, in the process that gives out the Ids: the Ids of the next newborns of the whole population.
  [[nodiscard]] FreeNames& names_of_all() { return names_of_all_; }

  /// For a part: writes `id` and the values of row `from` to a row; row = size() appends one.
  void put_into_part(std::size_t row, Id id, AllValues const& values, std::size_t from) {
    if (row >= size()) {
      ids_.resize(row + 1);
      rows_.resize(row + 1);
    }
    ids_[row] = id;
    rows_.copy(row, values, from);
  }

  /// Serializes agents, the order of their rows, and the unused Ids, so that agents born later get the same Ids. A
  /// part, see become(), stays a part. Errors: Error if the restored values are no valid population.
  void serialize(Archive& archive) {
    serialize(archive, "id", ids_);
    (serialize(archive, Columns::name, rows_.template values<Columns>()), ...);
    archive.require(((rows_.template values<Columns>().size() == ids_.size()) && ...),
                    "the columns of the agents differ in length");
    if (is_part_) {
      names_of_all_.serialize(archive);
      return;
    }
    FreeNames names = free_names();
    names.serialize(archive);
    if (archive.is_restoring()) restore_slots(archive, names);
  }

  /// Returns the Ids that the next newborns get. Cost: one pass over the free slots.
  [[nodiscard]] FreeNames free_names() const {
    std::vector<Id> free;
    std::vector<bool> is_listed(slots_.size(), false);
    // A slot may be listed twice, see add_as(): only its last entry counts.
    for (auto slot = free_slots_.rbegin(); slot != free_slots_.rend(); ++slot) {
      if (slots_[*slot].is_alive() || is_listed[*slot]) continue;
      is_listed[*slot] = true;
      free.push_back((Id{slots_[*slot].generation} << 32) | *slot);
    }
    std::ranges::reverse(free);
    return {slots_.size(), std::move(free)};
  }

  /// Copies all rows and Ids to new memory, one column behind the other, and returns the old memory: pointers into the
  /// old memory stay valid as long as the returned owner. Cost: one copy.
  [[nodiscard]] std::shared_ptr<void> release() {
    auto const room_for = [&](std::size_t width) { return SideBySide::room_for(size() * width); };
    SideBySide const scope((room_for(sizeof(Id)) + ... + room_for(sizeof(typename Columns::type))));
    auto old = std::make_shared<std::pair<LargeArray<Id>, AllValues>>(ids_, rows_);
    reorder(old->first, old->second);
    return old;
  }

  void reserve(std::size_t agents) {
    ids_.reserve(agents);
    slots_.reserve(agents);
    (rows_.template values<Columns>().reserve(agents), ...);
  }

 private:
  /// The row of an agent, 8 bytes: every birth and death reads a slot at a random address, so that small slots are
  /// faster.
  struct Slot {
    static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t index = nobody;  ///< the row of the agent; `nobody` while the slot is free
    std::uint32_t generation = 0;
    [[nodiscard]] bool is_alive() const { return index != nobody; }
  };

  /// A bound on the slots of a restored population, besides 64 for each Id, since each takes memory.
  static constexpr std::size_t max_unused_names = std::size_t{1} << 22;

  static std::size_t slot_of(Id id) { return static_cast<std::size_t>(id & 0xFFFFFFFFU); }
  static std::uint32_t generation_of(Id id) { return static_cast<std::uint32_t>(id >> 32); }

  std::uint32_t take_free_slot() {
    while (!free_slots_.empty()) {
      std::uint32_t const slot = free_slots_.back();
      free_slots_.pop_back();
      if (!slots_[slot].is_alive()) return slot;
    }
    slots_.emplace_back();
    return static_cast<std::uint32_t>(slots_.size() - 1);
  }

  void append(std::uint32_t slot, Id id, typename Columns::type... values) {
    slots_[slot].index = static_cast<std::uint32_t>(size());
    ids_.push_back(id);
    (rows_.template values<Columns>().push_back(values), ...);
  }

  template <class Value>
  static void serialize(Archive& archive, char const* name, LargeArray<Value>& values) {
    std::vector<Value> plain(values.begin(), values.end());
    archive.visit_rows(name, plain);
    if (archive.is_restoring()) values.assign(plain.begin(), plain.end());
  }

  void restore_slots(Archive& archive, FreeNames const& names) {
    std::uint64_t slots = names.slots();
    // A population that was serialized in parts may list fewer slots than the Ids of its living agents need.
    for (Id const id : ids_) slots = std::max<std::uint64_t>(slots, slot_of(id) + 1);
    for (Id const id : names.free()) slots = std::max<std::uint64_t>(slots, slot_of(id) + 1);
    archive.require(slots <= 64 * (ids_.size() + names.free().size()) + max_unused_names,
                    "the Ids of the agents leave too many out");
    slots_.assign(slots, {});
    free_slots_.clear();
    for (std::size_t row = 0; row < ids_.size(); ++row) {
      Slot& slot = slots_[slot_of(ids_[row])];
      archive.require(!slot.is_alive(), "two agents have one name");
      slot = {.index = static_cast<std::uint32_t>(row), .generation = generation_of(ids_[row])};
    }
    for (Id const id : names.free()) {
      Slot& slot = slots_[slot_of(id)];
      archive.require(!slot.is_alive(), "a free name is that of an agent");
      slot.generation = generation_of(id);
      free_slots_.push_back(static_cast<std::uint32_t>(slot_of(id)));
    }
  }

  AllValues rows_;
  LargeArray<Id> ids_;
  LargeArray<Slot> slots_;
  std::vector<std::uint32_t> free_slots_;
  bool is_part_ = false;
  FreeNames names_of_all_;  ///< used in a part only
};

}  // namespace gridlock
