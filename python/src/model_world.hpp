#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "column_lender.hpp"
#include "field_copies.hpp"
#include "gridlock/core/field.hpp"
#include "gridlock/core/network.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/core/world.hpp"
#include "kept_searches.hpp"
#include "model.hpp"

namespace gridlock::python {

/// The values of new agents of one kind: an array for each column, x and y first, empty for columns of other kinds.
struct NewAgents {
  std::size_t kind = 0;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<ColumnValues> others;
};

/// What a step has changed, as it was before. Room is kept for the next step.
struct BeforeStep {
  FieldCopies fields;
  std::vector<TableColumn> columns;
};

/// The world that a model in Python sees at its start, in a step or in an observation, with its requests for changes.
///
/// Deaths and births take effect after the step, so that rows keep their meaning within it.
class ModelWorld {
 public:
  enum class Phase { start, step, observation };

  /// `kept` and `before` outlive all use of this world.
  ModelWorld(World<TableModel>& world, ModelDefinition const& definition, std::uint64_t threads, KeptSearches& kept,
             Phase phase, BeforeStep* before = nullptr)
      : world_(world), definition_(definition), threads_(threads), kept_(kept), phase_(phase), before_(before) {}

  [[nodiscard]] BoxValues box() const;
  [[nodiscard]] std::pair<std::uint64_t, double> clock() const;
  [[nodiscard]] std::uint64_t seed() const;
  [[nodiscard]] std::size_t size() const;
  /// Returns how many agents of each kind there are.
  [[nodiscard]] std::vector<std::size_t> counts() const;

  /// Returns the values of a column, of some kinds only where it is theirs.
  nb::object column(std::string const& name);
  nb::object positions();
  nb::object ids();

  using Positions = nb::ndarray<double const, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
  using Amounts = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  /// Returns the values of a field, shape (rows, columns).
  nb::object field(std::string const& name);
  /// Returns the cells around points, or around all agents: indices in the values of a field row by row.
  nb::object cells(std::string const& name, std::optional<Positions> const& points) const;
  /// Adds an amount for each agent to its cell, in the order of the rows.
  void deposit(std::string const& name, Amounts const& amounts);
  /// Takes up to an amount for each agent from its cell; returns the amounts that they got. Where a cell has too little
  /// for all, they take in a random order.
  nb::object take(std::string const& name, Amounts const& amounts);
  /// Spreads a field for a time step.
  void spread(std::string const& name, double diffusion, double decay, double time);

  using RowNumbers = nb::ndarray<std::uint64_t const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  using RowsFromTo = std::pair<std::size_t, std::size_t>;
  /// Returns `each` random numbers for each of some rows, of shape (rows, each); in the start for new agents with these
  /// numbers.
  nb::object numbers(RowNumbers const& rows, std::size_t each, std::uint64_t purpose, bool is_normal) const;
  /// Returns the same for all rows from the first to before the end.
  nb::object numbers_from(RowsFromTo rows, std::size_t each, std::uint64_t purpose, bool is_normal) const;
  /// Returns the rows, counted from the first, in the order of a uniform number for each.
  nb::object random_order(RowsFromTo rows, std::uint64_t purpose) const;
  /// Rows at both ends of each edge. Rows beyond those of the agents are newborn ones, in the order of add().
  using Rows = nb::ndarray<std::uint64_t const, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
  /// Returns the rows at both ends of each edge of a network, shape (edges, 2), and the weights.
  nb::object network_edges(std::string const& name) const;
  /// Returns the neighbours of all agents on a network as lists, and the weights of their edges: in a directed network
  /// those that edges of the agent lead to, or those that they come from.
  nb::object network_lists(std::string const& name, bool incoming) const;
  /// Adds edges. Those of newborn agents are there after the step.
  void connect(std::string const& name, Rows const& rows, Amounts const& weights);
  void disconnect(std::string const& name, Rows const& rows);
  void set_weights(std::string const& name, Amounts const& weights);
  /// Returns a flag for each pair of rows, 1 where there is an edge.
  nb::object has_edges(std::string const& name, Rows const& rows) const;
  /// Returns the rows of a graph that is drawn at random: "probability", "edges", "small world" or "scale free", with
  /// its numbers.
  nb::object random_pairs(std::string const& name, std::string const& kind, double first, double second,
                          std::uint64_t purpose) const;

  /// Returns random numbers for the whole model in this step.
  nb::object numbers_of_step(std::size_t count) const;

  /// Returns the neighbours of the agents in some rows among those in others, both counted from their first rows.
  nb::object neighbor_lists(double cutoff, RowsFromTo seeking, RowsFromTo among) const;
  nb::object pairs(double cutoff, RowsFromTo among) const;

  using Displacements = nb::ndarray<double const, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
  /// Moves the agents from a row on by displacements; returns an array of shape (agents, 2) that shows where walls
  /// turned them back.
  nb::object move(Displacements const& displacements, std::size_t first);
  /// Moves the agents from a row on, but no nearer than the sum of their radii: move_apart(). Returns where walls have
  /// halted them, of shape (agents, 2), and by which of these agents each was halted, or −1.
  nb::object move_apart(Displacements const& displacements, std::size_t first, Amounts const& radii,
                        std::uint64_t parts, bool is_shuffled);

  /// Adds new agents of a kind. `columns` has an array for every column, x and y first, of the column's type.
  void add(std::size_t kind, nb::typed<nb::list, nb::object> const& columns);
  void remove(RowNumbers const& rows);
  void count(std::size_t event, std::uint64_t times);

  /// Ends the access of Python. Arrays that Python still holds get memory of their own. Waits for searches in other
  /// threads.
  void close();

  /// Returns the Ids of agents that die, sorted and without repetition.
  [[nodiscard]] std::vector<Id> deaths() const;
  [[nodiscard]] std::vector<NewAgents> const& births() const { return births_; }
  [[nodiscard]] std::vector<std::uint64_t> const& events() const { return events_; }
  /// Returns the names of the columns that this step was given to change.
  [[nodiscard]] std::vector<std::string> const& columns_changed() const { return columns_changed_; }
  [[nodiscard]] bool has_changed_positions() const;
  [[nodiscard]] bool has_changed_places_or_number() const {
    return has_changed_positions() || !births_.empty() || !dead_rows_.empty();
  }
  /// Puts columns, fields and networks back that this step has changed. Contract: there was room for them.
  void restore();
  /// Returns how many rows there are with those of newborn agents, which follow the others.
  [[nodiscard]] std::uint64_t rows_with_newborn() const;
  /// Returns, for each network, edges between rows with newborn agents.
  [[nodiscard]] std::vector<Network> const& edges_of_newborn() const { return edges_of_newborn_; }

 private:
  void require_open() const;
  /// Keeps a copy of what a column was, before the step changes it.
  void keep_before(std::string_view column);
  void require_rows(RowsFromTo rows) const;
  /// Returns the random numbers of a row in this step, in the start those of a new agent with this number.
  [[nodiscard]] RandomStream stream_of(std::uint64_t row, std::uint64_t purpose) const;
  template <class RowAt>
  nb::object draw(std::size_t rows, RowAt row_at, std::size_t each, std::uint64_t purpose, bool is_normal) const;
  void require_displacements(Displacements const& displacements, std::size_t first) const;
  [[nodiscard]] std::vector<std::uint32_t> order_of_turns(RowsFromTo rows, bool is_shuffled) const;
  [[nodiscard]] Field& find_field(std::string const& name) const;
  /// Returns a field to be changed, of which a step keeps a copy.
  Field& field_to_change(std::string const& name);
  [[nodiscard]] Network& find_network(std::string const& name) const;
  /// Returns a network to be changed, and keeps a copy of what it was.
  Network& network_to_change(std::string const& name);
  /// Returns edges between living agents. Errors: Error for a row without an agent.
  [[nodiscard]] std::vector<NetworkEdge> edges_of(Rows const& rows, Amounts const* weights) const;
  [[nodiscard]] Network edges_of_newborn(std::string const& name) const;
  /// Returns the rows at both ends of each edge. A start counts agents by their Ids, 0, 1, 2 … in the order in which
  /// they are added, since their rows change with agents of other kinds.
  [[nodiscard]] std::vector<std::array<std::uint32_t, 2>> rows_of(Network const& network) const;
  [[nodiscard]] Id id_of(std::uint64_t row) const;
  [[nodiscard]] Vector place_of(std::size_t row) const;
  void require_one_for_each_agent(Amounts const& amounts) const;
  /// Returns the result of a search among the agents, made without holding the GIL if it is not known.
  template <class Search, class ToPython>
  nb::object find(SearchOfRows const& rows, Search search, ToPython to_python) const;

  World<TableModel>& world_;
  ModelDefinition const& definition_;
  std::uint64_t threads_;
  KeptSearches& kept_;
  Phase phase_;
  bool is_closed_ = false;
  mutable std::atomic<int> searches_ = 0;  ///< searches in progress
  ColumnLender lender_;
  std::vector<std::uint64_t> dead_rows_;
  std::vector<NewAgents> births_;
  BeforeStep* before_;                        ///< nullptr if nothing is to be restored
  std::vector<std::string> columns_changed_;  ///< names of those that were to be changed, whose copies are up to date
  std::vector<Network> networks_before_;      ///< those that were to be changed, as they were
  std::vector<Network> edges_of_newborn_;     ///< edges between rows, in place of Ids, with newborn agents
  std::vector<std::uint64_t> events_ = std::vector<std::uint64_t>(definition_.events.size());
};

/// Connects newborn agents: `edges` join rows, whose agents have these Ids now. Edges of the dead are left out.
void connect_newborn(World<TableModel>& world, std::vector<Network> const& edges, std::span<Id const> ids);
/// Throws Error for an edge to an agent that does not live.
void require_living_ends(World<TableModel> const& world);

/// Shows a world to a method of a model until the end of the scope. Python may keep the object, but can no longer use
/// it.
class ShownWorld {
 public:
  /// `others` are the arguments of the constructor of ModelWorld after the world.
  template <class... Others>
  explicit ShownWorld(World<TableModel>& world, ModelDefinition const& definition, Others&&... others)
      : world_(new ModelWorld(world, definition, std::forward<Others>(others)...)),
        object_(nb::cast(world_, nb::rv_policy::take_ownership)) {}
  ~ShownWorld() { world_->close(); }
  ShownWorld(ShownWorld const&) = delete;
  ShownWorld& operator=(ShownWorld const&) = delete;

  [[nodiscard]] nb::object const& object() const { return object_; }
  ModelWorld* operator->() const { return world_; }

 private:
  ModelWorld* world_;
  nb::object object_;
};

void bind_model_world(nb::module_& module);

}  // namespace gridlock::python
