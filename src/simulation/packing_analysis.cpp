#include "simulation/packing_analysis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

/// Returns a number, or null for infinity and NaN, which JSON lacks.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// Returns the columns that the tables of contacts and gaps have in common.
Table pairs_table(PackingAnalysis const& analysis, std::span<Contact const> pairs) {
  std::size_t const disks = analysis.packing.size();
  std::vector<std::uint64_t> i, j, wall;
  std::vector<double> distance, normal_x, normal_y;
  for (Contact const& pair : pairs) {
    bool const is_at_wall = pair.second >= disks;
    i.push_back(analysis.ids[pair.first]);
    j.push_back(analysis.ids[is_at_wall ? pair.first : pair.second]);
    wall.push_back(is_at_wall ? pair.second - disks + 1 : 0);
    distance.push_back(pair.distance);
    normal_x.push_back(pair.normal.x);
    normal_y.push_back(pair.normal.y);
  }
  Table table;
  table.add_column("i", std::move(i));
  table.add_column("j", std::move(j));
  table.add_column("wall", std::move(wall));
  table.add_column("distance", std::move(distance));
  table.add_column("normal_x", std::move(normal_x));
  table.add_column("normal_y", std::move(normal_y));
  return table;
}

/// Adds the columns image_x and image_y: the number of box sides by which the image of the second disk is displaced.
void add_images(Table& table, Packing const& packing, std::span<Contact const> pairs) {
  std::vector<double> x, y;
  for (Contact const& pair : pairs) {
    bool const is_at_wall = pair.second >= packing.size();
    std::uint32_t const j = is_at_wall ? pair.first : pair.second;
    Vector const separation = is_at_wall ? Vector{} : pair.distance * pair.normal;
    Vector const moved =
        Vector{packing.x[pair.first], packing.y[pair.first]} + separation - Vector{packing.x[j], packing.y[j]};
    double const image_y = std::round(moved.y / packing.box.height());
    x.push_back(std::round((moved.x - image_y * packing.box.shift()) / packing.box.width()) + 0.0);
    y.push_back(image_y + 0.0);
  }
  table.add_column("image_x", std::move(x));
  table.add_column("image_y", std::move(y));
}

std::vector<double> overlaps_of(std::span<Contact const> pairs, double sign) {
  std::vector<double> overlaps;
  for (Contact const& pair : pairs) overlaps.push_back(sign * pair.overlap());
  return overlaps;
}

/// Adds the elastic moduli; all are null if the packing has none.
void add_elasticity(Json& json, PackingAnalysis const& analysis) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  ElasticModuli const moduli = analysis.moduli.value_or(ElasticModuli{nan, nan, nan, nan, nan, nan});
  json["bulk_modulus"] = number(moduli.bulk());
  json["shear_modulus"] = number(moduli.shear());
  json["shear_modulus_xy"] = number(moduli.shear_xy());
  json["shear_modulus_xx_yy"] = number(moduli.shear_xx_yy());
  json["simple_shear_modulus"] = number(simple_shear_modulus(moduli, analysis.network));
  json["pure_shear_modulus"] = number(pure_shear_modulus(moduli, analysis.network));
  json["least_shear_modulus"] = number(moduli.min_shear());
  json["elastic_xxxx"] = number(moduli.xxxx);
  json["elastic_yyyy"] = number(moduli.yyyy);
  json["elastic_xyxy"] = number(moduli.xyxy);
  json["elastic_xxyy"] = number(moduli.xxyy);
  json["elastic_xxxy"] = number(moduli.xxxy);
  json["elastic_yyxy"] = number(moduli.yyxy);
  json["softest_mode"] = analysis.softest_mode ? number(analysis.softest_mode->eigenvalue) : Json(nullptr);
}

void put_inside(Packing& packing) {
  for (std::size_t i = 0; i < packing.size(); ++i) {
    Vector const place = packing.box.inside({packing.x[i], packing.y[i]});
    packing.x[i] = place.x;
    packing.y[i] = place.y;
  }
}

}  // namespace

std::optional<bool> is_jammed(PackingAnalysis const& analysis) {
  std::optional<double> mode;
  if (analysis.softest_mode) mode = analysis.softest_mode->eigenvalue;
  return analysis.network.is_jammed(analysis.questions.largest_residual, mode);
}

PackingAnalysis find_contacts_of(State const& state, PackingQuestions const& questions) {
  auto const ids = state.agents.ids();
  PackingAnalysis analysis{.packing = packing_of(state), .ids = {ids.begin(), ids.end()}, .questions = questions};
  std::ranges::sort(analysis.ids);
  put_inside(analysis.packing);
  analysis.network = find_contact_network(analysis.packing, questions.potential, questions.tolerance);
  return analysis;
}

PackingAnalysis analyse_packing(State const& state, PackingQuestions const& questions) {
  PackingAnalysis analysis = find_contacts_of(state, questions);
  analysis.gaps = find_gaps(analysis.packing, analysis.network, questions.largest_gap);
  if (analysis.network.is_converged(questions.largest_residual)) {
    analysis.moduli = find_elastic_moduli(analysis.packing, analysis.network);
    analysis.softest_mode = find_softest_mode(analysis.network);
  }
  return analysis;
}

Table contacts_table(PackingAnalysis const& analysis) {
  ContactNetwork const& network = analysis.network;
  Table table = pairs_table(analysis, network.contacts);
  table.add_column("overlap", overlaps_of(network.contacts, 1.0));
  table.add_column("force", network.forces);
  add_images(table, analysis.packing, network.contacts);
  table.add_column("backbone",
                   std::vector<std::uint64_t>(network.is_of_backbone.begin(), network.is_of_backbone.end()));
  return table;
}

Table gaps_table(PackingAnalysis const& analysis) {
  Table table = pairs_table(analysis, analysis.gaps);
  table.add_column("gap", overlaps_of(analysis.gaps, -1.0));
  add_images(table, analysis.packing, analysis.gaps);
  return table;
}

Table forces_table(PackingAnalysis const& analysis) {
  std::vector<RelativeForce> const forces = relative_forces_of(analysis.network);
  auto const bucklers = std::ranges::count(forces, true, &RelativeForce::is_of_buckler);
  std::array<double, 2> const counts{static_cast<double>(forces.size()) - static_cast<double>(bucklers),
                                     static_cast<double>(bucklers)};
  std::array<double, 2> seen{};
  std::vector<Contact> contacts;
  std::vector<double> relative, share;
  std::vector<std::uint64_t> buckler;
  for (RelativeForce const& force : forces) {
    std::size_t const kind = force.is_of_buckler ? 1 : 0;
    contacts.push_back(analysis.network.contacts[force.contact]);
    relative.push_back(force.force);
    buckler.push_back(kind);
    share.push_back(++seen[kind] / counts[kind]);
  }
  Table const pairs = pairs_table(analysis, contacts);
  Table table;
  for (char const* const name : {"i", "j", "wall"}) table.add_column(name, pairs.column(name));
  table.add_column("relative_force", std::move(relative));
  table.add_column("buckler", std::move(buckler));
  table.add_column("share", std::move(share));
  return table;
}

Json summary_of(PackingAnalysis const& analysis) {
  ContactNetwork const& network = analysis.network;
  auto const disks = static_cast<double>(network.size());
  double const largest_residual = analysis.questions.largest_residual;
  Json json;
  json["potential"] = to_text(network.potential);
  json["tolerance"] = network.tolerance;
  json["disks"] = network.size();
  json["packing_fraction"] = packing_fraction(analysis.packing);
  json["smallest_diameter"] = network.smallest_diameter;
  json["contacts"] = network.contacts.size();
  json["contact_number"] = number(network.contact_number());
  json["mean_coordination"] = number(network.mean_coordination());
  json["backbone_disks"] = network.backbone_disks;
  json["backbone_contacts"] = network.backbone_contacts;
  json["rattler_share"] = number(1.0 - static_cast<double>(network.backbone_disks) / disks);
  json["excess_contacts"] = network.excess_contacts();
  json["energy_per_disk"] = number(network.energy / disks);
  json["pressure"] = network.pressure;
  json["stress_xx"] = network.stress.xx;
  json["stress_yy"] = network.stress.yy;
  json["stress_xy"] = network.stress.xy;
  json["residual_force"] = network.residual_force;
  json["rms_residual_force"] = network.rms_residual_force;
  add_elasticity(json, analysis);
  json["is_converged"] = network.is_converged(largest_residual);
  std::optional<bool> const jammed = is_jammed(analysis);
  json["is_jammed"] = jammed ? Json(*jammed) : Json(nullptr);
  json["is_shear_stable"] = analysis.moduli ? Json(analysis.moduli->is_shear_stable()) : Json(nullptr);
  return json;
}

}  // namespace gridlock
