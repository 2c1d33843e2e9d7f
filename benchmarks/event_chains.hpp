#pragma once

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

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "chain_cells.hpp"

namespace gridlock::benchmark {

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

}  // namespace gridlock::benchmark
