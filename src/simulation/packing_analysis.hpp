#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/elasticity.hpp"

namespace gridlock {

/// The questions to a packing.
struct PackingQuestions {
  Potential potential = Potential::harmonic;
  double tolerance = 0.0;
  double largest_gap = 0.1;
  double largest_residual = usual_largest_residual;
};

/// All that is known of the packing of a state, with its files.
struct PackingAnalysis {
  Packing packing;                 ///< in the order of the Ids, all disks inside a periodic box
  std::vector<std::uint64_t> ids;  ///< of its disks
  PackingQuestions questions;
  ContactNetwork network;
  std::vector<Contact> gaps;
  std::optional<ElasticModuli> moduli;  ///< of a minimum
  std::optional<VibrationMode> softest_mode;
};

/// The contacts alone: no gaps, moduli and modes. Errors: those of find_contact_network().
PackingAnalysis find_contacts_of(State const& state, PackingQuestions const& questions);

/// Errors: those of find_contact_network() and find_gaps().
PackingAnalysis analyse_packing(State const& state, PackingQuestions const& questions);

/// The answer of ContactNetwork::is_jammed() with the softest mode.
std::optional<bool> is_jammed(PackingAnalysis const& analysis);

/// The contacts: i and j as Ids (at a wall twice the same), the wall (0 none, 1 left, 2 right, 3 bottom, 4 top),
/// distance, overlap, normal, force, the image of j that i touches, and whether both are of the backbone.
Table contacts_table(PackingAnalysis const& analysis);
/// The gaps, the closest first, in the same way.
Table gaps_table(PackingAnalysis const& analysis);
/// The relative forces of the backbone, ascending: extended ones and those of bucklers, each with the share that is not
/// above it.
Table forces_table(PackingAnalysis const& analysis);

/// The numbers in the words of summary.json; null for what is not known. Pressures, moduli and the softest mode are in
/// ε/D².
nlohmann::ordered_json summary_of(PackingAnalysis const& analysis);

}  // namespace gridlock
