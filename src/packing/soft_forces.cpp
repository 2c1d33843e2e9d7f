#include "packing/soft_forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/avx512.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "packing/potential.hpp"
#include "packing/walls.hpp"

namespace gridlock {

namespace {

/// Disks whose forces and sums are one piece of work; the bits of sums depend on it.
constexpr std::size_t block_size = 256;

/// An entry of the list: a partner, and which of its images, up to `farthest_image` boxes away in each direction.
constexpr std::uint32_t partner_bits = 26;
constexpr std::uint32_t partner_mask = (1U << partner_bits) - 1;
constexpr int farthest_image = 3;
constexpr int images_across = 2 * farthest_image + 1;

std::size_t blocks_of(std::size_t disks) { return (disks + block_size - 1) / block_size; }

int image_of(double separation, double nearest, double side) {
  auto const image = static_cast<int>(std::lround((nearest - separation) / side));
  if (std::abs(image) > farthest_image)
    throw RunFailure("a soft disk has moved farther than three boxes while energy was minimized");
  return image;
}

}  // namespace

void ForceSums::add(ForceSums const& part) {
  energy += part.energy;
  contact_forces += part.contact_forces;
  overlaps += part.overlaps;
  contacts += part.contacts;
  largest_square = std::max(largest_square, part.largest_square);
  force_squares += part.force_squares;
  power += part.power;
  speed_squares += part.speed_squares;
}

double ForceSums::residual() const {
  if (contacts == 0) return 0.0;
  return std::sqrt(largest_square) * static_cast<double>(contacts) / contact_forces;
}

SoftForces::SoftForces(Packing const& packing, Potential potential, std::uint64_t threads)
    : potential_(potential), pool_(packing.size() > 4 * block_size ? threads : 1) {
  if (packing.size() > partner_mask) {
    throw Error({.what = fmt::format("{} soft disks; at most {} can be minimized", packing.size(), partner_mask),
                 .hint = "use fewer disks",
                 .key = "disks.count"});
  }
  for (int y = -farthest_image; y <= farthest_image; ++y) {
    for (int x = -farthest_image; x <= farthest_image; ++x) {
      shifts_.push_back({x * packing.box.width(), y * packing.box.height()});
    }
  }
}

std::uint32_t SoftForces::entry_of(Packing const& packing, std::uint32_t i, std::uint32_t j) const {
  if (!packing.box.is_periodic()) return j | (static_cast<std::uint32_t>(shifts_.size() / 2) << partner_bits);
  Vector const from{packing.x[i], packing.y[i]};
  Vector const to{packing.x[j], packing.y[j]};
  Vector const nearest = packing.box.displacement(from, to);
  Vector const d = to - from;
  int const image_x = image_of(d.x, nearest.x, packing.box.width());
  int const image_y = image_of(d.y, nearest.y, packing.box.height());
  int const code = (image_y + farthest_image) * images_across + image_x + farthest_image;
  return j | (static_cast<std::uint32_t>(code) << partner_bits);
}

bool SoftForces::is_outdated(Packing const& packing) const {
  if (built_radii_.size() != packing.size() || begin_.empty()) return true;
  double growth = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < packing.size(); ++i) {
    growth = std::max(growth, packing.radius[i] - built_radii_[i]);
    double const dx = packing.x[i] - built_at_.x[i];
    double const dy = packing.y[i] - built_at_.y[i];
    square = std::max(square, dx * dx + dy * dy);
  }
  return 2.0 * (std::sqrt(square) + growth) >= skin_;
}

void SoftForces::refresh(Packing const& packing) {
  if (is_outdated(packing)) build(packing);
}

void SoftForces::build(Packing const& packing) {
  double const largest = largest_contact_distance(packing.radius);
  skin_ = skin_of_smallest_ * smallest_diameter(packing);
  if (packing.box.is_periodic() && packing.size() > 1) {
    double const half = 0.5 * std::min(packing.box.width(), packing.box.height());
    skin_ = std::min(skin_, 0.999 * half - largest);
    if (!(skin_ > 1e-3 * largest)) {
      throw Error({.what = fmt::format(
                       "in a periodic box of {} × {} a disk could touch two images of the same partner; these disks "
                       "need sides above {:.6g}",
                       packing.box.width(), packing.box.height(), 2.01 * largest),
                   .hint = "use more disks or a lower packing fraction",
                   .key = "disks"});
    }
  }
  std::size_t const disks = packing.size();
  built_at_.x = packing.x;
  built_at_.y = packing.y;
  built_radii_ = packing.radius;
  begin_.assign(disks + 1, 0);
  entries_.clear();
  if (disks < 2) return;
  bool const is_half = pool_.size() == 1;
  PointPairs const pairs = find_pairs(packing.box, largest + skin_,
                                      {.x = packing.x.data(), .y = packing.y.data(), .count = disks}, pool_.size());
  auto const for_each_near_pair = [&](auto visit) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      auto const [i, j] = std::minmax(pairs.first()[k], pairs.second()[k]);
      double const cutoff = packing.radius[i] + packing.radius[j] + skin_;
      Vector const d = packing.box.displacement({packing.x[i], packing.y[i]}, {packing.x[j], packing.y[j]});
      if (squared_length(d) >= cutoff * cutoff) continue;
      visit(i, j);
      if (!is_half) visit(j, i);
    }
  };
  for_each_near_pair([&](std::uint32_t i, std::uint32_t /*j*/) { ++begin_[i + 1]; });
  for (std::size_t i = 0; i < disks; ++i) begin_[i + 1] += begin_[i];
  entries_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for_each_near_pair([&](std::uint32_t i, std::uint32_t j) { entries_[next[i]++] = entry_of(packing, i, j); });
  for (std::size_t i = 0; i < disks; ++i) {
    std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(begin_[i]),
              entries_.begin() + static_cast<std::ptrdiff_t>(begin_[i + 1]),
              [](std::uint32_t a, std::uint32_t b) { return (a & partner_mask) < (b & partner_mask); });
  }
}

void SoftForces::Touching::make_room_for(std::size_t entries) {
  if (first.size() > entries) return;
  std::size_t const size = 2 * entries + 1;  // one place behind the last is written and not kept
  for (auto* column : {&dx, &dy, &square, &sigma, &overlap, &force, &scale}) column->resize(size);
  first.resize(size);
  second.resize(size);
}

std::size_t SoftForces::find_touching(Packing const& packing, std::size_t first, std::size_t end,
                                      Touching& touching) const {
  double const* const x = packing.x.data();
  double const* const y = packing.y.data();
  double const* const radius = packing.radius.data();
  std::size_t count = 0;
  for (std::size_t i = first; i < end; ++i) {
    double const own_x = x[i];
    double const own_y = y[i];
    double const own_radius = radius[i];
    for (std::size_t k = begin_[i]; k < begin_[i + 1]; ++k) {
      std::uint32_t const j = entries_[k] & partner_mask;
      Vector const shift = shifts_[entries_[k] >> partner_bits];
      double const dx = (x[j] - own_x) + shift.x;
      double const dy = (y[j] - own_y) + shift.y;
      double const square = dx * dx + dy * dy;
      double const sigma = own_radius + radius[j];
      touching.first[count] = static_cast<std::uint32_t>(i);
      touching.second[count] = j;
      touching.dx[count] = dx;
      touching.dy[count] = dy;
      touching.square[count] = square;
      touching.sigma[count] = sigma;
      count += square < sigma * sigma ? 1 : 0;
    }
  }
  return count;
}

#ifdef GRIDLOCK_AVX512
/// The same operations as below eight at a time, as long as there are eight; returns how many are done.
template <Potential potential>
GRIDLOCK_AVX512 std::size_t SoftForces::compute_eight_pushes(Touching& touching, std::size_t count) {
  __m512d const one = _mm512_set1_pd(1.0);
  std::size_t k = 0;
  for (; k + 8 <= count; k += 8) {
    __m512d const sigma = _mm512_loadu_pd(&touching.sigma[k]);
    __m512d const distance = _mm512_sqrt_pd(_mm512_loadu_pd(&touching.square[k]));
    __m512d const overlap = _mm512_sub_pd(one, _mm512_div_pd(distance, sigma));
    __m512d strength = overlap;
    if constexpr (potential == Potential::hertzian) strength = _mm512_mul_pd(overlap, _mm512_sqrt_pd(overlap));
    __m512d const force = _mm512_div_pd(strength, sigma);
    _mm512_storeu_pd(&touching.overlap[k], overlap);
    _mm512_storeu_pd(&touching.force[k], force);
    _mm512_storeu_pd(&touching.scale[k], _mm512_div_pd(force, distance));
  }
  return k;
}
#endif

template <Potential potential>
void SoftForces::compute_pushes(Touching& touching, std::size_t count) {
  std::size_t k = 0;
#ifdef GRIDLOCK_AVX512
  if (has_avx512()) k = compute_eight_pushes<potential>(touching, count);
#endif
  for (; k < count; ++k) {
    double const sigma = touching.sigma[k];
    double const distance = std::sqrt(touching.square[k]);
    double const overlap = 1.0 - distance / sigma;
    double const strength = potential == Potential::harmonic ? overlap : overlap * std::sqrt(overlap);
    double const force = strength / sigma;
    touching.overlap[k] = overlap;
    touching.force[k] = force;
    touching.scale[k] = force / distance;
  }
}

template <Potential potential>
void SoftForces::push_from_walls(Packing const& packing, std::size_t first, std::size_t end, Columns& forces,
                                 ForceSums& sums) {
  Law const law(potential);
  for (std::size_t i = first; i < end; ++i) {
    double const radius = packing.radius[i];
    for_each_wall(packing.box, {packing.x[i], packing.y[i]}, radius,
                  [&](Counters::Wall /*wall*/, double distance, Vector outward) {
                    double const overlap = 1.0 - distance / radius;
                    double const force = law.force(overlap, radius);
                    forces.x[i] -= force * outward.x;
                    forces.y[i] -= force * outward.y;
                    sums.count(law.energy(overlap), force, overlap);
                  });
  }
}

/// With is_half every pair is in the list of its lower number alone, and gives its force to both: by the time a disk's own list is
/// reached, all lower numbers have given theirs, in order. Otherwise a disk takes all its forces itself, in the same order.
///
/// Which entries are in contact cannot be predicted: they are gathered without a branch, then computed together.
template <Potential potential, bool is_half>
ForceSums SoftForces::evaluate_block(Packing const& packing, Columns const& velocities, Columns& forces,
                                     std::size_t block) const {
  std::size_t const first = block * block_size;
  std::size_t const end = std::min(first + block_size, packing.size());
  thread_local Touching touching;
  touching.make_room_for(begin_[end] - begin_[first]);
  std::size_t const count = find_touching(packing, first, end, touching);
  compute_pushes<potential>(touching, count);
  ForceSums sums;
  double* const force_x = forces.x.data();
  double* const force_y = forces.y.data();
  if constexpr (!is_half) {
    std::fill(force_x + first, force_x + end, 0.0);
    std::fill(force_y + first, force_y + end, 0.0);
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (touching.overlap[k] <= 0.0) [[unlikely]]
      continue;
    std::uint32_t const i = touching.first[k];
    std::uint32_t const j = touching.second[k];
    double push_x = touching.scale[k] * touching.dx[k];
    double push_y = touching.scale[k] * touching.dy[k];
    if (touching.square[k] == 0.0) [[unlikely]] {
      push_x = j > i ? touching.force[k] : -touching.force[k];  // two disks at one place: pushed apart along x
      push_y = 0.0;
    }
    force_x[i] -= push_x;
    force_y[i] -= push_y;
    if constexpr (is_half) {
      force_x[j] += push_x;
      force_y[j] += push_y;
    }
    if (is_half || j > i)
      sums.count(Law(potential).energy(touching.overlap[k]), touching.force[k], touching.overlap[k]);
  }
  if (!packing.box.is_periodic()) push_from_walls<potential>(packing, first, end, forces, sums);
  for (std::size_t i = first; i < end; ++i) {
    double const square = force_x[i] * force_x[i] + force_y[i] * force_y[i];
    double const vx = velocities.x[i];
    double const vy = velocities.y[i];
    sums.largest_square = std::max(sums.largest_square, square);
    sums.force_squares += square;
    sums.power += force_x[i] * vx + force_y[i] * vy;
    sums.speed_squares += vx * vx + vy * vy;
  }
  return sums;
}

template <Potential potential>
ForceSums SoftForces::evaluate_all(Packing const& packing, Columns const& velocities, Columns& forces) {
  std::size_t const blocks = blocks_of(packing.size());
  ForceSums sums;
  if (pool_.size() == 1) {
    std::ranges::fill(forces.x, 0.0);
    std::ranges::fill(forces.y, 0.0);
    for (std::size_t block = 0; block < blocks; ++block) {
      sums.add(evaluate_block<potential, true>(packing, velocities, forces, block));
    }
    return sums;
  }
  block_sums_.resize(blocks);
  pool_.for_each(blocks, [&](std::size_t block) {
    block_sums_[block] = evaluate_block<potential, false>(packing, velocities, forces, block);
  });
  for (ForceSums const& part : block_sums_) sums.add(part);
  return sums;
}

ForceSums SoftForces::evaluate(Packing const& packing, Columns const& velocities, Columns& forces) {
  refresh(packing);
  return potential_ == Potential::harmonic ? evaluate_all<Potential::harmonic>(packing, velocities, forces)
                                           : evaluate_all<Potential::hertzian>(packing, velocities, forces);
}

std::vector<Contact> SoftForces::contacts(Packing const& packing) {
  refresh(packing);
  std::vector<Contact> contacts;
  auto const disks = static_cast<std::uint32_t>(packing.size());
  for (std::uint32_t i = 0; i < disks; ++i) {
    for (std::size_t k = begin_[i]; k < begin_[i + 1]; ++k) {
      std::uint32_t const j = entries_[k] & partner_mask;
      if (j < i) continue;
      Vector const shift = shifts_[entries_[k] >> partner_bits];
      Vector const d{(packing.x[j] - packing.x[i]) + shift.x, (packing.y[j] - packing.y[i]) + shift.y};
      double const sigma = packing.radius[i] + packing.radius[j];
      double const distance = std::sqrt(squared_length(d));
      if (!(1.0 - distance / sigma > 0.0)) continue;
      Vector const normal = distance > 0.0 ? Vector{d.x / distance, d.y / distance} : Vector{1.0, 0.0};
      contacts.push_back({.first = i, .second = j, .normal = normal, .distance = distance, .contact_distance = sigma});
    }
    if (!packing.box.is_periodic()) add_wall_contacts(packing, i, 1.0, contacts);
  }
  return contacts;
}

}  // namespace gridlock
