#include "packing/soft_forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "core/avx512.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "packing/block_sums.hpp"
#include "packing/potential.hpp"
#include "packing/walls.hpp"

namespace gridlock {

namespace {

/// An entry of the list is a partner and, in higher bits, its image, up to `farthest_image` boxes away in x and in y.
constexpr std::uint32_t partner_bits = 26;
constexpr std::uint32_t partner_mask = (1U << partner_bits) - 1;
constexpr std::uint32_t image_bits = 3;  ///< number of bits for each direction
constexpr std::uint32_t image_mask = (1U << image_bits) - 1;
constexpr int farthest_image = 3;

int image_of(double separation, double nearest, double side) {
  auto const image = static_cast<int>(std::lround((nearest - separation) / side));
  if (std::abs(image) > farthest_image)
    throw RunFailure("a soft disk has moved farther than three boxes while energy was minimized");
  return image;
}

}  // namespace

ForceSums& ForceSums::operator+=(ForceSums const& part) {
  energy += part.energy;
  contact_forces += part.contact_forces;
  overlaps += part.overlaps;
  contacts += part.contacts;
  largest_square = std::max(largest_square, part.largest_square);
  force_squares += part.force_squares;
  power += part.power;
  speed_squares += part.speed_squares;
  pure_shear += part.pure_shear;
  simple_shear += part.simple_shear;
  return *this;
}

double ForceSums::over_mean_force(double square) const {
  if (contacts == 0) return 0.0;
  return std::sqrt(square) * static_cast<double>(contacts) / contact_forces;
}

SoftForces::SoftForces(Packing const& packing, Potential potential, std::uint64_t threads)
    : potential_(potential), pool_(packing.size() > 4 * block_size ? threads : 1) {
  if (packing.size() > partner_mask) {
    throw Error({.what = fmt::format("{} soft disks; at most {} can be minimized", packing.size(), partner_mask),
                 .hint = "use fewer disks",
                 .key = "disks.count"});
  }
}

Vector SoftForces::shift_of(std::uint32_t entry) const {
  std::uint32_t const image_y = entry >> (partner_bits + image_bits);
  return {shifts_x_[(entry >> partner_bits) & image_mask] + slants_[image_y], shifts_y_[image_y]};
}

void SoftForces::take_box(Box const& box) {
  box_ = box;
  std::size_t place = 0;
  for (int image = -farthest_image; image <= farthest_image; ++image, ++place) {
    shifts_x_[place] = image * box.width();
    shifts_y_[place] = image * box.height();
    slants_[place] = image * box.shift();
  }
}

std::uint32_t SoftForces::entry_of(Packing const& packing, std::uint32_t i, std::uint32_t j) const {
  int image_x = 0;
  int image_y = 0;
  if (packing.box.is_periodic()) {
    Vector const from{packing.x[i], packing.y[i]};
    Vector const to{packing.x[j], packing.y[j]};
    Vector const nearest = packing.box.displacement(from, to);
    Vector const d = to - from;
    image_y = image_of(d.y, nearest.y, packing.box.height());
    image_x = image_of(d.x + image_y * packing.box.shift(), nearest.x, packing.box.width());
  }
  auto const code_x = static_cast<std::uint32_t>(image_x + farthest_image);
  auto const code_y = static_cast<std::uint32_t>(image_y + farthest_image);
  return j | (code_x << partner_bits) | (code_y << (partner_bits + image_bits));
}

double SoftForces::update_rows(Packing const& packing) {
  struct Drift {
    double growth = 0.0;
    double square = 0.0;
    Drift& operator+=(Drift const& other) {
      growth = std::max(growth, other.growth);
      square = std::max(square, other.square);
      return *this;
    }
  };
  bool const is_first = built_radii_.size() != packing.size();
  rows_.resize(packing.size());
  // x ← a x + b y, y ← c y deforms the box of the last search into the present one.
  double const a = packing.box.width() / built_box_.width();
  double const c = packing.box.height() / built_box_.height();
  double const b = (packing.box.shift() - a * built_box_.shift()) / built_box_.height();
  auto const [growth, square] = sum_over_blocks<Drift>(packing.size(), pool_, [&](std::size_t first, std::size_t end) {
    Drift drift;
    for (std::size_t i = first; i < end; ++i) {
      rows_[i] = {.x = packing.x[i], .radius = packing.radius[i], .y = packing.y[i]};
      if (is_first) continue;
      double const dx = packing.x[i] - (a * built_at_.x[i] + b * built_at_.y[i]);
      double const dy = packing.y[i] - c * built_at_.y[i];
      drift += {.growth = packing.radius[i] - built_radii_[i], .square = dx * dx + dy * dy};
    }
    return drift;
  });
  double const strain = std::abs(a - 1.0) + std::abs(b) + std::abs(c - 1.0);
  return is_first ? std::numeric_limits<double>::infinity() : 2.0 * (std::sqrt(square) + growth) + strain * longest_;
}

void SoftForces::refresh(Packing const& packing) {
  bool const is_far = !(update_rows(packing) < skin_);
  if (is_far) build(packing);
  if (packing.box != box_) take_box(packing.box);
}

void SoftForces::build(Packing const& packing) {
  double const largest = largest_contact_distance(packing.radius);
  built_box_ = packing.box;
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
  longest_ = largest + skin_;
  std::size_t const disks = packing.size();
  built_at_.x = packing.x;
  built_at_.y = packing.y;
  built_radii_ = packing.radius;
  begin_.assign(disks + 1, 0);
  entries_.clear();
  owners_.clear();
  if (disks < 2) return;
  bool const is_half = pool_.size() == 1;
  PointPairs const pairs =
      find_pairs_of_disks(packing.box, {.gap = skin_}, {.x = packing.x.data(), .y = packing.y.data(), .count = disks},
                          packing.radius, pool_.size());
  auto const for_each_near_pair = [&](auto visit) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      auto const [i, j] = std::minmax(pairs.first()[k], pairs.second()[k]);
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
    owners_.insert(owners_.end(), begin_[i + 1] - begin_[i], static_cast<std::uint32_t>(i));
  }
}

void SoftForces::Touching::make_room_for(std::size_t entries) {
  if (first.size() > entries + 8) return;
  std::size_t const size = 2 * entries + 9;  // up to eight entries behind the last are written as scratch
  for (auto* column : {&dx, &dy, &square, &sigma, &overlap, &force, &scale}) column->resize(size);
  first.resize(size);
  second.resize(size);
}

#ifdef GRIDLOCK_AVX512
namespace {

/// Returns distance along x, contact distance, distance along y, and an unused number: of the entry in the lower half,
/// of the entry four behind it in the upper half.
GRIDLOCK_AVX512 __m512d pair_of_differences(SoftDiskRow const* rows, std::uint32_t const* entry,
                                            std::uint32_t const* owner) {
  __m256d const lower =
      _mm256_addsub_pd(_mm256_load_pd(&rows[entry[0] & partner_mask].x), _mm256_load_pd(&rows[owner[0]].x));
  __m256d const upper =
      _mm256_addsub_pd(_mm256_load_pd(&rows[entry[4] & partner_mask].x), _mm256_load_pd(&rows[owner[4]].x));
  return _mm512_insertf64x4(_mm512_castpd256_pd512(lower), upper, 1);
}

}  // namespace

GRIDLOCK_AVX512 std::size_t SoftForces::find_touching_of_eights(std::size_t first, std::size_t end, Touching& touching,
                                                                std::size_t& count) const {
  // Selects the first and third pair of numbers of each half of two registers, or the second and fourth.
  __m512i const first_pairs = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  __m512i const second_pairs = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  __m512d const shifts_x = _mm512_loadu_pd(shifts_x_.data());
  __m512d const shifts_y = _mm512_loadu_pd(shifts_y_.data());
  __m512d const slants = _mm512_loadu_pd(slants_.data());
  __m256i const partner = _mm256_set1_epi32(static_cast<int>(partner_mask));
  SoftDiskRow const* const rows = rows_.data();
  std::size_t k = first;
  for (; k + 8 <= end; k += 8) {
    std::uint32_t const* const entry = &entries_[k];
    std::uint32_t const* const owner = &owners_[k];
    __m512d const a = pair_of_differences(rows, entry, owner);
    __m512d const b = pair_of_differences(rows, entry + 1, owner + 1);
    __m512d const c = pair_of_differences(rows, entry + 2, owner + 2);
    __m512d const d = pair_of_differences(rows, entry + 3, owner + 3);
    __m512d const distances_ab = _mm512_unpacklo_pd(a, b);
    __m512d const distances_cd = _mm512_unpacklo_pd(c, d);
    __m512i const entries = _mm512_cvtepu32_epi64(_mm256_loadu_si256(reinterpret_cast<__m256i const*>(entry)));
    __m512i const images_y = _mm512_srli_epi64(entries, partner_bits + image_bits);
    __m512d const shift_y = _mm512_permutexvar_pd(images_y, shifts_y);
    __m512d const shift_x = _mm512_add_pd(_mm512_permutexvar_pd(_mm512_srli_epi64(entries, partner_bits), shifts_x),
                                          _mm512_permutexvar_pd(images_y, slants));
    __m512d const dx = _mm512_add_pd(_mm512_permutex2var_pd(distances_ab, first_pairs, distances_cd), shift_x);
    __m512d const dy = _mm512_add_pd(_mm512_permutex2var_pd(distances_ab, second_pairs, distances_cd), shift_y);
    __m512d const sigma = _mm512_permutex2var_pd(_mm512_unpackhi_pd(a, b), first_pairs, _mm512_unpackhi_pd(c, d));
    __m512d const square = _mm512_add_pd(_mm512_mul_pd(dx, dx), _mm512_mul_pd(dy, dy));
    __mmask8 const is_touching = _mm512_cmp_pd_mask(square, _mm512_mul_pd(sigma, sigma), _CMP_LT_OQ);
    _mm512_storeu_pd(&touching.dx[count], _mm512_maskz_compress_pd(is_touching, dx));
    _mm512_storeu_pd(&touching.dy[count], _mm512_maskz_compress_pd(is_touching, dy));
    _mm512_storeu_pd(&touching.square[count], _mm512_maskz_compress_pd(is_touching, square));
    _mm512_storeu_pd(&touching.sigma[count], _mm512_maskz_compress_pd(is_touching, sigma));
    __m256i const owners = _mm256_loadu_si256(reinterpret_cast<__m256i const*>(owner));
    __m256i const partners = _mm256_and_si256(_mm512_cvtepi64_epi32(entries), partner);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(&touching.first[count]),
                        _mm256_maskz_compress_epi32(is_touching, owners));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(&touching.second[count]),
                        _mm256_maskz_compress_epi32(is_touching, partners));
    count += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(is_touching)));
  }
  return k;
}
#endif

std::size_t SoftForces::find_touching(std::size_t first, std::size_t end, Touching& touching) const {
  std::size_t count = 0;
  std::size_t k = first;
#ifdef GRIDLOCK_AVX512
  if (uses_avx512()) k = find_touching_of_eights(first, end, touching, count);
#endif
  for (; k < end; ++k) {
    std::uint32_t const i = owners_[k];
    std::uint32_t const j = entries_[k] & partner_mask;
    SoftDiskRow const& own = rows_[i];
    SoftDiskRow const& other = rows_[j];
    Vector const shift = shift_of(entries_[k]);
    double const dx = (other.x - own.x) + shift.x;
    double const dy = (other.y - own.y) + shift.y;
    double const square = dx * dx + dy * dy;
    double const sigma = own.radius + other.radius;
    touching.first[count] = i;
    touching.second[count] = j;
    touching.dx[count] = dx;
    touching.dy[count] = dy;
    touching.square[count] = square;
    touching.sigma[count] = sigma;
    count += square < sigma * sigma ? 1 : 0;
  }
  return count;
}

#ifdef GRIDLOCK_AVX512
/// Computes eight pairs at a time by the operations below. Returns the number of pairs done, a multiple of eight.
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
  if (uses_avx512()) k = compute_eight_pushes<potential>(touching, count);
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

template <bool is_half>
void SoftForces::add_shear(Touching const& touching, std::size_t count, ForceSums& sums) {
  for (std::size_t k = 0; k < count; ++k) {
    bool const counts = is_half || touching.second[k] > touching.first[k];
    if (touching.overlap[k] <= 0.0 || touching.square[k] == 0.0 || !counts) continue;
    double const dx = touching.dx[k];
    double const dy = touching.dy[k];
    sums.pure_shear += 0.5 * touching.scale[k] * (dx * dx - dy * dy);
    sums.simple_shear += touching.scale[k] * (dx * dy);
  }
}

/// Computes the forces on a block of disks. With is_half every pair is in the list of its lower number alone and gives
/// its force to both disks, before the higher disk's own list is reached. Otherwise each disk adds all its forces
/// itself, in the same order.
///
/// Processors cannot predict which entries are in contact, so these are gathered without a branch, then computed
/// together.
template <Potential potential, bool is_half>
ForceSums SoftForces::evaluate_block(Packing const& packing, Columns const& velocities, Columns& forces,
                                     std::size_t first, std::size_t end) const {
  thread_local Touching touching;
  touching.make_room_for(begin_[end] - begin_[first]);
  std::size_t const count = find_touching(begin_[first], begin_[end], touching);
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
      push_x = j > i ? touching.force[k] : -touching.force[k];  // two centres at one point: pushed apart along x
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
  if (adds_up_shear_) add_shear<is_half>(touching, count, sums);
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
  if (pool_.size() == 1) {
    std::ranges::fill(forces.x, 0.0);
    std::ranges::fill(forces.y, 0.0);
    return sum_over_blocks<ForceSums>(packing.size(), pool_, [&](std::size_t first, std::size_t end) {
      return evaluate_block<potential, true>(packing, velocities, forces, first, end);
    });
  }
  return sum_over_blocks<ForceSums>(packing.size(), pool_, [&](std::size_t first, std::size_t end) {
    return evaluate_block<potential, false>(packing, velocities, forces, first, end);
  });
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
      Vector const shift = shift_of(entries_[k]);
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
