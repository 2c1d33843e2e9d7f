#pragma once

/// \file
/// Agents in columns, with Ids that keep their meaning while rows move.
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

/// The name of an agent for as long as the run lasts; never given to another agent, even after its death.
///
/// The low 32 bits are a slot, the high 32 bits how often that slot was used before: the first N agents of a
/// population are 0 … N−1, and the slot of a dead agent returns under a new name, so memory stays flat under any
/// number of births and deaths.
using Id = std::uint64_t;

/// A structure of arrays: one contiguous column per property, one row per living agent.
///
/// A column is declared as a tag `struct Radius { using type = double; static constexpr char const* name = "radius";
/// };` and read as `population.column<Radius>()[index]`. Rows have no lasting place: remove() moves the last row into
/// the gap, so keep an Id, not an index, across births and deaths.
/// Cost: add and remove O(1), no allocation per agent. Contract: an Id passed in is alive (asserted).
template <class... Columns>
class Population {
 public:
  static constexpr std::size_t not_found = std::numeric_limits<std::size_t>::max();

  using Values = std::tuple<typename Columns::type...>;  ///< one value per column, in the order they are declared
  using AllValues = ColumnSet<Columns...>;

  /// Whether there is such a column.
  template <class Column>
  static constexpr bool has = (std::is_same_v<Column, Columns> || ...);

  /// The place of a column in Values.
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

  /// All columns at once.
  [[nodiscard]] AllValues const& values() const { return rows_; }

  /// The Id of each row.
  [[nodiscard]] std::span<Id const> ids() const { return ids_; }

  [[nodiscard]] bool contains(Id id) const { return index_of(id) != not_found; }

  /// The row of a living agent, or `not_found`.
  [[nodiscard]] std::size_t index_of(Id id) const {
    std::size_t const slot = slot_of(id);
    if (slot >= slots_.size()) return not_found;
    Slot const& s = slots_[slot];
    return s.is_alive() && s.generation == generation_of(id) ? s.index : not_found;
  }

  /// Adds an agent with one value per column, in the order the columns are declared.
  Id add(typename Columns::type... values) {
    std::uint32_t const slot = take_free_slot();
    Id const id = (Id{slots_[slot].generation} << 32) | slot;
    append(slot, id, values...);
    return id;
  }

  /// Adds an agent under a given Id, as a reader of files does. Returns false, and adds nothing, where that name or
  /// another generation of its slot is alive already, or where it is the name of a dead agent of this population.
  /// Cost: O(1), and memory for every slot up to the one named: bound the Ids of an untrusted file first.
  [[nodiscard]] bool add_as(Id id, typename Columns::type... values) {
    std::size_t const slot = slot_of(id);
    while (slots_.size() <= slot) {
      free_slots_.push_back(static_cast<std::uint32_t>(slots_.size()));
      slots_.emplace_back();
    }
    if (slots_[slot].is_alive() || generation_of(id) < slots_[slot].generation) return false;
    // The slot stays in free_slots_, where finding it would cost O(N): take_free_slot() drops it when it gets there.
    slots_[slot].generation = generation_of(id);
    append(static_cast<std::uint32_t>(slot), id, values...);
    return true;
  }

  /// Removes a living agent; the last row takes its place.
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

  /// Asks for the memory that remove() will need, so that the deaths of many agents do not wait for one another: first
  /// what says where the agent is, and when that has had time to come, its row. For Ids of the living.
  void prefetch(Id id) const { gridlock::prefetch(&slots_[slot_of(id)]); }
  void prefetch_row(Id id) const {
    std::size_t const row = slots_[slot_of(id)].index;
    gridlock::prefetch(ids_.data() + row);
    (gridlock::prefetch(rows_.template values<Columns>().data() + row), ...);
  }

  /// Gives every agent the values of its row in `rows`, and leaves the old ones there. Cost: O(1).
  /// Contract: as many rows (asserted).
  void exchange(AllValues& rows) {
    assert(rows.size() == size());
    std::swap(rows_, rows);
  }

  /// The same agents in another order: row k is that of agent ids[k] with the values rows[k]; the old order is left in
  /// `ids` and `rows`. No Id is found again before find_again() has been told of every row. Cost: O(1).
  /// Contract: `ids` are those of this population (not checked).
  void reorder(LargeArray<Id>& ids, AllValues& rows) {
    assert(rows.size() == size() && ids.size() == size());
    std::swap(ids_, ids);
    std::swap(rows_, rows);
  }
  /// After reorder(): lets the Ids of rows first … end − 1 be found. Threads may share the rows out among them.
  void find_again(std::size_t first, std::size_t end) {
    for (std::size_t row = first; row < end; ++row) {
      slots_[slot_of(ids_[row])].index = static_cast<std::uint32_t>(row);
    }
  }

  /// Frees the memory of all values. Nothing but the Ids may be asked for until give_values().
  void forget_values() { rows_ = AllValues(); }
  /// Contract: one value in each column for each row (asserted).
  void give_values(AllValues&& rows) {
    assert(rows.size() == size());
    rows_ = std::move(rows);
  }

  /// Becomes agents with these Ids and values, and leaves its own there. No Id is found: for a part of a population, of
  /// which another one knows the names. Contract: one value in each column for each Id (asserted).
  void become(LargeArray<Id>& ids, AllValues& rows) {
    assert(rows.size() == ids.size());
    slots_.clear();
    free_slots_.clear();
    is_part_ = true;
    std::swap(ids_, ids);
    std::swap(rows_, rows);
  }
  /// For a part: the names that the next newborn of the whole population get, where this process is the one to know.
  [[nodiscard]] FreeNames& names_of_all() { return names_of_all_; }

  /// For a part: this row, or one more behind the last, becomes that of an agent with this Id and the values of row
  /// `from`.
  void put_into_part(std::size_t row, Id id, AllValues const& values, std::size_t from) {
    if (row >= size()) {
      ids_.resize(row + 1);
      rows_.resize(row + 1);
    }
    ids_[row] = id;
    rows_.copy(row, values, from);
  }

  /// Serializes agents, the order of their rows, and the names that are used up, so that the agents born afterwards get
  /// the same Ids. A part, see become(), stays one. Errors: Error where what is restored is no population.
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

  /// The names of those who are born next. Cost: a pass over the free ones.
  [[nodiscard]] FreeNames free_names() const {
    std::vector<Id> free;
    std::vector<bool> is_listed(slots_.size(), false);
    // A slot may stand there twice, see add_as(): the last one counts.
    for (auto slot = free_slots_.rbegin(); slot != free_slots_.rend(); ++slot) {
      if (slots_[*slot].is_alive() || is_listed[*slot]) continue;
      is_listed[*slot] = true;
      free.push_back((Id{slots_[*slot].generation} << 32) | *slot);
    }
    std::ranges::reverse(free);
    return {slots_.size(), std::move(free)};
  }

  /// Goes on with a copy of all rows and Ids, the columns side by side in memory, and returns the old memory: whoever
  /// has pointers into it keeps what it held. Cost: a copy.
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
  /// Eight to a cache line: what says where an agent is lies at a random place for every birth and death.
  struct Slot {
    static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t index = nobody;  ///< of its row; nobody's while the slot is free
    std::uint32_t generation = 0;
    [[nodiscard]] bool is_alive() const { return index != nobody; }
  };

  /// Beyond 64 for each agent, in what is restored: each takes memory.
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
    // In a population that was serialized in parts only the living may have a name.
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
  FreeNames names_of_all_;  ///< of a part
};

}  // namespace gridlock
