// Event-chain Monte Carlo beside the engine `exact`: equal disks in a periodic square, one core.
//
//     gridlock_bench_event_chain speed PACKING_FRACTION N [ROUNDS]
//     gridlock_bench_event_chain compare PACKING_FRACTION N SAMPLES COLLISIONS EQUILIBRATION SEED
//     gridlock_bench_event_chain straight|newtonian PACKING_FRACTION N SAMPLES EVENTS SEED [EVENTS_PER_CHAIN]
//
// speed: nanoseconds of processor time an event, in turns. compare: pressure, orientation and their correlation times
// from the same start, which `exact` made by EQUILIBRATION collisions a disk; a sample is taken every so many pair
// collisions of `exact`, and every so many events of the chains that all three decorrelate about equally.
//
// Straight chains: a disk moves along +x or +y until it touches the next one, which goes on, until the sum of all paths
// is ℓ (Bernard, Krauth & Wilson 2009, doi:10.1103/PhysRevE.80.056704). With jump the distance of the two centres along
// the chain at a contact, βP/ρ = 1 + Σ jump / Σ ℓ (Michel, Kapfer & Krauth 2014, doi:10.1063/1.4863991).
//
// Newtonian chains: each disk has a velocity; one disk moves by it while all others rest. At a contact the two
// velocities change as in an elastic collision, and the other disk goes on, until a given time has passed (Klement &
// Engel 2019, doi:10.1063/1.5090882). With v_n the velocity of the moving disk towards the other one,
//
//     βP/ρ = 1 + σ Σ v_n / (⟨v²⟩ t),    ⟨v²⟩ = Σ_i v_i² / N, which no collision changes.
//
// For the moving disk meets others at the rate ρ g(σ) σ ∫ dn̂ (v·n̂)₊, so that Σ v_n / t = ρ g(σ) σ · 2π · ⟨v²⟩/4, and
// βP/ρ = 1 + (π/2) ρ σ² g(σ). ⟨v²⟩ is exact for any N, since positions do not depend on velocities in equilibrium.
//
// A cell is so narrow (side ≤ σ/√2) that it holds one disk at most. So a grid of floats relative to the cells is all
// there is: no counts, no lists, no names of disks. One row of cells is one load. The grid has a margin of copies.

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <numbers>
#include <string_view>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

constexpr float nowhere = 1e10F;  ///< both coordinates of an empty cell

/// A cell of the grid: its place in the columns, its row and its column.
struct Cell {
  int place;
  int row;
  int column;
};

/// Cells of at most one disk, σ = 1, with a margin of copies at each edge.
class Cells {
 public:
  static constexpr int margin = 3;

  Cells(double side, std::vector<Vector> const& disks, std::vector<Vector> const& velocities)
      : cells_(static_cast<int>(std::floor(side * std::numbers::sqrt2 * (1.0 + 1e-6))) + 1),
        stride_(cells_ + 2 * margin + 8),
        width_(side / cells_) {
    auto const size = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(cells_ + 2 * margin);
    rough_x.assign(size, nowhere);
    rough_y.assign(size, nowhere);
    x.assign(size, 0.0);
    y.assign(size, 0.0);
    u.assign(velocities.empty() ? 0 : size, 0.0);
    v.assign(velocities.empty() ? 0 : size, 0.0);
    for (std::size_t i = 0; i < disks.size(); ++i) {
      int const column = std::min(static_cast<int>(disks[i].x / width_), cells_ - 1);
      int const row = std::min(static_cast<int>(disks[i].y / width_), cells_ - 1);
      Cell const cell = at(row, column);
      if (rough_x[cell.place] != nowhere) std::abort();
      put(cell, disks[i].x - column * width_, disks[i].y - row * width_);
      if (!velocities.empty()) {
        u[cell.place] = velocities[i].x;
        v[cell.place] = velocities[i].y;
      }
    }
  }

  [[nodiscard]] Cell at(int row, int column) const { return {(row + margin) * stride_ + column + margin, row, column}; }
  [[nodiscard]] int stride() const { return stride_; }
  [[nodiscard]] double width() const { return width_; }

  /// The cell so many rows and columns away, around the box.
  [[nodiscard]] Cell beside(Cell cell, int step, int rows, int columns) const {
    Cell other{cell.place + step, cell.row + rows, cell.column + columns};
    if (static_cast<unsigned>(other.row) >= static_cast<unsigned>(cells_) ||
        static_cast<unsigned>(other.column) >= static_cast<unsigned>(cells_)) [[unlikely]] {
      other = at((other.row + cells_) % cells_, (other.column + cells_) % cells_);
    }
    return other;
  }
  /// Writes the disk of a cell, with its copies.
  void put(Cell cell, double new_x, double new_y) {
    x[cell.place] = new_x;
    y[cell.place] = new_y;
    put_rough(cell, static_cast<float>(new_x), static_cast<float>(new_y));
  }
  void empty(Cell cell) { put_rough(cell, nowhere, nowhere); }
  /// Returns a disk chosen at random.
  [[nodiscard]] Cell random_disk(RandomStream& random) const {
    for (;;) {
      auto const k = random.below(static_cast<std::uint64_t>(cells_) * static_cast<std::uint64_t>(cells_));
      Cell const cell = at(static_cast<int>(k) / cells_, static_cast<int>(k) % cells_);
      if (rough_x[cell.place] != nowhere) return cell;
    }
  }
  [[nodiscard]] std::vector<Vector> disks() const {
    std::vector<Vector> result;
    for (int row = 0; row < cells_; ++row) {
      for (int column = 0; column < cells_; ++column) {
        int const k = at(row, column).place;
        if (rough_x[k] != nowhere) result.push_back({column * width_ + x[k], row * width_ + y[k]});
      }
    }
    return result;
  }

  std::vector<float> rough_x, rough_y;  ///< relative to the corner of the cell, rounded, with copies
  std::vector<double> x, y;             ///< the same, not rounded, without copies; anything in empty cells
  std::vector<double> u, v;             ///< velocities of Newtonian chains; 0 in the margin

 private:
  void put_rough(Cell cell, float new_x, float new_y) {
    rough_x[cell.place] = new_x;
    rough_y[cell.place] = new_y;
    auto const inner = static_cast<unsigned>(cells_ - 2 * margin);
    if (static_cast<unsigned>(cell.row - margin) >= inner || static_cast<unsigned>(cell.column - margin) >= inner)
        [[unlikely]] {
      copy(cell);
    }
  }
  [[gnu::noinline]] void copy(Cell cell) {
    for (int const row : {cell.row - cells_, cell.row, cell.row + cells_}) {
      if (row < -margin || row >= cells_ + margin) continue;
      for (int const column : {cell.column - cells_, cell.column, cell.column + cells_}) {
        if (column < -margin || column >= cells_ + margin) continue;
        int const k = at(row, column).place;
        rough_x[k] = rough_x[cell.place];
        rough_y[k] = rough_y[cell.place];
      }
    }
  }

  int cells_;
  int stride_;
  double width_;
};

/// A dynamics that advances by events and measures βP/ρ.
class Dynamics {
 public:
  Dynamics() = default;
  Dynamics(Dynamics const&) = delete;
  Dynamics& operator=(Dynamics const&) = delete;
  virtual ~Dynamics() = default;
  /// Advances by about so many events; returns βP/ρ while it does, whose weight in a mean is duration().
  virtual double advance(double events) = 0;
  [[nodiscard]] virtual std::vector<Vector> disks() const = 0;
  [[nodiscard]] std::uint64_t events() const { return events_; }
  [[nodiscard]] double duration() const { return duration_of_last_; }
  /// The sum of the displacements of all disks so far.
  [[nodiscard]] Vector displacement() const { return displacement_; }

 protected:
  std::uint64_t events_ = 0;
  double duration_of_last_ = 1.0;
  Vector displacement_;
};

using Wide = __m512;

inline Wide two_rows(float const* lower, float const* upper) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(lower)), _mm256_loadu_ps(upper), 1);
}
inline Wide four_rows(float const* first, int stride) {
  Wide rows = _mm512_castps128_ps512(_mm_loadu_ps(first));
  rows = _mm512_insertf32x4(rows, _mm_loadu_ps(first + stride), 1);
  rows = _mm512_insertf32x4(rows, _mm_loadu_ps(first + 2 * stride), 2);
  return _mm512_insertf32x4(rows, _mm_loadu_ps(first + 3 * stride), 3);
}
using Keys = __m512i;
/// Lower bounds of the paths to contact, (b − √(r² − c²)), of disks at b along and c across the way of the moving disk,
/// with the lane in the last six bits, so that the least key names its lane. Single precision errs by less than the
/// slack in b, and in r² − c² by less than the slack that is part of `squared`.
inline Keys keys(Wide along, Wide across, Wide squared, Wide slack, Keys lanes) {
  Wide const under_root = _mm512_fnmadd_ps(across, across, squared);
  __mmask16 const ahead = _mm512_cmp_ps_mask(along, slack, _CMP_GT_OQ);
  __mmask16 const hits = _mm512_mask_cmp_ps_mask(ahead, under_root, _mm512_setzero_ps(), _CMP_GT_OQ);
  Wide const path = _mm512_max_ps(_mm512_sub_ps(along, _mm512_sqrt_ps(under_root)), _mm512_setzero_ps());
  Keys const cut = _mm512_and_epi32(_mm512_castps_si512(path), _mm512_set1_epi32(~63));
  return _mm512_mask_or_epi32(_mm512_set1_epi32(std::numeric_limits<int>::max()), hits, cut, lanes);
}
/// The key of a path rounded up: keys of paths that may be shorter are less.
inline Keys above(double path) {
  auto const rounded = static_cast<float>(path) * (1.0F + 1e-6F);
  return _mm512_or_epi32(_mm512_castps_si512(_mm512_set1_ps(rounded)), _mm512_set1_epi32(63));
}
inline std::uint64_t lanes_below(Keys bound, Keys first, Keys second) {
  return _mm512_cmple_epu32_mask(first, bound) | static_cast<std::uint64_t>(_mm512_cmple_epu32_mask(second, bound))
                                                     << 16U;
}

/// Lanes of a window of cells: places relative to the cell of the moving disk, and steps from cell to cell.
struct Window {
  alignas(64) float column[64];
  alignas(64) float row[64];
  alignas(64) int lane[64];
  int step[64];
  int rows[64];
  int columns[64];
};
/// A window of rows and columns, `lanes` cells of a row side by side.
Window window(Cells const& cells, int first_row, int rows, int first_column, int columns, int lanes) {
  Window result{};
  for (int k = 0; k < 64; ++k) {
    int const row = first_row + k / lanes;
    int const column = first_column + k % lanes;
    bool const counts = k / lanes < rows && k % lanes < columns && (row != 0 || column != 0);
    result.row[k] = counts ? static_cast<float>(row * cells.width()) : nowhere;
    result.column[k] = counts ? static_cast<float>(column * cells.width()) : nowhere;
    result.lane[k] = k;
    result.step[k] = row * cells.stride() + column;
    result.rows[k] = row;
    result.columns[k] = column;
  }
  return result;
}

/// A disk that has moved, to be written once the cells around the next one have been read: a wide load that follows a
/// narrow store to the same place would wait for it. The next disk moves away from this one, so it need not see it.
struct Pending {
  Cell from;
  Cell to;
  double x;
  double y;

  void write(Cells& cells) const {
    if (from.place != to.place) cells.empty(from);
    cells.put(to, x, y);
  }
};

class StraightChains final : public Dynamics {
 public:
  StraightChains(double side, std::vector<Vector> const& disks, std::uint64_t seed, double length,
                 double events_per_chain)
      : cells_(side, disks, {}),
        length_(length),
        events_per_chain_(events_per_chain),
        seed_(seed),
        // Four cells ahead, so that a disk may leave its cell for the next one; two to each side.
        up_(window(cells_, 0, 4, -2, 5, 8)),
        right_(window(cells_, -2, 5, 0, 4, 4)) {}

  double advance(double events) override {
    // A number of chains, not of events: chains up to a number of events would count long ones too often.
    std::uint64_t const last = chains_ + std::max<std::uint64_t>(1, std::llround(events / events_per_chain_));
    double jumps = 0.0;
    double path = 0.0;
    while (chains_ < last) {
      RandomStream random(seed_, chains_, 0, Purpose::swap_trial);
      Cell const disk = cells_.random_disk(random);
      jumps += chains_ % 2 == 0 ? chain<false>(disk) : chain<true>(disk);
      path += length_;
      (chains_ % 2 == 0 ? displacement_.y : displacement_.x) += length_;
      ++chains_;
    }
    return 1.0 + jumps / path;
  }
  [[nodiscard]] std::vector<Vector> disks() const override { return cells_.disks(); }

 private:
  /// One chain along +x, or along +y; returns the sum of its jumps.
  template <bool Right>
  double chain(Cell cell) {
    float const* const along = Right ? cells_.rough_x.data() : cells_.rough_y.data();
    float const* const across = Right ? cells_.rough_y.data() : cells_.rough_x.data();
    double const* const alongs = Right ? cells_.x.data() : cells_.y.data();
    double const* const acrosses = Right ? cells_.y.data() : cells_.x.data();
    int const stride = cells_.stride();
    double const width = cells_.width();
    Window const& w = Right ? right_ : up_;
    float const* const w_along = Right ? w.column : w.row;
    float const* const w_across = Right ? w.row : w.column;
    Wide const one = _mm512_set1_ps(1.0F + 2e-6F);
    Wide const slack = _mm512_set1_ps(-1e-6F);
    Keys const lanes_0 = _mm512_load_epi32(w.lane);
    Keys const lanes_1 = _mm512_load_epi32(w.lane + 16);
    double rest = length_;
    double jumps = 0.0;
    std::uint64_t events = 0;
    double a = alongs[cell.place];
    double c = acrosses[cell.place];
    Pending pending{cell, cell, Right ? a : c, Right ? c : a};
    Cell from = cell;
    for (;;) {
      int const first = cell.place + (Right ? -2 * stride : -2);
      Wide const wide_a = _mm512_set1_ps(static_cast<float>(a));
      Wide const wide_c = _mm512_set1_ps(static_cast<float>(c));
      Wide along_0 = _mm512_sub_ps(_mm512_load_ps(w_along), wide_a);
      Wide along_1 = _mm512_sub_ps(_mm512_load_ps(w_along + 16), wide_a);
      Wide across_0 = _mm512_sub_ps(_mm512_load_ps(w_across), wide_c);
      Wide across_1 = _mm512_sub_ps(_mm512_load_ps(w_across + 16), wide_c);
      if constexpr (Right) {
        along_0 = _mm512_add_ps(along_0, four_rows(along + first, stride));
        across_0 = _mm512_add_ps(across_0, four_rows(across + first, stride));
        along_1 = _mm512_add_ps(along_1, _mm512_zextps128_ps512(_mm_loadu_ps(along + first + 4 * stride)));
        across_1 = _mm512_add_ps(across_1, _mm512_zextps128_ps512(_mm_loadu_ps(across + first + 4 * stride)));
      } else {
        along_0 = _mm512_add_ps(along_0, two_rows(along + first, along + first + stride));
        across_0 = _mm512_add_ps(across_0, two_rows(across + first, across + first + stride));
        along_1 = _mm512_add_ps(along_1, two_rows(along + first + 2 * stride, along + first + 3 * stride));
        across_1 = _mm512_add_ps(across_1, two_rows(across + first + 2 * stride, across + first + 3 * stride));
      }
      pending.write(cells_);
      Keys const keys_0 = keys(along_0, across_0, one, slack, lanes_0);
      Keys const keys_1 = keys(along_1, across_1, one, slack, lanes_1);
      std::uint32_t const least = _mm512_reduce_min_epu32(_mm512_min_epu32(keys_0, keys_1));
      double path = std::min(2.0 * width - a, rest);
      double jump = 0.0;
      Cell partner = cell;
      bool hits = false;
      auto const look = [&](unsigned lane) {
        Cell const other = cells_.beside(cell, w.step[lane], w.rows[lane], w.columns[lane]);
        double const b = alongs[other.place] + (Right ? w.columns[lane] : w.rows[lane]) * width - a;
        double const d = acrosses[other.place] + (Right ? w.rows[lane] : w.columns[lane]) * width - c;
        double const squared = 1.0 - d * d;
        if (b <= 0.0 || squared <= 0.0) return;
        double const root = std::sqrt(squared);
        if (b - root > path) return;
        path = std::max(b - root, 0.0);
        jump = root;
        partner = other;
        hits = true;
      };
      if (std::bit_cast<float>(least & ~63U) <= static_cast<float>(path)) [[likely]] {
        look(least & 63U);
        for (std::uint64_t others = lanes_below(above(path), keys_0, keys_1) & ~(std::uint64_t{1} << (least & 63U));
             others != 0; others &= others - 1)
          [[unlikely]] { look(static_cast<unsigned>(__builtin_ctzll(others))); }
      }
      rest -= path;
      double moved = a + path;
      int const crossed = (moved >= width ? 1 : 0) + (moved >= 2.0 * width ? 1 : 0);
      moved = std::max(moved - crossed * width, 0.0);
      Cell const to = crossed == 0 ? cell
                                   : cells_.beside(cell, Right ? crossed : crossed * stride, Right ? 0 : crossed,
                                                   Right ? crossed : 0);
      if (hits) {
        pending = {from, to, Right ? moved : c, Right ? c : moved};
        jumps += jump;
        ++events;
        a = alongs[partner.place];
        c = acrosses[partner.place];
        cell = partner;
        from = partner;
      } else {
        pending = {from, to, Right ? moved : c, Right ? c : moved};
        if (rest <= 0.0) break;
        // The disk goes on in the second cell; where it came from is behind it. Nothing is written yet.
        cell = to;
        a = moved;
        pending = {from, from, cells_.x[from.place], cells_.y[from.place]};
      }
    }
    pending.write(cells_);
    events_ += events;
    return jumps;
  }

  Cells cells_;
  double length_;
  double events_per_chain_;
  std::uint64_t seed_;
  std::uint64_t chains_ = 0;
  Window up_;
  Window right_;
};

class NewtonianChains final : public Dynamics {
 public:
  NewtonianChains(double side, std::vector<Vector> const& disks, std::vector<Vector> const& velocities,
                  std::uint64_t seed, double duration, double events_per_chain)
      : cells_(side, disks, velocities),
        count_(static_cast<double>(disks.size())),
        duration_(duration),
        events_per_chain_(events_per_chain),
        seed_(seed),
        // Three cells to each side, so that a disk may leave its cell for one beside it.
        window_(window(cells_, -3, 7, -3, 7, 8)) {}

  double advance(double events) override {
    // A number of chains, not of events: chains up to a number of events would count long ones too often.
    std::uint64_t const last = chains_ + std::max<std::uint64_t>(1, std::llround(events / events_per_chain_));
    double virial = 0.0;
    double time = 0.0;
    double const before = mean_square();
    while (chains_ < last) {
      RandomStream random(seed_, chains_, 0, Purpose::swap_trial);
      virial += chain(cells_.random_disk(random));
      time += duration_;
      ++chains_;
    }
    return 1.0 + virial / (0.5 * (before + mean_square()) * time);
  }
  [[nodiscard]] std::vector<Vector> disks() const override { return cells_.disks(); }
  [[nodiscard]] double mean_square() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < cells_.u.size(); ++k) {
      if (cells_.rough_x[k] != nowhere) sum += cells_.u[k] * cells_.u[k] + cells_.v[k] * cells_.v[k];
    }
    return sum / count_;
  }

 private:
  /// One chain; returns the sum of v_n over its contacts.
  double chain(Cell cell) {
    float const* const xs = cells_.rough_x.data();
    float const* const ys = cells_.rough_y.data();
    int const stride = cells_.stride();
    double const width = cells_.width();
    double rest = duration_;
    double virial = 0.0;
    std::uint64_t events = 0;
    double x = cells_.x[cell.place];
    double y = cells_.y[cell.place];
    double u = cells_.u[cell.place];
    double v = cells_.v[cell.place];
    Pending pending{cell, cell, x, y};
    Cell from = cell;
    for (;;) {
      int const first = cell.place - 3 * stride - 3;
      Wide const wide_x = _mm512_set1_ps(static_cast<float>(x));
      Wide const wide_y = _mm512_set1_ps(static_cast<float>(y));
      auto const place = [](Wide rows, float const* origin, Wide self) {
        return _mm512_add_ps(rows, _mm512_sub_ps(_mm512_load_ps(origin), self));
      };
      Wide dxs[4];
      Wide dys[4];
      for (int k = 0; k < 3; ++k) {
        int const lower = first + 2 * k * stride;
        dxs[k] = place(two_rows(xs + lower, xs + lower + stride), window_.column + 16 * k, wide_x);
        dys[k] = place(two_rows(ys + lower, ys + lower + stride), window_.row + 16 * k, wide_y);
      }
      int const last = first + 6 * stride;
      dxs[3] = place(_mm512_zextps256_ps512(_mm256_loadu_ps(xs + last)), window_.column + 48, wide_x);
      dys[3] = place(_mm512_zextps256_ps512(_mm256_loadu_ps(ys + last)), window_.row + 48, wide_y);
      pending.write(cells_);
      double const speed_squared = u * u + v * v;
      double const inverse = 1.0 / speed_squared;
      auto const rough_u = static_cast<float>(u);
      auto const rough_v = static_cast<float>(v);
      Wide const wide_u = _mm512_set1_ps(rough_u);
      Wide const wide_v = _mm512_set1_ps(rough_v);
      Wide const squared = _mm512_set1_ps((rough_u * rough_u + rough_v * rough_v) * (1.0F + 2e-6F));
      Wide const slack = _mm512_set1_ps(-1e-6F * (std::abs(rough_u) + std::abs(rough_v)));
      auto const to_contact = [&](Wide dx, Wide dy, Keys lanes) {
        return keys(_mm512_fmadd_ps(dx, wide_u, _mm512_mul_ps(dy, wide_v)),
                    _mm512_fmsub_ps(dx, wide_v, _mm512_mul_ps(dy, wide_u)), squared, slack, lanes);
      };
      Keys found[4];
      for (int k = 0; k < 4; ++k) found[k] = to_contact(dxs[k], dys[k], _mm512_load_epi32(window_.lane + 16 * k));
      std::uint32_t const least = _mm512_reduce_min_epu32(
          _mm512_min_epu32(_mm512_min_epu32(found[0], found[1]), _mm512_min_epu32(found[2], found[3])));
      double const to_column = u == 0.0 ? 1e9 : ((u > 0.0 ? 2.0 * width : -width) - x) / u;
      double const to_row = v == 0.0 ? 1e9 : ((v > 0.0 ? 2.0 * width : -width) - y) / v;
      double const border = std::min(to_column, to_row);
      // Times times the squared speed, as the bounds.
      double path = std::min(border, rest) * speed_squared;
      Cell partner = cell;
      double dx = 0.0;
      double dy = 0.0;
      bool hits = false;
      auto const look = [&](unsigned lane) {
        Cell const other = cells_.beside(cell, window_.step[lane], window_.rows[lane], window_.columns[lane]);
        double const ex = cells_.x[other.place] + window_.columns[lane] * width - x;
        double const ey = cells_.y[other.place] + window_.rows[lane] * width - y;
        double const b = ex * u + ey * v;
        double const c = ex * v - ey * u;
        double const under_root = speed_squared - c * c;
        if (b <= 0.0 || under_root <= 0.0) return;
        double const candidate = b - std::sqrt(under_root);
        if (candidate > path) return;
        path = std::max(candidate, 0.0);
        partner = other;
        dx = ex;
        dy = ey;
        hits = true;
      };
      if (std::bit_cast<float>(least & ~63U) <= static_cast<float>(path)) [[likely]] {
        look(least & 63U);
        Keys const bound = above(path);
        for (std::uint64_t others =
                 (lanes_below(bound, found[0], found[1]) | lanes_below(bound, found[2], found[3]) << 32U) &
                 ~(std::uint64_t{1} << (least & 63U));
             others != 0; others &= others - 1)
          [[unlikely]] { look(static_cast<unsigned>(__builtin_ctzll(others))); }
      }
      double const time = hits ? path * inverse : std::min(border, rest);
      rest -= time;
      displacement_ = displacement_ + Vector{u * time, v * time};
      double const stop_x = x + u * time;
      double const stop_y = y + v * time;
      int const columns = (stop_x >= width ? 1 : 0) - (stop_x < 0.0 ? 1 : 0);
      int const rows = (stop_y >= width ? 1 : 0) - (stop_y < 0.0 ? 1 : 0);
      Cell const to = cells_.beside(cell, rows * stride + columns, rows, columns);
      double const inside_x = stop_x - columns * width;
      double const inside_y = stop_y - rows * width;
      if (hits) [[likely]] {
        pending = {from, to, inside_x, inside_y};
        double const nx = dx - u * time;
        double const ny = dy - v * time;
        double const other_u = cells_.u[partner.place];
        double const other_v = cells_.v[partner.place];
        double const towards = u * nx + v * ny;
        double const exchange = towards - (other_u * nx + other_v * ny);
        cells_.u[to.place] = u - exchange * nx;
        cells_.v[to.place] = v - exchange * ny;
        u = other_u + exchange * nx;
        v = other_v + exchange * ny;
        virial += towards;
        ++events;
        x = cells_.x[partner.place];
        y = cells_.y[partner.place];
        cell = partner;
        from = partner;
        continue;
      }
      cell = to;
      x = inside_x;
      y = inside_y;
      if (rest <= 0.0) {
        pending = {from, to, x, y};
        break;
      }
      // The disk goes on. Its first place keeps it until it stops: that is behind it. Nothing is written yet.
      pending = {from, from, cells_.x[from.place], cells_.y[from.place]};
    }
    pending.write(cells_);
    cells_.u[cell.place] = u;
    cells_.v[cell.place] = v;
    events_ += events;
    return virial;
  }

  Cells cells_;
  double count_;
  double duration_;
  double events_per_chain_;
  std::uint64_t seed_;
  std::uint64_t chains_ = 0;
  Window window_;
};

class Exact final : public Dynamics {
 public:
  explicit Exact(State const& start)
      : state_(start), engine_(make_engine({.kind = "exact", .time_step = 1e6, .threads = 1}, state_)) {}

  double advance(double events) override {
    double const virial = counters_.pair_virial;
    double const time = state_.clock.time;
    engine_->advance(state_, counters_,
                     {.pair_collisions = counters_.pair_collisions + static_cast<std::uint64_t>(events)});
    events_ = counters_.pair_collisions;
    duration_of_last_ = state_.clock.time - time;
    auto const n = static_cast<double>(state_.agents.size());
    // The total momentum is 0, so that the kinetic energy is (N − 1) kT.
    double const kt = kinetic_energy(state_.agents) / (n - 1.0);
    return 1.0 + (counters_.pair_virial - virial) / (2.0 * n * kt * (state_.clock.time - time));
  }
  [[nodiscard]] std::vector<Vector> disks() const override {
    std::vector<Vector> result;
    auto const xs = state_.agents.column<X>();
    auto const ys = state_.agents.column<Y>();
    for (std::size_t i = 0; i < xs.size(); ++i) result.push_back({xs[i], ys[i]});
    return result;
  }
  [[nodiscard]] State const& state() const { return state_; }

 private:
  State state_;
  std::unique_ptr<Engine> engine_;
  Counters counters_;
};

/// Fourier modes of the orientation: wave vectors 2π/L (column, row) with both from −3 to 3, the sums over all disks of
/// ψ6 e^(−ikr) over N.
constexpr int most = 3;
constexpr int modes_a_side = 2 * most + 1;
using Modes = std::vector<std::complex<double>>;

/// Modes of ψ6, the mean of e^(6iθ) over the disks within 1.5 σ, relative to the centre of mass: straight chains push all
/// disks along.
Modes orientation(std::vector<Vector> const& disks, double side, Vector displacement) {
  constexpr double reach = 1.5;
  int const n = std::max(3, static_cast<int>(side / reach));
  std::vector<std::vector<std::uint32_t>> cells(static_cast<std::size_t>(n * n));
  auto const cell_of = [&](Vector p) {
    return std::min(static_cast<int>(p.y / side * n), n - 1) * n + std::min(static_cast<int>(p.x / side * n), n - 1);
  };
  for (std::uint32_t i = 0; i < disks.size(); ++i) cells[static_cast<std::size_t>(cell_of(disks[i]))].push_back(i);
  std::vector<std::complex<double>> sums(disks.size());
  std::vector<int> neighbours(disks.size());
  auto const pair = [&](std::uint32_t i, std::uint32_t j) {
    double dx = disks[j].x - disks[i].x;
    double dy = disks[j].y - disks[i].y;
    dx -= side * std::round(dx / side);
    dy -= side * std::round(dy / side);
    double const squared = dx * dx + dy * dy;
    if (squared > reach * reach) return;
    double const c = (dx * dx - dy * dy) / squared;
    double const s = 2.0 * dx * dy / squared;
    // e^(6iθ) is the cube of e^(2iθ).
    std::complex<double> const bond(c * c * c - 3.0 * c * s * s, 3.0 * c * c * s - s * s * s);
    sums[i] += bond;
    sums[j] += bond;
    ++neighbours[i];
    ++neighbours[j];
  };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      auto const& here = cells[static_cast<std::size_t>(row * n + column)];
      for (std::size_t a = 0; a < here.size(); ++a) {
        for (std::size_t b = a + 1; b < here.size(); ++b) pair(here[a], here[b]);
      }
      for (auto const [r, c] : {std::pair(0, 1), std::pair(1, -1), std::pair(1, 0), std::pair(1, 1)}) {
        auto const& there = cells[static_cast<std::size_t>((row + r) % n * n + (column + c + n) % n)];
        for (auto const i : here) {
          for (auto const j : there) pair(i, j);
        }
      }
    }
  }
  Modes modes(static_cast<std::size_t>(modes_a_side * modes_a_side));
  auto const count = static_cast<double>(disks.size());
  Vector const drift{displacement.x / count, displacement.y / count};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (neighbours[i] == 0) continue;
    std::complex<double> const order = sums[i] / (neighbours[i] * static_cast<double>(disks.size()));
    Vector const place = disks[i] - drift;
    auto const step_x = std::polar(1.0, -2.0 * std::numbers::pi * place.x / side);
    auto const step_y = std::polar(1.0, -2.0 * std::numbers::pi * place.y / side);
    std::complex<double> row = order * std::pow(step_x * step_y, -most);
    std::size_t k = 0;
    for (int y = 0; y < modes_a_side; ++y, row *= step_y) {
      std::complex<double> mode = row;
      for (int x = 0; x < modes_a_side; ++x, mode *= step_x) modes[k++] += mode;
    }
  }
  return modes;
}

struct CorrelationTime {
  double mean = 0.0;
  double variance = 0.0;
  double time = 0.5;   ///< Σ of the correlation function, ½ + Σ_{t ≥ 1}, in samples
  double error = 0.0;  ///< of time
};

/// The integrated correlation time with the window of Sokal, 5 times (6 times) itself; Ψ has the mean 0 by symmetry.
CorrelationTime correlation_time(std::vector<std::complex<double>> const& series, bool subtract) {
  auto const n = series.size();
  std::complex<double> mean;
  for (auto const& z : series) mean += z / static_cast<double>(n);
  std::complex<double> const shift = subtract ? mean : std::complex<double>();
  auto const covariance = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = 0; i + lag < n; ++i)
      sum += std::real(std::conj(series[i] - shift) * (series[i + lag] - shift));
    return sum / static_cast<double>(n - lag);
  };
  CorrelationTime result{.mean = std::real(mean), .variance = covariance(0)};
  for (std::size_t lag = 1; lag < n / 2; ++lag) {
    result.time += covariance(lag) / result.variance;
    if (static_cast<double>(lag) >= 6.0 * result.time) {
      result.error = result.time * std::sqrt(2.0 * (2.0 * static_cast<double>(lag) + 1.0) / static_cast<double>(n));
      return result;
    }
  }
  result.error = std::numeric_limits<double>::quiet_NaN();
  return result;
}

/// Disks on a square lattice with Maxwell's velocities and without momentum, melted by `exact`.
State melted(std::uint64_t n, double packing_fraction, std::uint64_t seed, double collisions_per_disk) {
  auto const columns = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  double const side = std::sqrt(static_cast<double>(n) * std::numbers::pi / 4.0 / packing_fraction);
  double const step = side / static_cast<double>(columns);
  State state{.box = Box(side, side, Edge::periodic), .seed = seed};
  Vector sum;
  for (std::uint64_t i = 0; i < n; ++i) {
    RandomStream random(seed, 0, i, Purpose::start_velocity);
    Vector const v{random.normal(), random.normal()};
    sum = sum + v;
    state.agents.add((static_cast<double>(i % columns) + 0.5) * step, (static_cast<double>(i / columns) + 0.5) * step,
                     v.x, v.y, 0.5, 1.0, 0, 0);
  }
  for (double& v : state.agents.column<VelocityX>()) v -= sum.x / static_cast<double>(n);
  for (double& v : state.agents.column<VelocityY>()) v -= sum.y / static_cast<double>(n);
  Exact exact(state);
  exact.advance(0.5 * collisions_per_disk * static_cast<double>(n));
  return exact.state();
}

struct ChainLength {
  double straight;   ///< in σ
  double newtonian;  ///< in σ/√(kT/m)
};
/// Chains of about so many events, from the pressure of the fluid near freezing.
ChainLength chain_length(double events, double packing_fraction) {
  // Straight: Z − 1 = jump a path, and a jump is about π/4 σ; Newtonian: (Z − 1) ⟨v²⟩ = v_n a time, and v_n is about 1.2.
  double const z = 1.0 + packing_fraction * 2.0 / std::pow(1.0 - packing_fraction, 2);
  double const excess = std::min(z, 10.2) - 1.0;
  return {events * 0.785 / excess, events * 1.25 / (2.0 * excess)};
}

std::unique_ptr<Dynamics> make(std::string_view name, State const& state, std::uint64_t seed, double events_per_chain) {
  if (name == "exact") return std::make_unique<Exact>(state);
  double const side = state.box.width();
  std::vector<Vector> const disks = Exact(state).disks();
  double const packing_fraction = std::numbers::pi / 4.0 * static_cast<double>(disks.size()) / (side * side);
  ChainLength const length = chain_length(events_per_chain, packing_fraction);
  if (name == "straight") return std::make_unique<StraightChains>(side, disks, seed, length.straight, events_per_chain);
  std::vector<Vector> velocities;
  auto const u = state.agents.column<VelocityX>();
  auto const v = state.agents.column<VelocityY>();
  for (std::size_t i = 0; i < disks.size(); ++i) velocities.push_back({u[i], v[i]});
  return std::make_unique<NewtonianChains>(side, disks, velocities, seed, length.newtonian, events_per_chain);
}

/// Nanoseconds of processor time an event of the three, in turns.
void speed(double packing_fraction, std::uint64_t n, int rounds, double events_per_chain) {
  State const start = melted(n, packing_fraction, 1, n < 50'000 ? 100.0 : 20.0);
  auto const block = static_cast<double>(std::clamp<std::uint64_t>(10 * n, 500'000, 5'000'000));
  std::vector<Contestant> contestants;
  for (auto const* name : {"exact", "straight", "newtonian"}) {
    std::shared_ptr<Dynamics> const dynamics = make(name, start, 1, events_per_chain);
    double const events = std::string_view(name) == "exact" ? block : 4.0 * block;
    contestants.push_back({.name = name, .items = events, .run = [=] { dynamics->advance(events); }});
  }
  race("event_chain", n, packing_fraction, rounds, contestants);
}

/// One dynamics: βP/ρ and Ψ6 of samples taken every so many events, from a start.
void series(std::string_view name, State const& start, double packing_fraction, std::uint64_t samples, double events,
            std::uint64_t seed, double events_per_chain, bool print_correlations) {
  std::unique_ptr<Dynamics> const dynamics = make(name, start, seed, events_per_chain);
  double const side = start.box.width();
  auto const n = static_cast<double>(start.agents.size());
  dynamics->advance(20.0 * events);
  std::uint64_t const events_before = dynamics->events();
  std::vector<std::complex<double>> pressures;
  std::vector<std::complex<double>> orders;
  std::vector<Modes> modes;
  std::vector<std::complex<double>> moduli;
  double seconds = 0.0;
  double weighted = 0.0;
  double weight = 0.0;
  for (std::uint64_t k = 0; k < samples; ++k) {
    double const before = processor_seconds();
    pressures.emplace_back(dynamics->advance(events));
    weighted += pressures.back().real() * dynamics->duration();
    weight += dynamics->duration();
    seconds += processor_seconds() - before;
    modes.push_back(orientation(dynamics->disks(), side, dynamics->displacement()));
    orders.push_back(modes.back()[modes.back().size() / 2]);
    moduli.emplace_back(std::abs(orders.back()));
  }
  double const all = static_cast<double>(dynamics->events() - events_before);
  double const a_sample = all / static_cast<double>(samples) / n;  // events a disk
  auto const z = correlation_time(pressures, true);
  auto const order = correlation_time(orders, false);
  auto const modulus = correlation_time(moduli, true);
  double const count = static_cast<double>(samples);
  auto const error = [&](CorrelationTime const& c) { return std::sqrt(2.0 * c.time * c.variance / count); };
  std::printf("%s,%.4g,%.0f,%llu,%.4g,%.4g,%.1f,%.6f,%.6f,%.4g,%.4g,%.6f,%.6f,%.5g,%.3g,%.5g,%.3g\n",
              std::string(name).c_str(), packing_fraction, n, static_cast<unsigned long long>(samples), a_sample,
              events_per_chain, 1e9 * seconds / all, weighted / weight, error(z), 2.0 * z.time * z.variance * a_sample,
              2.0 * z.error * z.variance * a_sample, modulus.mean, error(modulus), order.time * a_sample,
              order.error * a_sample, modulus.time * a_sample, modulus.error * a_sample);
  if (print_correlations) {
    double lag = 1.0;
    for (std::size_t last = 0; lag < count / 4.0; lag *= std::pow(2.0, 0.25)) {
      auto const t = static_cast<std::size_t>(lag);
      if (t == last) continue;
      last = t;
      // ⟨|Ψ(t) − Ψ(0)|²⟩ N of the mean, of the modes next to it and of those farther out, and their ⟨|Ψ|²⟩ N.
      constexpr int shells = 4;
      double differences[shells]{};
      double squares[shells]{};
      double counts[shells]{};
      for (std::size_t k = 0; k + t < modes.size(); ++k) {
        for (int m = 0; m < modes_a_side * modes_a_side; ++m) {
          int const squared_number = (m / modes_a_side - most) * (m / modes_a_side - most) +
                                     (m % modes_a_side - most) * (m % modes_a_side - most);
          int const shell = squared_number == 0 ? 0 : squared_number <= 2 ? 1 : squared_number <= 8 ? 2 : 3;
          differences[shell] += std::norm(modes[k + t][m] - modes[k][m]);
          squares[shell] += 0.5 * (std::norm(modes[k + t][m]) + std::norm(modes[k][m]));
          counts[shell] += 1.0;
        }
      }
      std::printf("correlation,%s,%.5g", std::string(name).c_str(), static_cast<double>(t) * a_sample);
      for (int k = 0; k < shells; ++k)
        std::printf(",%.5g,%.5g", n * differences[k] / counts[k], n * squares[k] / counts[k]);
      std::printf("\n");
    }
  }
  std::fflush(stdout);
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  using namespace gridlock::benchmark;
  auto const number = [&](int k, double otherwise) {
    return argument_count > k ? std::strtod(arguments[k], nullptr) : otherwise;
  };
  std::string_view const mode = argument_count > 3 ? arguments[1] : "";
  double const packing_fraction = number(2, 0.7);
  auto const n = static_cast<std::uint64_t>(number(3, 1024.0));
  if (mode == "speed") {
    print_header();
    speed(packing_fraction, n, static_cast<int>(number(4, 7.0)), number(5, 300.0));
    return 0;
  }
  if (mode.empty()) return 2;
  auto const samples = static_cast<std::uint64_t>(number(4, 1000.0));
  double const events = number(5, 1000.0);
  double const equilibration = number(6, 100.0);
  auto const seed = static_cast<std::uint64_t>(number(7, 1.0));
  double const chain = number(8, 300.0);
  double const ratio = number(9, 4.0);
  bool const correlations = number(10, 0.0) > 0.0;
  std::printf(
      "dynamics,packing_fraction,n,samples,events_per_disk_and_sample,events_per_chain,nanoseconds_per_event,z,z_error,"
      "z_variance_times_events_per_disk,its_error,psi6,psi6_error,psi6_time,psi6_time_error,modulus_time,modulus_time_"
      "error\n");
  auto const start = melted(n, packing_fraction, seed, equilibration);
  for (auto const* name : {"exact", "straight", "newtonian"}) {
    if (mode != "compare" && mode != name) continue;
    series(name, start, packing_fraction, samples, std::string_view(name) == "exact" ? events : ratio * events, seed,
           chain, correlations);
  }
}
