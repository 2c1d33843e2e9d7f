#include "core/avx512.hpp"
#include "engine/chain/chains.hpp"

// For equal disks a cell is so narrow, at most σ/√2, that it holds one disk at most. So a grid of places relative to
// the cells, in 16 bits each, is all that a search reads: no counts, no lists, no names of disks. One row of cells is
// one load. Single precision finds who may be met first, and double precision decides. The next search begins in the
// cell of the disk that is met, while double precision is still at work.

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

constexpr float nowhere = 1e10F;      ///< both coordinates of a lane without a cell
constexpr int margin = 3;             ///< columns and rows of copies at each edge
constexpr double units = 65536.0;     ///< of a coordinate in a cell
constexpr std::uint32_t empty = ~0U;  ///< no rough place: those of disks end at 65,534
/// Single precision knows each coordinate of a separation to this, in contact distances: four units.
constexpr float roughness = 4.5e-5F;

/// Column and row of a cell, counted from those of the copies: in one number, which the next search has sooner than
/// two.
class Cell {
 public:
  Cell() = default;
  Cell(int column, int row) : bits_(static_cast<std::uint32_t>(column) + (static_cast<std::uint32_t>(row) << 16)) {}
  [[nodiscard]] int column() const { return static_cast<int>(bits_ & 0xFFFFU); }
  [[nodiscard]] int row() const { return static_cast<int>(bits_ >> 16); }
  friend Cell operator+(Cell cell, Cell step) {
    cell.bits_ += step.bits_;
    return cell;
  }
  friend bool operator==(Cell, Cell) = default;

 private:
  std::uint32_t bits_ = 0;
};

/// Lanes of a window of cells: places relative to the cell of the moving disk, and steps to the cells.
struct Window {
  alignas(64) float x[64];
  alignas(64) float y[64];
  alignas(64) int lane[64];
  Cell step[64];
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
/// Disks are `ahead` along and `aside` of the way of the moving disk, both to `roughness`; `squared` is larger than the
/// square of their contact distance by what makes up for both errors and for that of the reciprocal square root, 2⁻¹⁴.
GRIDLOCK_AVX512 inline Keys keys(__mmask16 disks, Wide ahead, Wide aside, Wide squared, Wide min_ahead, Keys lanes) {
  Wide const radicand = _mm512_fnmadd_ps(aside, aside, squared);
  __mmask16 const front = _mm512_mask_cmp_ps_mask(disks, ahead, min_ahead, _CMP_GT_OQ);
  __mmask16 const hits = _mm512_mask_cmp_ps_mask(front, radicand, _mm512_setzero_ps(), _CMP_GT_OQ);
  Wide const path = _mm512_max_ps(_mm512_fnmadd_ps(radicand, _mm512_rsqrt14_ps(radicand), ahead), _mm512_setzero_ps());
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

GRIDLOCK_AVX512 inline __m128i four_cells(std::uint32_t const* first) {
  return _mm_loadu_si128(reinterpret_cast<__m128i const*>(first));
}
GRIDLOCK_AVX512 inline __m256i eight_cells(std::uint32_t const* first) {
  return _mm256_loadu_si256(reinterpret_cast<__m256i const*>(first));
}
GRIDLOCK_AVX512 inline Keys two_rows(std::uint32_t const* first, std::ptrdiff_t stride) {
  return _mm512_inserti32x8(_mm512_castsi256_si512(eight_cells(first)), eight_cells(first + stride), 1);
}
GRIDLOCK_AVX512 inline Keys four_rows(std::uint32_t const* first, std::ptrdiff_t stride) {
  Keys rows = _mm512_castsi128_si512(four_cells(first));
  rows = _mm512_inserti32x4(rows, four_cells(first + stride), 1);
  rows = _mm512_inserti32x4(rows, four_cells(first + 2 * stride), 2);
  return _mm512_inserti32x4(rows, four_cells(first + 3 * stride), 3);
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
        unit_x_(static_cast<float>(width_ / units)),
        unit_y_(static_cast<float>(height_ / units)),
        per_width_(columns_ / box_.width()),
        per_height_(rows_ / box_.height()),
        row_in_state_(rows_in_order(state.agents.ids())),
        // The disk stays within 7/4 contact distances, three cells; with straight chains it looks ahead only.
        around_(window({-3, 7, -3, 7, 8})),
        above_(window({0, 4, -2, 5, 8})),
        to_the_right_(window({-2, 5, 0, 4, 4})) {
    auto const size =
        static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_ + 2 * margin + 10);  // for fetch_ahead()
    is_large_ = size > 500'000;
    rough_.assign(size, empty);
    numbers_.assign(size, nobody);
    // Disks lie in memory as they lie in the box.
    std::vector<std::pair<int, Number>> order;
    order.reserve(row_in_state_.size());
    for (std::uint32_t const row : row_in_state_) {
      order.emplace_back(at(spot_of(position(state.agents, row)).cell), static_cast<Number>(order.size()));
    }
    std::ranges::sort(order);
    by_id_.resize(order.size());
    std::vector<std::uint32_t> const rows = row_in_state_;
    for (Number disk = 0; disk < order.size(); ++disk) {
      by_id_[order[disk].second] = disk;
      row_in_state_[disk] = rows[order[disk].second];
    }
    places_.reserve(row_in_state_.size());
    velocities_.reserve(row_in_state_.size());
    for (std::uint32_t const row : row_in_state_) {
      put(spot_of(position(state.agents, row)), static_cast<Number>(places_.size()));
      places_.push_back(position(state.agents, row));
      velocities_.push_back(gridlock::velocity(state.agents, row));
    }
  }

  /// Whether all disks are in cells of their own, as disks without overlaps are.
  [[nodiscard]] bool are_apart() const {
    for (Number disk = 0; disk < places_.size(); ++disk) {
      if (numbers_[index(at(spot_of(places_[disk]).cell))] != disk) return false;
    }
    return true;
  }

  [[nodiscard]] GRIDLOCK_AVX512 ChainSums take(StepOfChains const& step) override {
    return take_step(*this, places_.size(), step);
  }
  void write_back(State& state) const override {
    Disks& to = state.agents;
    for (Number disk = 0; disk < places_.size(); ++disk) {
      std::uint32_t const row = row_in_state_[disk];
      to.column<X>()[row] = places_[disk].x;
      to.column<Y>()[row] = places_[disk].y;
      to.column<VelocityX>()[row] = velocities_[disk].x;
      to.column<VelocityY>()[row] = velocities_[disk].y;
    }
    for (Crossing const& crossing : crossings_) {
      to.column<ImageX>()[row_in_state_[crossing.disk]] += crossing.x;
      to.column<ImageY>()[row_in_state_[crossing.disk]] += crossing.y;
    }
  }

  // For carry_out():
  [[nodiscard]] double longest_flight() const { return chain::longest_flight * contact_; }
  [[nodiscard]] Number find(Number in_order) {
    Number const disk = by_id_[in_order];
    cell_ = spot_of(places_[disk]).cell;
    return disk;
  }
  [[nodiscard]] Vector place(Number disk) const { return places_[disk]; }
  [[nodiscard]] Vector velocity(Number disk) const { return velocities_[disk]; }
  void set_velocity(Number disk, Vector velocity) { velocities_[disk] = velocity; }
  Vector move(Number disk, Vector to) {
    int crossed_x = 0;
    int crossed_y = 0;
    Vector const place = box_.wrap(to, crossed_x, crossed_y);
    places_[disk] = place;
    if ((crossed_x | crossed_y) != 0) [[unlikely]]
      crossings_.push_back({disk, crossed_x, crossed_y});
    pending_ = spot_of(place);
    moved_ = disk;
    return place;
  }
  void end_chain() {
    write_moved();
    moved_ = nobody;
  }
  template <Way way>
  GRIDLOCK_AVX512 void find_contact(Flight const& flight, Contact& contact);

 private:
  /// A cell, and a place relative to its corner.
  struct Spot {
    Cell cell;
    std::uint32_t rough;
  };
  struct Crossing {
    Number disk;
    int x;
    int y;
  };

  static std::size_t index(int cell) { return static_cast<std::size_t>(cell); }
  [[nodiscard]] int at(Cell cell) const { return cell.row() * stride_ + cell.column(); }
  [[nodiscard]] Spot spot_of(Vector place) const {
    double const x = place.x * per_width_;
    double const y = place.y * per_height_;
    int const column = std::min(static_cast<int>(x), columns_ - 1);
    int const row = std::min(static_cast<int>(y), rows_ - 1);
    auto const rough = [](double inside) { return std::clamp(static_cast<int>(units * inside), 0, 65534); };
    return {Cell(column + margin, row + margin), static_cast<std::uint32_t>(rough(x - column) | rough(y - row) << 16)};
  }
  [[nodiscard]] Window window(WindowShape const& shape) const {
    Window result{};
    for (int k = 0; k < 64; ++k) {
      int const row = shape.first_row + k / shape.lanes;
      int const column = shape.first_column + k % shape.lanes;
      bool const counts = k / shape.lanes < shape.rows && k % shape.lanes < shape.columns && (row != 0 || column != 0);
      result.y[k] = counts ? static_cast<float>(row * height_) : nowhere;
      result.x[k] = counts ? static_cast<float>(column * width_) : nowhere;
      result.lane[k] = k;
      result.step[k] = Cell(column, row);
    }
    return result;
  }
  /// Writes the disk that has moved, once the cells around the next one have been read: a wide load that follows a
  /// narrow store to the same place would wait for it. The next flight cannot meet this disk.
  void write_moved() {
    if (moved_ == nobody) return;
    if (left_cell_ != pending_.cell) put({left_cell_, empty}, nobody);
    put(pending_, moved_);
  }
  void put(Spot const& spot, Number number) {
    std::size_t const cell = index(at(spot.cell));
    rough_[cell] = spot.rough;
    numbers_[cell] = number;
    auto const is_inside = [](int along, int cells) {
      return static_cast<unsigned>(along - 2 * margin) < static_cast<unsigned>(cells - 2 * margin);
    };
    if (!is_inside(spot.cell.column(), columns_) || !is_inside(spot.cell.row(), rows_)) [[unlikely]]
      put_copies(spot, number);
  }
  /// With the instructions of its caller: others would have to wait for the upper halves of the registers.
  [[gnu::noinline]] GRIDLOCK_AVX512 void put_copies(Spot const& spot, Number number) {
    auto const step = [](int along, int cells) { return along < 2 * margin ? cells : along >= cells ? -cells : 0; };
    int const column = step(spot.cell.column(), columns_);
    int const row = stride_ * step(spot.cell.row(), rows_);
    for (int const away : {row, column, row + column}) {
      std::size_t const cell = index(at(spot.cell) + away);
      rough_[cell] = spot.rough;
      numbers_[cell] = number;
    }
  }
  /// Asks for the memory that a straight chain reads some contacts later, of which the processor knows nothing.
  /// Inlined, for a function that returns nothing and writes nothing may be left out by the compiler.
  template <Way way>
  [[gnu::always_inline]] void fetch_ahead(int cell) const {
    std::ptrdiff_t const stride = stride_;
    std::ptrdiff_t const along = way == Way::right ? 1 : stride;
    std::ptrdiff_t const aside = way == Way::right ? stride : 1;
    std::ptrdiff_t const far = cell + (way == Way::right ? 40 : 8 * stride);
    if constexpr (way == Way::right) {
      for (std::ptrdiff_t k = -2; k <= 2; ++k) {
        __builtin_prefetch(rough_.data() + far + k * stride);
        __builtin_prefetch(numbers_.data() + far + k * stride);
      }
    } else {
      for (std::ptrdiff_t const row : {far, far + stride}) {
        __builtin_prefetch(rough_.data() + row - 2);
        __builtin_prefetch(rough_.data() + row + 4);
        __builtin_prefetch(numbers_.data() + row);
      }
    }
    for (std::ptrdiff_t k = -1; k <= 1; ++k) {
      Number const* const near = numbers_.data() + cell + 5 * along + k * aside;
      Number const disk = *near != nobody ? *near : near[along];
      if (disk != nobody) __builtin_prefetch(places_.data() + disk);
    }
  }
  /// Looks at the disk in a lane of the window around `from`.
  template <Way way>
  void look(Window const& w, unsigned lane, Cell from, Flight const& flight, Contact& contact) {
    Cell const cell = from + w.step[lane];
    Number const other = numbers_[index(at(cell))];
    if (other == nobody) return;
    if (!meet<way>(flight, box_.displacement_inside(flight.place, places_[other]), contact_ * contact_, other,
                   contact)) {
      return;
    }
    auto const step = [](int along, int cells) {
      return along < margin ? cells : along >= cells + margin ? -cells : 0;
    };
    cell_ = cell + Cell(step(cell.column(), columns_), step(cell.row(), rows_));
  }

  Box box_;
  double contact_;
  int columns_;
  int rows_;
  int stride_;
  double width_;
  double height_;
  float unit_x_;
  float unit_y_;
  double per_width_;
  double per_height_;
  std::vector<std::uint32_t> row_in_state_;
  Window around_;
  Window above_;
  Window to_the_right_;
  bool is_large_ = false;             ///< whether fetch_ahead() pays: the cells exceed the cache next to the core
  std::vector<std::uint32_t> rough_;  ///< places relative to the corner of the cell, x below y, with copies
  std::vector<Number> numbers_;       ///< of the disks in the cells, with copies
  std::vector<Vector> places_;        ///< by number
  std::vector<Vector> velocities_;
  std::vector<Number> by_id_;  ///< numbers of the disks in the order of the Ids
  std::vector<Crossing> crossings_;
  Cell cell_;              ///< of the disk that moves next
  Number moved_ = nobody;  ///< the disk that has moved and is not yet in its cell
  Cell left_cell_;
  Spot pending_{};
};

template <Way way>
GRIDLOCK_AVX512 void NarrowCells::find_contact(Flight const& flight, Contact& contact) {
  constexpr bool to_right = way == Way::right;
  constexpr int registers = way == Way::by_velocity ? 4 : 2;
  Window const& w = way == Way::by_velocity ? around_ : to_right ? to_the_right_ : above_;
  if (moved_ == flight.disk) [[unlikely]] {
    write_moved();
    cell_ = pending_.cell;
  }
  Cell const cell = cell_;
  std::uint32_t const self = rough_[index(at(cell))];
  std::uint32_t const* const first = rough_.data() + at(cell + w.step[0]);
  Keys cells[registers];
  std::ptrdiff_t const stride = stride_;
  if constexpr (to_right) {
    cells[0] = four_rows(first, stride);
    cells[1] = _mm512_zextsi128_si512(four_cells(first + 4 * stride));
  } else {
    for (std::ptrdiff_t k = 0; k < (way == Way::by_velocity ? 3 : 2); ++k) {
      cells[k] = two_rows(first + 2 * k * stride, stride);
    }
    if constexpr (way == Way::by_velocity) cells[3] = _mm512_zextsi256_si512(eight_cells(first + 6 * stride));
  }
  if (way != Way::by_velocity && is_large_) fetch_ahead<way>(at(cell));
  write_moved();
  left_cell_ = cell;
  if (way == Way::by_velocity && !(flight.square > 1e-20 && flight.square < 1e20)) [[unlikely]] {
    for (unsigned lane = 0; lane < 64; ++lane) {
      if (w.x[lane] != nowhere) look<way>(w, lane, cell, flight, contact);
    }
    return;
  }
  auto const rough_contact = static_cast<float>(contact_);
  float square = rough_contact * rough_contact * (1.0F + 9.0F * roughness);
  float min_ahead = -1.1F * roughness * rough_contact;
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
  Wide const self_x = _mm512_set1_ps(static_cast<float>(self & 0xFFFFU) * unit_x_);
  Wide const self_y = _mm512_set1_ps(static_cast<float>(self >> 16) * unit_y_);
  Keys found[registers];
  for (std::ptrdiff_t k = 0; k < registers; ++k) {
    Wide const x = _mm512_fmadd_ps(_mm512_cvtepi32_ps(_mm512_and_epi32(cells[k], _mm512_set1_epi32(0xFFFF))),
                                   _mm512_set1_ps(unit_x_), _mm512_sub_ps(_mm512_load_ps(w.x + 16 * k), self_x));
    Wide const y = _mm512_fmadd_ps(_mm512_cvtepi32_ps(_mm512_srli_epi32(cells[k], 16)), _mm512_set1_ps(unit_y_),
                                   _mm512_sub_ps(_mm512_load_ps(w.y + 16 * k), self_y));
    Wide ahead = to_right ? x : y;
    Wide aside = to_right ? y : x;
    if constexpr (way == Way::by_velocity) {
      ahead = _mm512_fmadd_ps(x, u, _mm512_mul_ps(y, v));
      aside = _mm512_fmsub_ps(x, v, _mm512_mul_ps(y, u));
    }
    __mmask16 const disks = _mm512_cmpneq_epi32_mask(cells[k], _mm512_set1_epi32(-1));
    found[k] = keys(disks, ahead, aside, _mm512_set1_ps(square), _mm512_set1_ps(min_ahead),
                    _mm512_load_si512(w.lane + 16 * k));
  }
  Keys all = _mm512_min_epu32(found[0], found[1]);
  if constexpr (registers == 4) all = _mm512_min_epu32(all, _mm512_min_epu32(found[2], found[3]));
  std::uint32_t const least = _mm512_reduce_min_epu32(all);
  // Without a lane that may be met the key is no number.
  if (!(std::bit_cast<float>(least & ~63U) <= static_cast<float>(contact.path) * (1.0F + 1e-6F))) return;
  look<way>(w, least & 63U, cell, flight, contact);
  Keys const bound = above(contact.path);
  std::uint64_t others = 0;
  for (unsigned k = 0; k < registers; ++k) others |= lanes_below(bound, found[k], 16 * k);
  for (others &= ~(std::uint64_t{1} << (least & 63U)); others != 0; others &= others - 1) [[unlikely]] {
      look<way>(w, static_cast<unsigned>(std::countr_zero(others)), cell, flight, contact);
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
