#pragma once

/// \file
/// Decompression and compression of soft disks to a pressure, and the packing fraction at which it vanishes.
///
/// ```cpp
/// Packing start{.box = Box(1.0, std::sqrt(3.0) / 2.0, Edge::periodic), .x = {}, .y = {}, .radius = {}};
/// for (int k = 0; k < 16; ++k) {  // a triangular lattice
///   start.x.push_back((k % 4 + 0.5 * (k / 4 % 2)) / 4.0);
///   start.y.push_back((k / 4 + 0.5) * std::sqrt(3.0) / 8.0);
///   start.radius.push_back(0.13);
/// }
/// PressureRamp ramp({.pressure = 1e-6}, start);
/// ramp.advance();
/// double const jamming_packing_fraction = ramp.levels().back().jamming_packing_fraction;  // π/√12
/// ```

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/minimizer.hpp"

namespace gridlock {

/// Packing fractions of soft disks: below, disks are so far apart that they never meet; above, each overlaps all around
/// it.
inline constexpr double min_packing_fraction = 1e-6;
inline constexpr double max_packing_fraction = 4.0;
/// The largest packing fraction that a stage takes: at 1.6 a quarter of 36 quenches of 64 disks of one or two sizes end
/// with overlaps above ½, which are no packing; at 1.5 none does.
inline constexpr double max_packing_fraction_of_stages = 1.5;

/// How a packing is brought to a pressure.
struct PressureRampSettings {
  static constexpr std::uint64_t max_levels_per_decade = 20;  ///< nearer ones count as one
  static constexpr double min_step = 1e-7;
  static constexpr double max_step = 0.1;
  static constexpr double max_levels = 1e6;  ///< between two packing fractions

  MinimizerSettings minimizer = {};
  double pressure = 1e-8;                       ///< P D²/ε to reach
  std::optional<double> packing_fraction = {};  ///< to reach in place of a pressure
  std::uint64_t levels_per_decade = 2;          ///< going down: every such pressure is a minimum that is kept
  double step = 1e-3;  ///< of the packing fraction: going up while nothing presses, and towards a packing fraction
};

/// A minimum that was kept.
struct PressureLevel {
  double packing_fraction = 0.0;
  double pressure = 0.0;  ///< P D²/ε, D the smallest diameter
  double energy = 0.0;    ///< of all disks, in ε
  double residual = 0.0;
  std::uint64_t iterations = 0;                                      ///< of the minimizer since the level before
  std::uint64_t backbone_disks = 0;                                  ///< N₀
  std::uint64_t backbone_contacts = 0;                               ///< N_c
  double contact_number = std::numeric_limits<double>::quiet_NaN();  ///< 2 N_c/N₀; no number without a backbone
  double excess_contacts = 0.0;  ///< N_c − [2(N₀ − 1) + 1], between walls N_c − (2 N₀ + 1); a whole number
  double bulk_modulus = std::numeric_limits<double>::quiet_NaN();   ///< in ε/D²; no number where there is none
  double shear_modulus = std::numeric_limits<double>::quiet_NaN();  ///< ⟨G⟩, the mean over all directions
  double least_shear_modulus =
      std::numeric_limits<double>::quiet_NaN();  ///< below 0: the packing is unstable against shear
  /// φ − u/(du/dφ) with u = p^(1/(α−1)) and the slope since the last minimum; no number at the first.
  double jamming_packing_fraction = std::numeric_limits<double>::quiet_NaN();
};

void serialize(Archive& archive, std::vector<PressureLevel>& levels);

/// Throws Error, of that key, for a ramp that would have more than max_levels.
void require_countable_levels(double from, double to, double step, std::string const& key);

/// A minimum with all that the network of its contacts says; without iterations and jamming packing fraction.
/// Contract: `network` is that of the packing.
PressureLevel level_of(Packing const& packing, ContactNetwork const& network);

/// How a ramp ended.
enum class RampStatus {
  running,
  reached,      ///< the pressure or the packing fraction
  unjammed,     ///< the start does not press, and the ramp leads down; or no packing fraction was found that does
  unconverged,  ///< a minimization gave up
  missed,       ///< disks that rearrange at once take the pressure past the one asked for
};
char const* to_text(RampStatus status);

/// Changes all radii alike, step by step, each followed by a minimization, until the pressure is the one asked for.
///
/// The steps are secants in u = p^(1/(α−1)), which vanishes linearly at the jamming packing fraction. With every step
/// the disks of a minimum move as find_growth_response() says, so that all its forces change alike and few contacts
/// open or close. Where a step leads to disks that do not press, or below 0.3 of the pressure it was made for, the
/// state before it is taken up again and half the step is tried; a pressure up to 1.1 of it counts as that level. The
/// last pressure is reached within 1 %, by further secants from either side; where disks rearrange at once, 20 of them
/// may not be enough, and the ramp has missed it. On the way up from disks that do not press, the first step makes
/// three of four contacts touch that a jammed packing has, each further one is twice as long, and none is longer than
/// `step`; where they lead to too high a pressure, the ramp comes down again to a third of it and a third of that. A packing fraction is reached in steps of `step`, each a level. The last level is the packing at the end, however it ended.
/// Errors: Error for settings out of range and a packing that Minimizer refuses.
/// Cost: some five minimizations a level, most of them by Newton's method, and find_elastic_moduli().
/// Source: C. S. O'Hern et al. (2003), doi:10.1103/PhysRevE.68.011306.
class PressureRamp {
 public:
  /// Up to this multiple of a pressure counts as that level, and as the same side of the pressure asked for.
  static constexpr double max_share_of_goal = 1.1;
  /// The pressure asked for is reached up to this share of it.
  static constexpr double precision = 0.01;

  PressureRamp(PressureRampSettings const& settings, Packing packing);

  /// Goes on until the ramp has ended or should_continue says no. Returns whether it has ended.
  bool advance(std::function<bool()> const& should_continue = {});

  [[nodiscard]] RampStatus status() const { return status_; }
  /// The packing fraction at which a minimization gave up; none where none did.
  [[nodiscard]] std::optional<double> packing_fraction_without_minimum() const {
    return status_ == RampStatus::unconverged ? std::optional(has_minimum_ ? tried_ : gridlock::packing_fraction(good_))
                                              : std::nullopt;
  }
  /// The last minimum.
  [[nodiscard]] Packing const& packing() const { return good_; }
  [[nodiscard]] std::vector<PressureLevel> const& levels() const { return levels_; }
  [[nodiscard]] Minimizer const& minimizer() const { return minimizer_; }
  /// The difference between the last two extrapolations; none before there are two.
  [[nodiscard]] std::optional<double> error_of_jamming_packing_fraction() const;

  void serialize(Archive& archive);

 private:
  void take_minimum();
  void accept(double packing_fraction, double pressure);
  void next_goal();
  void approach(double goal);
  [[nodiscard]] bool is_at_end() const;
  [[nodiscard]] bool is_level() const;
  void add_level();
  void end(RampStatus status);
  void next_packing_fraction();
  void try_packing_fraction(double packing_fraction);
  bool move_with_growth(Packing& packing, double growth);
  [[nodiscard]] double step_to_first_contacts() const;
  [[nodiscard]] bool leads_down() const { return settings_.pressure < first_pressure_; }

  PressureRampSettings settings_;
  Packing good_;                                 ///< the last minimum that was taken
  std::optional<std::vector<Vector>> response_;  ///< of good_ to growth, once it was asked for
  Minimizer minimizer_;
  RampStatus status_ = RampStatus::running;
  bool has_minimum_ = false;
  double first_pressure_ = 0.0;
  double packing_fraction_ = 0.0;  ///< of good_, as the next
  double pressure_ = 0.0;
  double slope_ = 0.0;          ///< du/dφ
  double goal_ = 0.0;           ///< the pressure of the next level
  double tried_ = 0.0;          ///< the packing fraction of the minimization under way
  std::uint64_t halvings_ = 0;  ///< steps back since the last minimum that was taken
  double step_up_ = 0.0;        ///< the next one from disks that do not press; 0 before the first
  std::uint64_t minima_since_level_ = 0;
  bool aims_at_end_ = false;  ///< the minimization under way, by a secant that `step` has not cut
  std::uint64_t minima_near_end_ = 0;
  double jamming_packing_fraction_ = std::numeric_limits<double>::quiet_NaN();  ///< of good_
  std::uint64_t iterations_before_ = 0;                                         ///< of the minimizer at the last level
  std::vector<PressureLevel> levels_;
};

}  // namespace gridlock
