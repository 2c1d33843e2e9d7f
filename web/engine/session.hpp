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

/// A simulation of the page with its run, as Session of gridlock.ts.
class Session {
 public:
  /// Errors: those of set_up(), and Error for settings that a page does not support: files, or a long start.
  explicit Session(SettingsFile const& file);

  /// Returns the constant properties: title, settings, columns, notes of the set-up.
  [[nodiscard]] Json description();
  /// Returns the changing properties: box, clock, state of the protocol, progress.
  [[nodiscard]] Json status() const;
  /// Returns the notes of the set-up, and those of the protocol after its end.
  [[nodiscard]] Json notes() const;
  [[nodiscard]] std::string configuration();
  [[nodiscard]] Json values() { return values_of(setup_.configuration); }

  /// Advances by a number of steps or for a time, whichever ends first; returns the steps. Errors: RunFailure.
  std::uint64_t advance(std::uint64_t steps, double milliseconds);
  void lengthen();

  [[nodiscard]] std::vector<double> ids();
  /// Returns the values of a column in the order of Ids. Errors: Error for a name that is not a column.
  [[nodiscard]] FrameValues column(std::string const& name);
  /// Returns x and y of each agent, side by side.
  [[nodiscard]] std::vector<float> positions();
  [[nodiscard]] std::vector<float> radii();
  /// Returns the values of a colour for drawing. Errors: Error for a name that description() does not list.
  [[nodiscard]] std::vector<float> drawn_column(std::string const& name);

  /// Returns the rows of the series from `from_row` on, one after the other.
  [[nodiscard]] std::vector<double> series(std::size_t from_row) const;
  [[nodiscard]] Json results() const;
  /// Returns the tables "stages", "levels" and "shear" for the stages that have ended; none without a protocol.
  [[nodiscard]] Json protocol_tables() const;

  [[nodiscard]] std::string state_hash() const;
  /// Returns the neighbourhood of an agent. Errors: Error if there is no such agent.
  [[nodiscard]] Json neighbourhood(double id);
  /// Returns two Ids for each contact of a packing, contact_forces() the forces; nothing for other runs.
  [[nodiscard]] std::vector<double> contact_ids() const;
  [[nodiscard]] std::vector<double> contact_forces() const;

  [[nodiscard]] std::string save();
  /// Errors: Error if save() did not make the bytes with the same settings; the session is then unchanged.
  void restore(std::string const& bytes);

 private:
  [[nodiscard]] Simulation& simulation() const { return *setup_.simulation; }
  void start_run(RunPlan const& plan);
  /// Takes the present frame as the origin of displacements.
  void take_first_frame();
  [[nodiscard]] std::vector<Json> drawn_columns() const;
  [[nodiscard]] std::vector<std::uint32_t> const& rows();
  [[nodiscard]] NamedColumn find_column(std::string_view name) const;
  [[nodiscard]] std::vector<double> numbers_of(std::string_view name);
  /// Returns the distance within which agents interact; a cell has at least this side.
  [[nodiscard]] double cutoff();
  [[nodiscard]] CellLayout layout();

  Setup setup_;
  RunPlan plan_;
  std::string fingerprint_;  ///< hash of the settings, to recognize saved sessions
  std::optional<Run> run_;
  std::optional<std::uint64_t> left_out_until_;  ///< last step left out of averages in a run without an end
  Frame first_;
  double mark_ = 0.0;  ///< radius of the mark for agents without a radius
  std::vector<std::uint32_t> rows_;
  bool are_rows_known_ = false;
  bool is_within_step_ = false;  ///< whether advance() may have stopped within a step, when its time was over
};

}  // namespace gridlock::web
