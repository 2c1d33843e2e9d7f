#include "core/avx512.hpp"
#include "engine/chain/chains.hpp"

// For equal disks a cell is so narrow, at most σ/√2, that it holds one disk at most. So a grid of floats relative to
// the cells is all that a search reads: no counts, no lists, no names of disks. One row of cells is one load. Single
// precision finds who may be met first, and double precision decides.

#if defined(__x86_64__) && defined(__GNUC__)

#include <bit>
#include <limits>
#include <numbers>
#include <vector>

#include "engine/chain/take_step.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"

namespace gridlock::chain {

namespace {

using Wide = __m512;
using Keys = __m512i;

constexpr float nowhere = 1e10F;  ///< both coordinates of an empty cell
constexpr int margin = 3;         ///< columns and rows of copies at each edge

/// Lanes of a window of cells: places relative to the cell of the moving disk, and steps from cell to cell.
struct Window {
  alignas(64) float column[64];
  alignas(64) float row[64];
  alignas(64) int lane[64];
  int step[64];
  int rows[64];
  int columns[64];
};

/// Rows and columns of cells, in units of the shortest distance of two disks.
struct WindowShape {
  int first_row;
  int rows;
  int first_column;
  int columns;
  int lanes;  ///< of a row
};

/// Lower bounds of paths with their lanes in the last six bits, so that the least key names its lane.
/// Disks are `ahead` along and `aside` of the way of the moving disk. Places are so near that single precision errs by
/// less than 10⁻⁶ of the contact distance, and `squared` is larger than its square by 8 · 10⁻⁶.
GRIDLOCK_AVX512 inline Keys keys(Wide ahead, Wide aside, Wide squared, Wide least_ahead, Keys lanes) {
  Wide const radicand = _mm512_fnmadd_ps(aside, aside, squared);
  __mmask16 const front = _mm512_cmp_ps_mask(ahead, least_ahead, _CMP_GT_OQ);
  __mmask16 const hits = _mm512_mask_cmp_ps_mask(front, radicand, _mm512_setzero_ps(), _CMP_GT_OQ);
  Wide const path = _mm512_max_ps(_mm512_sub_ps(ahead, _mm512_sqrt_ps(radicand)), _mm512_setzero_ps());
  Keys const cut = _mm512_and_epi32(_mm512_castps_si512(path), _mm512_set1_epi32(~63));
  return _mm512_mask_or_epi32(_mm512_set1_epi32(std::numeric_limits<int>::max()), hits, cut, lanes);
}
/// Returns a key that is at least that of every path that may be as short as this one.
GRIDLOCK_AVX512 inline Keys above(double path) {
  float const rounded = static_cast<float>(path) * (1.0F + 1e-6F);
  return _mm512_or_epi32(_mm512_castps_si512(_mm512_set1_ps(rounded)), _mm512_set1_epi32(63));
}
GRIDLOCK_AVX512 inline std::uint64_t lanes_below(Keys bound, Keys found, unsigned first_lane) {
  return static_cast<std::uint64_t>(_mm512_cmple_epu32_mask(found, bound)) << first_lane;
}

GRIDLOCK_AVX512 inline Wide two_rows(float const* lower, float const* upper) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(lower)), _mm256_loadu_ps(upper), 1);
}
GRIDLOCK_AVX512 inline Wide four_rows(float const* first, int stride) {
  Wide rows = _mm512_castps128_ps512(_mm_loadu_ps(first));
  rows = _mm512_insertf32x4(rows, _mm_loadu_ps(first + stride), 1);
  rows = _mm512_insertf32x4(rows, _mm_loadu_ps(first + 2 * stride), 2);
  return _mm512_insertf32x4(rows, _mm_loadu_ps(first + 3 * stride), 3);
}

/// The number of cells along a side, so that the diagonal of a cell is shorter than the contact distance.
int cells_along(double side, double contact) {
  return static_cast<int>(side / contact * std::numbers::sqrt2 * (1.0 + 1e-6)) + 1;
}

class NarrowCells final : public ChainDisks {
 public:
  explicit NarrowCells(State const& state)
      : box_(state.box),
        contact_(largest_contact_distance(state.agents.column<Radius>())),
        columns_(cells_along(box_.width(), contact_)),
        rows_(cells_along(box_.height(), contact_)),
        stride_(columns_ + 2 * margin + 8),
        width_(box_.width() / columns_),
        height_(box_.height() / rows_),
        per_width_(columns_ / box_.width()),
        per_height_(rows_ / box_.height()),
        row_in_state_(rows_in_order(state.agents.ids())),
        // The disk stays within 7/4 contact distances, three cells; with straight chains it looks ahead only.
        around_(window({-3, 7, -3, 7, 8})),
        above_(window({0, 4, -2, 5, 8})),
        to_the_right_(window({-2, 5, 0, 4, 4})) {
    auto const size = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_ + 2 * margin);
    rough_x_.assign(size, nowhere);
    rough_y_.assign(size, nowhere);
    disks_.assign(size, {});
    cells_.resize(row_in_state_.size());
    for (Number disk = 0; disk < cells_.size(); ++disk) {
      std::uint32_t const row = row_in_state_[disk];
      Vector const place = position(state.agents, row);
      Cell const cell = cell_of(place);
      cells_[disk] = cell;
      disks_[index(cell)] = {place, gridlock::velocity(state.agents, row), disk};
      put_rough(cell, rough(place, cell));
    }
  }

  /// Whether all disks are in cells of their own, as disks without overlaps are.
  [[nodiscard]] bool are_apart() const {
    for (Number disk = 0; disk < cells_.size(); ++disk) {
      if (disks_[index(cells_[disk])].number != disk) return false;
    }
    return true;
  }

  [[nodiscard]] GRIDLOCK_AVX512 ChainSums take(StepOfChains const& step) override {
    return take_step(*this, cells_.size(), step);
  }
  void write_back(State& state) const override {
    Disks& to = state.agents;
    for (Number disk = 0; disk < cells_.size(); ++disk) {
      std::uint32_t const row = row_in_state_[disk];
      Disk const& now = disks_[index(cells_[disk])];
      to.column<X>()[row] = now.place.x;
      to.column<Y>()[row] = now.place.y;
      to.column<VelocityX>()[row] = now.velocity.x;
      to.column<VelocityY>()[row] = now.velocity.y;
    }
    for (Crossing const& crossing : crossings_) {
      to.column<ImageX>()[row_in_state_[crossing.disk]] += crossing.x;
      to.column<ImageY>()[row_in_state_[crossing.disk]] += crossing.y;
    }
  }

  // For carry_out():
  struct Cell {
    int place;  ///< in the columns of the grid
    int row;
    int column;
  };
  [[nodiscard]] double longest_flight() const { return chain::longest_flight * contact_; }
  [[nodiscard]] Cell find(Number disk) const { return cells_[disk]; }
  [[nodiscard]] Vector place(Cell cell) const { return disks_[index(cell)].place; }
  [[nodiscard]] Vector velocity(Cell cell) const { return disks_[index(cell)].velocity; }
  void set_velocity(Cell cell, Vector velocity) { disks_[index(cell)].velocity = velocity; }
  [[nodiscard]] Cell place_of_partner(Contact const& /*contact*/) const { return partner_; }
  Vector move(Cell& cell, Number disk, Vector to) {
    int crossed_x = 0;
    int crossed_y = 0;
    Vector const place = box_.wrap(to, crossed_x, crossed_y);
    if ((crossed_x | crossed_y) != 0) [[unlikely]]
      crossings_.push_back({disk, crossed_x, crossed_y});
    pending_.from = cell;
    Cell const next = cell_of(place);
    disks_[index(cell)].place = place;
    if (next.place != cell.place) {
      disks_[index(next)] = disks_[index(cell)];
      disks_[index(cell)].number = nobody;
      cells_[disk] = next;
      cell = next;
    }
    pending_.to = cell;
    pending_.rough = rough(place, cell);
    return place;
  }
  void end_chain() {
    write_pending();
    pending_ = {};
  }
  template <Way way>
  GRIDLOCK_AVX512 void find_contact(Flight const& flight, Cell cell, Contact& contact);

 private:
  struct Disk {
    Vector place;
    Vector velocity;
    Number number = nobody;
  };
  struct RoughPlace {
    float x = nowhere;
    float y = nowhere;
  };
  struct Crossing {
    Number disk;
    int x;
    int y;
  };
  /// A disk that has moved, to be written once the cells around the next one have been read: a wide load that follows a
  /// narrow store to the same place would wait for it. The next flight cannot meet this disk.
  struct Pending {
    Cell from{-1, 0, 0};
    Cell to{-1, 0, 0};
    RoughPlace rough;
  };

  static std::size_t index(Cell cell) { return static_cast<std::size_t>(cell.place); }
  [[nodiscard]] Cell at(int row, int column) const { return {(row + margin) * stride_ + column + margin, row, column}; }
  [[nodiscard]] Cell cell_of(Vector place) const {
    return at(std::min(static_cast<int>(place.y * per_height_), rows_ - 1),
              std::min(static_cast<int>(place.x * per_width_), columns_ - 1));
  }
  [[nodiscard]] RoughPlace rough(Vector place, Cell cell) const {
    return {static_cast<float>(place.x - cell.column * width_), static_cast<float>(place.y - cell.row * height_)};
  }
  /// The cell of a lane, around the box.
  [[nodiscard]] Cell lane_of(Window const& window, Cell cell, unsigned lane) const {
    Cell const there{cell.place + window.step[lane], cell.row + window.rows[lane], cell.column + window.columns[lane]};
    if (static_cast<unsigned>(there.row) < static_cast<unsigned>(rows_) &&
        static_cast<unsigned>(there.column) < static_cast<unsigned>(columns_)) [[likely]] {
      return there;
    }
    return at((there.row + rows_) % rows_, (there.column + columns_) % columns_);
  }
  [[nodiscard]] Window window(WindowShape const& shape) const {
    Window result{};
    for (int k = 0; k < 64; ++k) {
      int const row = shape.first_row + k / shape.lanes;
      int const column = shape.first_column + k % shape.lanes;
      bool const counts = k / shape.lanes < shape.rows && k % shape.lanes < shape.columns && (row != 0 || column != 0);
      result.row[k] = counts ? static_cast<float>(row * height_) : nowhere;
      result.column[k] = counts ? static_cast<float>(column * width_) : nowhere;
      result.lane[k] = k;
      result.step[k] = row * stride_ + column;
      result.rows[k] = row;
      result.columns[k] = column;
    }
    return result;
  }
  void write_pending() {
    if (pending_.to.place < 0) return;
    if (pending_.from.place != pending_.to.place) put_rough(pending_.from, {});
    put_rough(pending_.to, pending_.rough);
  }
  void put_rough(Cell cell, RoughPlace place) {
    rough_x_[index(cell)] = place.x;
    rough_y_[index(cell)] = place.y;
    if (static_cast<unsigned>(cell.row - margin) >= static_cast<unsigned>(rows_ - 2 * margin) ||
        static_cast<unsigned>(cell.column - margin) >= static_cast<unsigned>(columns_ - 2 * margin)) [[unlikely]] {
      copy_rough(cell, place);
    }
  }
  [[gnu::noinline]] void copy_rough(Cell cell, RoughPlace place) {
    int const row = cell.row < margin ? rows_ : cell.row >= rows_ - margin ? -rows_ : 0;
    int const column = cell.column < margin ? columns_ : cell.column >= columns_ - margin ? -columns_ : 0;
    for (int const step : {row * stride_, column, row * stride_ + column}) {
      rough_x_[index(cell) + static_cast<std::size_t>(step)] = place.x;
      rough_y_[index(cell) + static_cast<std::size_t>(step)] = place.y;
    }
  }
  template <Way way>
  void look(Window const& window, unsigned lane, Flight const& flight, Cell cell, Contact& contact) {
    Cell const there = lane_of(window, cell, lane);
    Disk const& other = disks_[index(there)];
    if (other.number == nobody) return;
    Vector const separation = box_.displacement_inside(flight.place, other.place);
    if (meet<way>(flight, separation, contact_ * contact_, other.number, contact)) partner_ = there;
  }

  Box box_;
  double contact_;
  int columns_;
  int rows_;
  int stride_;
  double width_;
  double height_;
  double per_width_;
  double per_height_;
  std::vector<std::uint32_t> row_in_state_;
  Window around_;
  Window above_;
  Window to_the_right_;
  std::vector<float> rough_x_;  ///< relative to the corner of the cell, with copies
  std::vector<float> rough_y_;
  std::vector<Disk> disks_;  ///< by cell, without copies
  std::vector<Cell> cells_;  ///< by number
  std::vector<Crossing> crossings_;
  Pending pending_;
  Cell partner_{};  ///< cell of the disk that the last flight met
};

template <Way way>
GRIDLOCK_AVX512 void NarrowCells::find_contact(Flight const& flight, Cell cell, Contact& contact) {
  constexpr bool right = way == Way::right;
  constexpr int registers = way == Way::by_velocity ? 4 : 2;
  Window const& w = way == Way::by_velocity ? around_ : right ? to_the_right_ : above_;
  int const first = cell.place + w.step[0];
  float const* const xs = rough_x_.data() + first;
  float const* const ys = rough_y_.data() + first;
  RoughPlace const self = rough(flight.place, cell);
  Wide const self_x = _mm512_set1_ps(self.x);
  Wide const self_y = _mm512_set1_ps(self.y);
  Wide x[registers];
  Wide y[registers];
  if constexpr (right) {
    x[0] = four_rows(xs, stride_);
    y[0] = four_rows(ys, stride_);
    x[1] = _mm512_zextps128_ps512(_mm_loadu_ps(xs + 4 * stride_));
    y[1] = _mm512_zextps128_ps512(_mm_loadu_ps(ys + 4 * stride_));
  } else {
    for (int k = 0; k < (way == Way::by_velocity ? 3 : 2); ++k) {
      x[k] = two_rows(xs + 2 * k * stride_, xs + (2 * k + 1) * stride_);
      y[k] = two_rows(ys + 2 * k * stride_, ys + (2 * k + 1) * stride_);
    }
    if constexpr (way == Way::by_velocity) {
      x[3] = _mm512_zextps256_ps512(_mm256_loadu_ps(xs + 6 * stride_));
      y[3] = _mm512_zextps256_ps512(_mm256_loadu_ps(ys + 6 * stride_));
    }
  }
  write_pending();
  if (way == Way::by_velocity && !(flight.square > 1e-20 && flight.square < 1e20)) [[unlikely]] {
    for (unsigned lane = 0; lane < 64; ++lane) look<way>(w, lane, flight, cell, contact);
    return;
  }
  auto const rough_contact = static_cast<float>(contact_);
  float square = rough_contact * rough_contact * (1.0F + 8e-6F);
  float least_ahead = -2e-6F * rough_contact;
  Wide u{};
  Wide v{};
  if constexpr (way == Way::by_velocity) {
    auto const rough_u = static_cast<float>(flight.velocity.x);
    auto const rough_v = static_cast<float>(flight.velocity.y);
    square *= rough_u * rough_u + rough_v * rough_v;
    least_ahead *= std::abs(rough_u) + std::abs(rough_v);
    u = _mm512_set1_ps(rough_u);
    v = _mm512_set1_ps(rough_v);
  }
  Keys found[registers];
  for (int k = 0; k < registers; ++k) {
    x[k] = _mm512_add_ps(x[k], _mm512_sub_ps(_mm512_load_ps(w.column + 16 * k), self_x));
    y[k] = _mm512_add_ps(y[k], _mm512_sub_ps(_mm512_load_ps(w.row + 16 * k), self_y));
    Wide ahead = right ? x[k] : y[k];
    Wide aside = right ? y[k] : x[k];
    if constexpr (way == Way::by_velocity) {
      ahead = _mm512_fmadd_ps(x[k], u, _mm512_mul_ps(y[k], v));
      aside = _mm512_fmsub_ps(x[k], v, _mm512_mul_ps(y[k], u));
    }
    found[k] =
        keys(ahead, aside, _mm512_set1_ps(square), _mm512_set1_ps(least_ahead), _mm512_load_si512(w.lane + 16 * k));
  }
  Keys all = _mm512_min_epu32(found[0], found[1]);
  if constexpr (registers == 4) all = _mm512_min_epu32(all, _mm512_min_epu32(found[2], found[3]));
  std::uint32_t const least = _mm512_reduce_min_epu32(all);
  // Without a lane that may be met the key is no number.
  if (!(std::bit_cast<float>(least & ~63U) <= static_cast<float>(contact.path) * (1.0F + 1e-6F))) return;
  look<way>(w, least & 63U, flight, cell, contact);
  Keys const bound = above(contact.path);
  std::uint64_t others = 0;
  for (unsigned k = 0; k < registers; ++k) others |= lanes_below(bound, found[k], 16 * k);
  for (others &= ~(std::uint64_t{1} << (least & 63U)); others != 0; others &= others - 1) [[unlikely]] {
      look<way>(w, static_cast<unsigned>(std::countr_zero(others)), flight, cell, contact);
    }
}

}  // namespace

std::unique_ptr<ChainDisks> chain_disks_with_avx512(State const& state) {
  RadiusRange const radii = radius_range(state.agents);
  double const contact = 2.0 * radii.largest;
  // Cells count in int, and floats need numbers that are neither tiny nor huge.
  bool const is_usual =
      contact > 1e-6 && contact < 1e6 && state.box.width() < 3e4 * contact && state.box.height() < 3e4 * contact;
  if (radii.smallest != radii.largest || !is_usual || state.agents.size() < 2) return nullptr;
  auto disks = std::make_unique<NarrowCells>(state);
  return disks->are_apart() ? std::unique_ptr<ChainDisks>(std::move(disks)) : nullptr;
}

}  // namespace gridlock::chain

#else

namespace gridlock::chain {

std::unique_ptr<ChainDisks> chain_disks_with_avx512(State const& /*state*/) { return nullptr; }

}  // namespace gridlock::chain

#endif
