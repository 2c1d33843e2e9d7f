#include "core/avx512.hpp"
#include "engine/chain/chains.hpp"

// For equal disks a cell is so narrow, at most σ/√2, that it holds one disk at most. So a grid of floats relative to
// the cells is all that a search reads: no counts, no lists, no names of disks. One row of cells is one load. Single
// precision finds who may be met first, and double precision decides.

#if defined(__x86_64__) && defined(__GNUC__)

#include <algorithm>
#include <bit>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/chain/take_step.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"

namespace gridlock::chain {

namespace {

using Wide = __m512;
using Keys = __m512i;

constexpr float nowhere = 1e10F;  ///< both coordinates of an empty cell
constexpr int margin = 3;         ///< columns and rows of copies at each edge

enum NearEdge : std::uint8_t { left = 1, right = 2, bottom = 4, top = 8 };

/// Lanes of a window of cells: places relative to the cell of the moving disk, and steps to the cells.
struct Window {
  alignas(64) float column[64];
  alignas(64) float row[64];
  alignas(64) int lane[64];
  int step[64];
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
GRIDLOCK_AVX512 inline Keys keys(Wide ahead, Wide aside, Wide squared, Wide min_ahead, Keys lanes) {
  Wide const radicand = _mm512_fnmadd_ps(aside, aside, squared);
  __mmask16 const front = _mm512_cmp_ps_mask(ahead, min_ahead, _CMP_GT_OQ);
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
GRIDLOCK_AVX512 inline Wide four_rows(float const* first, std::ptrdiff_t stride) {
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
    numbers_.assign(size, nobody);
    edges_.assign(size, 0);
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) edges_[index(at(row, column))] = edges_near(row, column);
    }
    // Disks lie in memory as they lie in the box.
    std::vector<std::pair<int, Number>> order;
    order.reserve(row_in_state_.size());
    for (std::uint32_t const row : row_in_state_) {
      order.emplace_back(spot_of(position(state.agents, row)).cell, static_cast<Number>(order.size()));
    }
    std::ranges::sort(order);
    by_id_.resize(order.size());
    std::vector<std::uint32_t> const rows = row_in_state_;
    for (Number disk = 0; disk < order.size(); ++disk) {
      by_id_[order[disk].second] = disk;
      row_in_state_[disk] = rows[order[disk].second];
    }
    disks_.reserve(row_in_state_.size());
    for (std::uint32_t const row : row_in_state_) {
      Vector const place = position(state.agents, row);
      Spot const spot = spot_of(place);
      put(spot, static_cast<Number>(disks_.size()));
      disks_.push_back({place, gridlock::velocity(state.agents, row), spot.cell});
    }
  }

  /// Whether all disks are in cells of their own, as disks without overlaps are.
  [[nodiscard]] bool are_apart() const {
    for (Number disk = 0; disk < disks_.size(); ++disk) {
      if (numbers_[index(disks_[disk].cell)] != disk) return false;
    }
    return true;
  }

  [[nodiscard]] GRIDLOCK_AVX512 ChainSums take(StepOfChains const& step) override {
    return take_step(*this, disks_.size(), step);
  }
  void write_back(State& state) const override {
    Disks& to = state.agents;
    for (Number disk = 0; disk < disks_.size(); ++disk) {
      std::uint32_t const row = row_in_state_[disk];
      to.column<X>()[row] = disks_[disk].place.x;
      to.column<Y>()[row] = disks_[disk].place.y;
      to.column<VelocityX>()[row] = disks_[disk].velocity.x;
      to.column<VelocityY>()[row] = disks_[disk].velocity.y;
    }
    for (Crossing const& crossing : crossings_) {
      to.column<ImageX>()[row_in_state_[crossing.disk]] += crossing.x;
      to.column<ImageY>()[row_in_state_[crossing.disk]] += crossing.y;
    }
  }

  // For carry_out():
  [[nodiscard]] double longest_flight() const { return chain::longest_flight * contact_; }
  [[nodiscard]] Number find(Number in_order) const { return by_id_[in_order]; }
  [[nodiscard]] Vector place(Number disk) const { return disks_[disk].place; }
  [[nodiscard]] Vector velocity(Number disk) const { return disks_[disk].velocity; }
  void set_velocity(Number disk, Vector velocity) { disks_[disk].velocity = velocity; }
  Vector move(Number number, Vector to) {
    int crossed_x = 0;
    int crossed_y = 0;
    Disk& disk = disks_[number];
    disk.place = box_.wrap(to, crossed_x, crossed_y);
    if ((crossed_x | crossed_y) != 0) [[unlikely]]
      crossings_.push_back({number, crossed_x, crossed_y});
    pending_ = spot_of(disk.place);
    left_cell_ = disk.cell;
    moved_ = number;
    disk.cell = pending_.cell;
    return disk.place;
  }
  void end_chain() {
    write_moved();
    moved_ = nobody;
  }
  template <Way way>
  GRIDLOCK_AVX512 void find_contact(Flight const& flight, Contact& contact);

 private:
  struct Disk {
    Vector place;
    Vector velocity;
    int cell;
  };
  /// A cell, and a place relative to its corner.
  struct Spot {
    int cell;
    float x;
    float y;
  };
  struct Crossing {
    Number disk;
    int x;
    int y;
  };

  static std::size_t index(int cell) { return static_cast<std::size_t>(cell); }
  [[nodiscard]] int at(int row, int column) const { return (row + margin) * stride_ + column + margin; }
  [[nodiscard]] Spot spot_of(Vector place) const {
    int const row = std::min(static_cast<int>(place.y * per_height_), rows_ - 1);
    int const column = std::min(static_cast<int>(place.x * per_width_), columns_ - 1);
    return {at(row, column), static_cast<float>(place.x - column * width_),
            static_cast<float>(place.y - row * height_)};
  }
  /// Returns the edges near which a cell has copies.
  [[nodiscard]] std::uint8_t edges_near(int row, int column) const {
    return static_cast<std::uint8_t>((column < margin ? left : 0) | (column >= columns_ - margin ? right : 0) |
                                     (row < margin ? bottom : 0) | (row >= rows_ - margin ? top : 0));
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
    }
    return result;
  }
  /// Writes the disk that has moved, once the cells around the next one have been read: a wide load that follows a
  /// narrow store to the same place would wait for it. The next flight cannot meet this disk.
  void write_moved() {
    if (moved_ == nobody) return;
    if (left_cell_ != pending_.cell) put({left_cell_, nowhere, nowhere}, nobody);
    put(pending_, moved_);
  }
  void put(Spot const& spot, Number number) {
    std::size_t const cell = index(spot.cell);
    rough_x_[cell] = spot.x;
    rough_y_[cell] = spot.y;
    numbers_[cell] = number;
    if (edges_[cell] != 0) [[unlikely]]
      put_copies(spot, number);
  }
  /// With the instructions of its caller: others would have to wait for the upper halves of the registers.
  [[gnu::noinline]] GRIDLOCK_AVX512 void put_copies(Spot const& spot, Number number) {
    unsigned const edges = edges_[index(spot.cell)];
    int const column = (edges & left) != 0 ? columns_ : (edges & right) != 0 ? -columns_ : 0;
    int const row = stride_ * ((edges & bottom) != 0 ? rows_ : (edges & top) != 0 ? -rows_ : 0);
    for (int const step : {row, column, row + column}) {
      std::size_t const cell = index(spot.cell + step);
      rough_x_[cell] = spot.x;
      rough_y_[cell] = spot.y;
      numbers_[cell] = number;
    }
  }
  template <Way way>
  void look(Number other, Flight const& flight, Contact& contact) const {
    if (other == nobody) return;
    meet<way>(flight, box_.displacement_inside(flight.place, disks_[other].place), contact_ * contact_, other, contact);
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
  std::vector<Number> numbers_;      ///< of the disks in the cells, with copies
  std::vector<std::uint8_t> edges_;  ///< by cell
  std::vector<Disk> disks_;
  std::vector<Number> by_id_;  ///< numbers of the disks in the order of the Ids
  std::vector<Crossing> crossings_;
  Number moved_ = nobody;  ///< the disk that has moved and is not yet in its cell
  int left_cell_ = 0;
  Spot pending_{};
};

template <Way way>
GRIDLOCK_AVX512 void NarrowCells::find_contact(Flight const& flight, Contact& contact) {
  constexpr bool to_right = way == Way::right;
  constexpr int registers = way == Way::by_velocity ? 4 : 2;
  Window const& w = way == Way::by_velocity ? around_ : to_right ? to_the_right_ : above_;
  if (moved_ == flight.disk) [[unlikely]]
    write_moved();
  int const cell = disks_[flight.disk].cell;
  int const first = cell + w.step[0];
  float const* const xs = rough_x_.data() + first;
  float const* const ys = rough_y_.data() + first;
  Wide const self_x = _mm512_set1_ps(rough_x_[index(cell)]);
  Wide const self_y = _mm512_set1_ps(rough_y_[index(cell)]);
  Wide x[registers];
  Wide y[registers];
  std::ptrdiff_t const stride = stride_;
  if constexpr (to_right) {
    x[0] = four_rows(xs, stride);
    y[0] = four_rows(ys, stride);
    x[1] = _mm512_zextps128_ps512(_mm_loadu_ps(xs + 4 * stride));
    y[1] = _mm512_zextps128_ps512(_mm_loadu_ps(ys + 4 * stride));
  } else {
    for (std::ptrdiff_t k = 0; k < (way == Way::by_velocity ? 3 : 2); ++k) {
      x[k] = two_rows(xs + 2 * k * stride, xs + (2 * k + 1) * stride);
      y[k] = two_rows(ys + 2 * k * stride, ys + (2 * k + 1) * stride);
    }
    if constexpr (way == Way::by_velocity) {
      x[3] = _mm512_zextps256_ps512(_mm256_loadu_ps(xs + 6 * stride));
      y[3] = _mm512_zextps256_ps512(_mm256_loadu_ps(ys + 6 * stride));
    }
  }
  write_moved();
  if (way == Way::by_velocity && !(flight.square > 1e-20 && flight.square < 1e20)) [[unlikely]] {
    for (unsigned lane = 0; lane < 64; ++lane) look<way>(numbers_[index(cell + w.step[lane])], flight, contact);
    return;
  }
  auto const rough_contact = static_cast<float>(contact_);
  float square = rough_contact * rough_contact * (1.0F + 8e-6F);
  float min_ahead = -2e-6F * rough_contact;
  Wide u{};
  Wide v{};
  if constexpr (way == Way::by_velocity) {
    auto const rough_u = static_cast<float>(flight.velocity.x);
    auto const rough_v = static_cast<float>(flight.velocity.y);
    square *= rough_u * rough_u + rough_v * rough_v;
    min_ahead *= std::abs(rough_u) + std::abs(rough_v);
    u = _mm512_set1_ps(rough_u);
    v = _mm512_set1_ps(rough_v);
  }
  Keys found[registers];
  for (std::ptrdiff_t k = 0; k < registers; ++k) {
    x[k] = _mm512_add_ps(x[k], _mm512_sub_ps(_mm512_load_ps(w.column + 16 * k), self_x));
    y[k] = _mm512_add_ps(y[k], _mm512_sub_ps(_mm512_load_ps(w.row + 16 * k), self_y));
    Wide ahead = to_right ? x[k] : y[k];
    Wide aside = to_right ? y[k] : x[k];
    if constexpr (way == Way::by_velocity) {
      ahead = _mm512_fmadd_ps(x[k], u, _mm512_mul_ps(y[k], v));
      aside = _mm512_fmsub_ps(x[k], v, _mm512_mul_ps(y[k], u));
    }
    found[k] =
        keys(ahead, aside, _mm512_set1_ps(square), _mm512_set1_ps(min_ahead), _mm512_load_si512(w.lane + 16 * k));
  }
  Keys all = _mm512_min_epu32(found[0], found[1]);
  if constexpr (registers == 4) all = _mm512_min_epu32(all, _mm512_min_epu32(found[2], found[3]));
  std::uint32_t const least = _mm512_reduce_min_epu32(all);
  // Without a lane that may be met the key is no number.
  if (!(std::bit_cast<float>(least & ~63U) <= static_cast<float>(contact.path) * (1.0F + 1e-6F))) return;
  look<way>(numbers_[index(cell + w.step[least & 63U])], flight, contact);
  Keys const bound = above(contact.path);
  std::uint64_t others = 0;
  for (unsigned k = 0; k < registers; ++k) others |= lanes_below(bound, found[k], 16 * k);
  for (others &= ~(std::uint64_t{1} << (least & 63U)); others != 0; others &= others - 1) [[unlikely]] {
      look<way>(numbers_[index(cell + w.step[static_cast<unsigned>(std::countr_zero(others))])], flight, contact);
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
