#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "catalogue.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock::web {

/// A simulation of the page, with its run: the interface Session of gridlock.ts.
class Session {
 public:
  /// Errors: those of set_up(), and Error for what a page cannot do: read files, wait long for a start.
  explicit Session(SettingsFile const& file);

  /// What does not change: title, box, settings, columns, notes of the set-up.
  [[nodiscard]] Json description();
  /// What does: clock, preparation, how much is done.
  [[nodiscard]] Json status() const;
  /// Those of the set-up, and of the protocol once it has ended.
  [[nodiscard]] Json notes() const;
  [[nodiscard]] std::string configuration();
  [[nodiscard]] Json values() { return values_of(setup_.configuration); }

  /// Goes on by so many steps or for so long; returns the steps done. Errors: RunFailure.
  std::uint64_t advance(std::uint64_t steps, double milliseconds);
  void lengthen();

  [[nodiscard]] std::vector<double> ids();
  /// The values of a column in the order of the Ids. Errors: Error for a name that is no column.
  [[nodiscard]] FrameValues column(std::string const& name);
  /// x and y of each agent, side by side.
  [[nodiscard]] std::vector<float> positions();
  [[nodiscard]] std::vector<float> radii();
  /// A column as it is drawn. Errors: Error for a name that is none of those that description() lists.
  [[nodiscard]] std::vector<float> drawn_column(std::string const& name);

  /// The rows of the series from one on, one after the other.
  [[nodiscard]] std::vector<double> series(std::size_t from_row) const;
  [[nodiscard]] Json results() const;
  /// The tables "stages" and "levels" of a protocol, of the stages that have ended; none without one.
  [[nodiscard]] Json protocol_tables() const;

  [[nodiscard]] std::string state_hash() const;
  /// Errors: Error where there is no such agent.
  [[nodiscard]] Json neighbourhood(double id);
  /// Two Ids for each contact of a packing; and the forces. Empty where there are none.
  [[nodiscard]] std::vector<double> contact_ids() const;
  [[nodiscard]] std::vector<double> contact_forces() const;

  [[nodiscard]] std::string save();
  /// Errors: Error for bytes that save() did not make in a session of the same settings; nothing has changed then.
  void restore(std::string const& bytes);

 private:
  [[nodiscard]] Simulation& simulation() const { return *setup_.simulation; }
  void start_run(RunPlan const& plan);
  /// Displacements are counted from here.
  void take_first_frame();
  [[nodiscard]] std::vector<Json> drawn_columns() const;
  [[nodiscard]] std::vector<std::uint32_t> const& rows();
  [[nodiscard]] NamedColumn find_column(std::string_view name) const;
  [[nodiscard]] std::vector<double> numbers_of(std::string_view name);
  /// How near two agents are that see each other; the side of a cell is no smaller.
  [[nodiscard]] double cutoff();
  [[nodiscard]] CellLayout layout();

  Setup setup_;
  RunPlan plan_;
  std::string fingerprint_;  ///< of the settings, for what is saved
  std::optional<Run> run_;
  std::optional<std::uint64_t> left_out_until_;  ///< by a run without an end
  Frame first_;
  double mark_ = 0.0;  ///< the radius of agents that have none
  std::vector<std::uint32_t> rows_;
  bool are_rows_known_ = false;
  bool is_within_step_ = false;  ///< perhaps: the last call of advance() was out of time
};

}  // namespace gridlock::web
