#include <algorithm>
#include <cmath>

#include "engine/soft/forces.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself;
// target() chooses the kernel. With AVX-512 that for AVX2 is used. SVE is left out: its registers have no fixed size.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/soft/forces_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::soft::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using gridlock::HWY_NAMESPACE::nearest_image;
using gridlock::HWY_NAMESPACE::pairs_of;
using gridlock::HWY_NAMESPACE::squared_length;
using gridlock::HWY_NAMESPACE::Vectors;

namespace {

using Numbers = hn::CappedTag<double, entries_at_once>;
using Vec = hn::Vec<Numbers>;
constexpr std::size_t lanes = hn::MaxLanes(Numbers());

template <class N>
HWY_INLINE N broadcast(double value) {
  return hn::Set(Numbers(), value);
}
HWY_INLINE Vec square_root(Vec value) { return hn::Sqrt(value); }

#include "core/pair_pushes-inl.hpp"

HWY_INLINE Vec contact_distances(Disks const& disks, double radius, std::uint32_t const* others) {
  HWY_ALIGN double sums[lanes];
  for (std::size_t k = 0; k < lanes; ++k) sums[k] = radius + disks.identities[others[k]].radius;
  return hn::Load(Numbers(), sums);
}

/// Adds up the pushes of the neighbours of one disk.
template <class Push, bool are_equal, bool is_bounded>
struct Sum {
  ForceRule const& rule;
  Disks const& disks;
  Push push{rule.constants};
  Vec sigma = hn::Set(Numbers(), rule.sigma);
  Vec squared_cutoff = hn::Set(Numbers(), (rule.constants.cutoff * rule.sigma) * (rule.constants.cutoff * rule.sigma));
  Vec rounding = hn::Set(Numbers(), rule.rounding);
  Vec largest_push = hn::Zero(Numbers());

  template <bool is_at_edge>
  HWY_INLINE Vector of(std::size_t row, std::uint32_t const* from, std::uint32_t const* end) {
    Numbers const tag;
    Vec const own_x = hn::Set(tag, disks.places[row].x);
    Vec const own_y = hn::Set(tag, disks.places[row].y);
    Vec sum_x = hn::Zero(tag);
    Vec sum_y = hn::Zero(tag);
    for (; from != end; from += lanes) {
      double const* places[lanes];
      for (std::size_t k = 0; k < lanes; ++k) places[k] = &disks.places[from[k]].x;
      Vectors<Numbers> const others = pairs_of(tag, places);
      Vec x = hn::Sub(own_x, others.x);
      Vec y = hn::Sub(own_y, others.y);
      if constexpr (is_at_edge) {
        Vec const shift = hn::Set(tag, rule.shift);
        x = hn::Sub(x, hn::IfThenElseZero(hn::Gt(y, hn::Set(tag, 0.5 * rule.period_y)), shift));
        x = hn::Add(x, hn::IfThenElseZero(hn::Lt(y, hn::Set(tag, -0.5 * rule.period_y)), shift));
        x = nearest_image(x, rule.period_x);
        y = nearest_image(y, rule.period_y);
      }
      Vec const square = squared_length(x, y);
      Vec contact = sigma;
      Vec limit = squared_cutoff;
      if constexpr (!are_equal) {
        contact = contact_distances(disks, disks.identities[row].radius, from);
        Vec const cutoff = hn::Mul(hn::Set(tag, rule.constants.cutoff), contact);
        limit = hn::Mul(cutoff, cutoff);
      }
      auto is_near = hn::Lt(square, limit);
      if constexpr (is_bounded) is_near = hn::And(is_near, hn::Gt(square, hn::Zero(tag)));
      Vec const strength = hn::IfThenElseZero(is_near, push(square, contact));
      if constexpr (!is_bounded) largest_push = hn::Max(largest_push, strength);
      sum_x = hn::Add(sum_x, hn::IfThenElseZero(is_near, rounded(hn::Mul(strength, x))));
      sum_y = hn::Add(sum_y, hn::IfThenElseZero(is_near, rounded(hn::Mul(strength, y))));
    }
    return {hn::GetLane(hn::SumOfLanes(tag, sum_x)), hn::GetLane(hn::SumOfLanes(tag, sum_y))};
  }

  HWY_INLINE Vec rounded(Vec force) const { return hn::Sub(hn::Add(force, rounding), rounding); }
};

template <class Push, bool are_equal, bool is_bounded>
double compute(ForceRule const& rule, Band const& band, Disks& disks) {
  Sum<Push, are_equal, is_bounded> sum{rule, disks};
  std::uint32_t const* const entries = band.entries.data();
  for (std::size_t k = 0; k < band.is_at_edge.size(); ++k) {
    std::size_t const row = band.first + k;
    std::uint32_t const* const from = entries + band.begin[k];
    std::uint32_t const* const end = entries + band.begin[k + 1];
    disks.motions[row].force =
        band.is_at_edge[k] != 0 ? sum.template of<true>(row, from, end) : sum.template of<false>(row, from, end);
  }
  return hn::GetLane(hn::MaxOfLanes(Numbers(), sum.largest_push));
}

template <template <class> class Push, bool is_bounded>
ComputeForces of_sizes(ForceRule const& rule) {
  return rule.sigma > 0.0 ? compute<Push<Vec>, true, is_bounded> : compute<Push<Vec>, false, is_bounded>;
}

}  // namespace

ComputeForces forces(ForceRule const& rule) {
  switch (rule.kind) {
    case PairPotential::harmonic:
      return of_sizes<HarmonicPush, true>(rule);
    case PairPotential::hertzian:
      return of_sizes<HertzianPush, true>(rule);
    case PairPotential::inverse_power:
      return of_sizes<InversePowerPush, false>(rule);
    case PairPotential::wca:
    case PairPotential::lennard_jones:
    case PairPotential::table:
      break;
  }
  return of_sizes<LennardJonesPush, false>(rule);
}

}  // namespace gridlock::soft::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock::soft {

namespace {

/// Computes the forces by push(squared distance, contact distance), pair by pair.
template <class Push>
double compute_by(ForceRule const& rule, Band const& band, Disks& disks, Push push_of) {
  Box const box = Box(rule.period_x, rule.period_y, Edge::periodic).shifted(rule.shift);
  bool const has_limit = !is_bounded(rule.kind);
  double largest_push = 0.0;
  for (std::size_t k = 0; k < band.is_at_edge.size(); ++k) {
    std::size_t const row = band.first + k;
    Vector force;
    for_each_neighbour(band, k, box, disks, [&](std::uint32_t other, Vector d) {
      double const sigma = disks.identities[row].radius + disks.identities[other].radius;
      double const square = squared_length(d);
      double const limit = rule.constants.cutoff * sigma;
      if (!(square < limit * limit)) return;
      double const push = push_of(square, sigma);
      if (has_limit) largest_push = std::max(largest_push, push);
      force = force + Vector{rounded(push * d.x, rule.rounding), rounded(push * d.y, rule.rounding)};
    });
    disks.motions[row].force = force;
  }
  return largest_push;
}

double compute_plain(ForceRule const& rule, Band const& band, Disks& disks) {
  return compute_by(rule, band, disks, [&](double square, double sigma) { return rule.law.push(square, sigma); });
}

/// Computes the forces of a table, which has to look up each pair by itself.
double compute_by_table(ForceRule const& rule, Band const& band, Disks& disks) {
  EnergyTable const& table = rule.law.table();
  double const energy = rule.constants.energy;
  return compute_by(rule, band, disks, [&](double square, double sigma) { return energy * table.push(square, sigma); });
}

}  // namespace

ComputeForces forces_for([[maybe_unused]] Target target, [[maybe_unused]] ForceRule const& rule) {
  if (rule.kind == PairPotential::table) return compute_by_table;
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) return N_SSE4::forces(rule);
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2 || target == Target::avx512) return N_AVX2::forces(rule);
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) return N_NEON::forces(rule);
#endif
  return compute_plain;
}

}  // namespace gridlock::soft

#endif
