#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "gridlock/analysis/spectral_density.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/elasticity.hpp"

namespace gridlock::python {

namespace {

using Numbers = nb::ndarray<double const, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

Packing packing_of(Points const& points, Numbers const& radii, BoxValues const& box) {
  Packing packing{.box = box_of(box), .x = {}, .y = {}, .radius = {radii.data(), radii.data() + radii.shape(0)}};
  for (std::size_t i = 0; i < points.shape(0); ++i) {
    double const x = points(i, 0);
    double const y = points(i, 1);
    packing.x.push_back(packing.box.is_periodic_x() ? image_inside(x, packing.box.width()) : x);
    packing.y.push_back(packing.box.is_periodic_y() ? image_inside(y, packing.box.height()) : y);
  }
  return packing;
}

auto array_of_flags(std::vector<bool> const& flags) {
  return owned_array(std::vector<std::uint8_t>(flags.begin(), flags.end()));
}

/// Adds the contacts: pairs and normals of shape (contacts, 2), distances and overlaps.
void add_contacts(NamedValues& result, std::span<Contact const> contacts, std::string const& prefix) {
  std::vector<std::uint32_t> pairs;
  std::vector<double> normals, distances, overlaps;
  for (Contact const& contact : contacts) {
    pairs.insert(pairs.end(), {contact.first, contact.second});
    normals.insert(normals.end(), {contact.normal.x, contact.normal.y});
    distances.push_back(contact.distance);
    overlaps.push_back(contact.overlap());
  }
  std::size_t const count = contacts.size();
  result[(prefix + "pairs").c_str()] = owned_array(std::move(pairs), {count, 2});
  result[(prefix + "normals").c_str()] = owned_array(std::move(normals), {count, 2});
  result[(prefix + "distances").c_str()] = owned_array(std::move(distances));
  result[(prefix + "overlaps").c_str()] = owned_array(std::move(overlaps));
}

void add_stiffness(NamedValues& result, ContactNetwork const& network, std::optional<ElasticModuli> const& moduli,
                   std::optional<VibrationMode> const& mode) {
  if (moduli) {
    result["elastic_constants"] =
        nb::make_tuple(moduli->xxxx, moduli->yyyy, moduli->xyxy, moduli->xxyy, moduli->xxxy, moduli->yyxy);
    result["bulk_modulus"] = moduli->bulk();
    result["shear_modulus"] = moduli->shear();
    result["simple_shear_modulus"] = simple_shear_modulus(*moduli, network);
    result["pure_shear_modulus"] = pure_shear_modulus(*moduli, network);
    result["least_shear_modulus"] = moduli->min_shear();
  }
  if (mode) {
    std::vector<double> displacement;
    for (Vector const& u : mode->displacement) displacement.insert(displacement.end(), {u.x, u.y});
    result["softest_mode"] = mode->eigenvalue;
    result["softest_displacements"] = owned_array(std::move(displacement), {mode->displacement.size(), 2});
  }
}

void add_network(NamedValues& result, ContactNetwork network, double largest_residual,
                 std::optional<VibrationMode> const& mode) {
  add_contacts(result, network.contacts, "");
  std::vector<double> relative;
  std::vector<bool> is_of_buckler;
  for (RelativeForce const& force : relative_forces_of(network)) {
    relative.push_back(force.force);
    is_of_buckler.push_back(force.is_of_buckler);
  }
  result["relative_forces"] = owned_array(std::move(relative));
  result["is_of_buckler"] = array_of_flags(is_of_buckler);
  result["is_of_backbone"] = array_of_flags(network.is_of_backbone);
  result["is_rattler"] = array_of_flags(network.is_rattler);
  result["backbone_disks"] = network.backbone_disks;
  result["backbone_contacts"] = network.backbone_contacts;
  result["contact_number"] = network.contact_number();
  result["mean_coordination"] = network.mean_coordination();
  result["excess_contacts"] = network.excess_contacts();
  result["energy"] = network.energy;
  result["pressure"] = network.pressure;
  result["stress"] = nb::make_tuple(network.stress.xx, network.stress.yy, network.stress.xy);
  result["residual_force"] = network.residual_force;
  result["rms_residual_force"] = network.rms_residual_force;
  result["smallest_diameter"] = network.smallest_diameter;
  result["is_converged"] = network.is_converged(largest_residual);
  auto const jammed = network.is_jammed(largest_residual, mode ? std::optional(mode->eigenvalue) : std::nullopt);
  result["is_jammed"] = jammed ? nb::cast(*jammed) : nb::none();
  result["forces"] = owned_array(std::move(network.forces));
  result["coordination"] = owned_array(std::move(network.coordination));
}

NamedValues contacts(Points const& points, Numbers const& radii, BoxValues const& box, bool is_harmonic,
                     double tolerance, double largest_gap, double largest_residual, bool finds_stiffness) {
  ContactNetwork network;
  std::vector<Contact> gaps;
  double fraction = 0.0;
  std::optional<ElasticModuli> moduli;
  std::optional<VibrationMode> mode;
  {
    nb::gil_scoped_release const released;
    Packing const packing = packing_of(points, radii, box);
    network = find_contact_network(packing, is_harmonic ? Potential::harmonic : Potential::hertzian, tolerance);
    gaps = find_gaps(packing, network, largest_gap);
    fraction = packing_fraction(packing);
    if (finds_stiffness && network.is_converged(largest_residual)) {
      moduli = find_elastic_moduli(packing, network);
      mode = find_softest_mode(network);
    }
  }
  NamedValues result;
  add_contacts(result, gaps, "gap_");
  add_stiffness(result, network, moduli, mode);
  result["packing_fraction"] = fraction;
  add_network(result, std::move(network), largest_residual, mode);
  return result;
}

/// Returns wave numbers and densities of rings.
auto spectral_density(Points const& points, Numbers const& radii, BoxValues const& box, double largest_q,
                      std::size_t bins, std::uint64_t threads) {
  SpectralDensity found;
  {
    nb::gil_scoped_release const released;
    found = find_spectral_density(box_of(box), view_of(points), std::span(radii.data(), radii.shape(0)), largest_q,
                                  bins, threads);
  }
  return std::tuple(owned_array(std::move(found.wave_number)), owned_array(std::move(found.density)),
                    owned_array(std::move(found.vectors)));
}

}  // namespace

void bind_packing(nb::module_& module) {
  module.def("contacts", &contacts, nb::arg("points"), nb::arg("radii"), nb::arg("box"), nb::arg("is_harmonic"),
             nb::arg("tolerance"), nb::arg("largest_gap"), nb::arg("largest_residual"), nb::arg("finds_stiffness"));
  module.def("spectral_density", &spectral_density, nb::arg("points"), nb::arg("radii"), nb::arg("box"),
             nb::arg("largest_q"), nb::arg("bins"), nb::arg("threads"));
}

}  // namespace gridlock::python
