#pragma once

/// \file
/// Decompression and compression of soft disks to a pressure, and the packing fraction at which the pressure vanishes.
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
#include "gridlock/packing/elasticity.hpp"
#include "gridlock/packing/minimizer.hpp"

namespace gridlock {

/// Bounds on the packing fraction of soft disks: below, disks never touch; above, each overlaps all of its neighbours.
inline constexpr double min_packing_fraction = 1e-6;
inline constexpr double max_packing_fraction = 4.0;
/// The largest packing fraction that a stage accepts: of 36 quenches of 64 disks of one or two sizes at 1.6, a quarter
/// ended with overlaps above ½, which are no packing; at 1.5 none.
inline constexpr double max_packing_fraction_of_stages = 1.5;

/// The settings of a ramp, which brings a packing to a pressure or a packing fraction.
struct PressureRampSettings {
  static constexpr std::uint64_t max_levels_per_decade = 20;  ///< levels that are nearer count as one
  static constexpr double min_step = 1e-7;
  static constexpr double max_step = 0.1;
  static constexpr double max_levels = 1e6;  ///< largest number of levels between two packing fractions

  MinimizerSettings minimizer = {};
  double pressure = 1e-8;                       ///< pressure P D²/ε at the end
  std::optional<double> packing_fraction = {};  ///< packing fraction at the end, in place of a pressure
  std::uint64_t levels_per_decade = 2;          ///< decompression: kept minima for each factor of ten in pressure
  double step = 1e-3;  ///< step of the packing fraction: on the way up at pressure 0, and towards packing_fraction
};

/// A minimum that a ramp keeps, at one pressure.
struct PressureLevel {
  double packing_fraction = 0.0;
  double pressure = 0.0;  ///< P D²/ε, D the smallest diameter
  double energy = 0.0;    ///< energy of all disks, in ε
  double residual = 0.0;
  std::uint64_t iterations = 0;                                      ///< iterations of the minimizer since the last
                                                                     ///< level
  std::uint64_t backbone_disks = 0;                                  ///< N₀
  std::uint64_t backbone_contacts = 0;                               ///< N_c
  double contact_number = std::numeric_limits<double>::quiet_NaN();  ///< 2 N_c/N₀; NaN without a backbone
  double excess_contacts = 0.0;  ///< N_c − [2(N₀ − 1) + 1], with walls N_c − (2 N₀ + 1); a whole number
  double bulk_modulus = std::numeric_limits<double>::quiet_NaN();          ///< in ε/D²; NaN if there is none
  double shear_modulus = std::numeric_limits<double>::quiet_NaN();         ///< ⟨G⟩, the mean over all directions
  double simple_shear_modulus = std::numeric_limits<double>::quiet_NaN();  ///< dσ/dγ of x ← x + γ y
  double pure_shear_modulus = std::numeric_limits<double>::quiet_NaN();  ///< dσ/dγ of x ← x e^(γ/2), y ← y e^(−γ/2)
  double least_shear_modulus = std::numeric_limits<double>::quiet_NaN();  ///< of the softest shear; below 0: unstable
  /// φ − u/(du/dφ) with u = p^(1/(α−1)) and the slope since the last minimum; NaN at the first minimum.
  double jamming_packing_fraction = std::numeric_limits<double>::quiet_NaN();
};

void serialize(Archive& archive, std::vector<PressureLevel>& levels);

/// Throws Error for the setting `key` if a ramp would have more than max_levels levels.
void require_countable_levels(double from, double to, double step, std::string const& key);

/// Returns the level of a minimum from the network of its contacts, without iterations and jamming packing fraction.
/// Contract: `network` belongs to the packing.
PressureLevel level_of(Packing const& packing, ContactNetwork const& network);

/// The status of a ramp, or how it ended.
enum class RampStatus {
  running,
  reached,      ///< the pressure or the packing fraction is reached
  unjammed,     ///< the pressure is 0 at the start of a ramp down, or at every packing fraction of a ramp up
  unconverged,  ///< a minimization found no minimum
  missed,       ///< a sudden rearrangement of disks makes the pressure jump past its goal
};
char const* to_text(RampStatus status);

/// Scales all radii in steps, each followed by a minimization, until the pressure reaches its goal.
///
/// The steps are secants in u = p^(1/(α−1)), which vanishes linearly at the jamming packing fraction. In every step the
/// disks first move by find_growth_response(), so that forces change in proportion and few contacts open or close. A
/// step that leads to pressure 0, or below 0.3 of its goal, is undone and tried with half its length; a pressure up to
/// 1.1 of a goal counts as this level. The last pressure is reached within 1 %, by further secants from either side; if
/// disks rearrange suddenly, 20 secants may not be enough, and the ramp has missed it. On the way up from pressure 0,
/// the first step closes three quarters of the contacts that a jammed packing needs, each further step is twice as
/// long, and none is longer than `step`; if the pressure is then too high, the ramp comes down to a third of it and a
/// third of that. A packing fraction is reached in steps of `step`, each a level. The last level is always the packing
/// at the end. Errors: Error for settings out of range and a packing that Minimizer refuses.
/// Cost: some five minimizations a level, most of them by Newton's method, and find_elastic_moduli().
/// Source: C. S. O'Hern et al. (2003), doi:10.1103/PhysRevE.68.011306.
class PressureRamp {
 public:
  /// A pressure up to this multiple of a goal counts as this level, and as on the same side of the last pressure.
  static constexpr double max_share_of_goal = 1.1;
  /// The relative precision to which the last pressure is reached.
  static constexpr double precision = 0.01;

  PressureRamp(PressureRampSettings const& settings, Packing packing);

  /// Continues until the ramp ends or should_continue() returns false. Returns whether the ramp has ended.
  bool advance(std::function<bool()> const& should_continue = {});

  [[nodiscard]] RampStatus status() const { return status_; }
  /// Returns the packing fraction at which a minimization found no minimum; nothing if there is none.
  [[nodiscard]] std::optional<double> packing_fraction_without_minimum() const {
    return status_ == RampStatus::unconverged ? std::optional(has_minimum_ ? tried_ : gridlock::packing_fraction(good_))
                                              : std::nullopt;
  }
  /// Returns the last minimum.
  [[nodiscard]] Packing const& packing() const { return good_; }
  [[nodiscard]] std::vector<PressureLevel> const& levels() const { return levels_; }
  [[nodiscard]] Minimizer const& minimizer() const { return minimizer_; }
  /// Returns the difference between the last two extrapolations; nothing before there are two.
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
  Packing good_;                            ///< the last accepted minimum
  std::optional<GrowthResponse> response_;  ///< find_growth_response() of good_, once it is needed
  Minimizer minimizer_;
  RampStatus status_ = RampStatus::running;
  bool has_minimum_ = false;
  double first_pressure_ = 0.0;
  double packing_fraction_ = 0.0;  ///< packing fraction of good_; pressure_ and slope_ too belong to good_
  double pressure_ = 0.0;
  double slope_ = 0.0;          ///< du/dφ
  double goal_ = 0.0;           ///< the pressure of the next level
  double tried_ = 0.0;          ///< the packing fraction of the present minimization
  std::uint64_t halvings_ = 0;  ///< halved steps since the last accepted minimum
  double step_up_ = 0.0;        ///< the next step up at pressure 0; 0 before the first
  std::uint64_t minima_since_level_ = 0;
  bool aims_at_end_ = false;  ///< whether the present step is a secant to the end that `step` has not shortened
  std::uint64_t minima_near_end_ = 0;
  double jamming_packing_fraction_ = std::numeric_limits<double>::quiet_NaN();  ///< of good_
  std::uint64_t iterations_before_ = 0;                                         ///< iterations of the minimizer at the
                                                                                ///< last level
  std::vector<PressureLevel> levels_;
};

}  // namespace gridlock
