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

/// Selects the parts of an analysis of a packing.
struct PackingQuestions {
  Potential potential = Potential::harmonic;
  double tolerance = 0.0;
  double largest_gap = 0.1;
  double largest_residual = usual_largest_residual;
};

/// The analysis of the packing of a state, for tables and summary.json.
struct PackingAnalysis {
  Packing packing;                 ///< in the order of Ids, all disks inside a periodic box
  std::vector<std::uint64_t> ids;  ///< Ids of the disks
  PackingQuestions questions;
  ContactNetwork network;
  std::vector<Contact> gaps;
  std::optional<ElasticModuli> moduli;  ///< only for a minimum of the energy
  std::optional<VibrationMode> softest_mode;
};

/// Finds only the contacts, without gaps, moduli and modes. Errors: those of find_contact_network().
PackingAnalysis find_contacts_of(State const& state, PackingQuestions const& questions);

/// Makes the analysis that `questions` selects. Errors: those of find_contact_network() and find_gaps().
PackingAnalysis analyse_packing(State const& state, PackingQuestions const& questions);

/// Returns the result of ContactNetwork::is_jammed() for the softest mode of the analysis.
std::optional<bool> is_jammed(PackingAnalysis const& analysis);

/// Returns the contacts: i and j as Ids (equal at a wall), the wall (0 none, 1 left, 2 right, 3 bottom, 4 top),
/// distance, overlap, normal, force, the image of j that i touches, and whether both belong to the backbone.
Table contacts_table(PackingAnalysis const& analysis);
/// Returns the gaps in ascending order: i, j, wall, distance, normal, gap and image, as in contacts_table().
Table gaps_table(PackingAnalysis const& analysis);
/// Returns the relative forces of the backbone in ascending order, extended forces and those of bucklers, each with the
/// cumulative share of forces up to it.
Table forces_table(PackingAnalysis const& analysis);

/// Returns the results with the names of summary.json; null for unknown values. Pressures, moduli and the softest mode
/// are in ε/D².
nlohmann::ordered_json summary_of(PackingAnalysis const& analysis);

}  // namespace gridlock
