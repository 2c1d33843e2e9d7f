// Straight event chains of equal hard disks in a periodic square box as a textbook writes them, the peer of the engine:
// a list of disks for each cell, +x and +y in turn, a random first disk, chains of a given length. It uses nothing of
// Gridlock.
//   gridlock_bench_plain_event_chain PACKING_FRACTION DISKS_ALONG_A_SIDE CHAINS

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <vector>

namespace {

constexpr int max_in_cell = 4;

class PlainChains {
 public:
  PlainChains(double packing_fraction, int along)
      : side_(std::sqrt(along * along * std::numbers::pi / (4.0 * packing_fraction))),  // diameters are 1
        cells_(static_cast<int>(side_)),
        width_(side_ / cells_),
        members_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_)),
        counts_(members_.size()) {
    double const step = side_ / along;
    for (int k = 0; k < along * along; ++k) {
      double const shift = (k / along) % 2 == 0 ? 0.25 : 0.75;
      places_.push_back({(k % along + shift) * step, (k / along + 0.5) * step});
      cell_of_.push_back(0);
      enter(k, cell_at(places_.back()));
    }
  }

  [[nodiscard]] double side() const { return side_; }

  /// Carries out a chain of this length; adds the jumps along it, and counts its events.
  void chain(int axis, double length, double& jumps, long& events) {
    int disk = static_cast<int>(uniform() * static_cast<double>(places_.size()));
    while (length > 0.0) {
      Event const event = next_event(disk, axis, std::fmin(length, width_));
      advance(disk, axis, event.path);
      length -= event.path;
      if (event.disk < 0) continue;
      ++events;
      jumps += event.jump;
      disk = event.disk;
    }
  }

 private:
  struct Event {
    double path;
    double jump;
    int disk;  ///< that is hit; −1: none
  };

  Event next_event(int disk, int axis, double farthest) const {
    auto const& p = places_[disk];
    int const across = 1 - axis;
    std::array<int, 2> const at{cell_of_[disk] % cells_, cell_of_[disk] / cells_};
    Event nearest{farthest, 0.0, -1};
    for (int forward = 0; forward <= 2; ++forward) {
      for (int beside = -1; beside <= 1; ++beside) {
        std::array<int, 2> there{};
        there[axis] = (at[axis] + forward) % cells_;
        there[across] = (at[across] + beside + cells_) % cells_;
        int const cell = there[1] * cells_ + there[0];
        for (int k = 0; k < counts_[cell]; ++k) {
          int const other = members_[cell][k];
          double ahead = places_[other][axis] - p[axis];
          double away = places_[other][across] - p[across];
          if (ahead < -0.5 * side_) ahead += side_;
          if (away > 0.5 * side_) away -= side_;
          if (away < -0.5 * side_) away += side_;
          if (ahead <= 0.0 || away * away >= 1.0) continue;
          double const contact = std::sqrt(1.0 - away * away);
          if (ahead - contact < nearest.path) nearest = {std::fmax(ahead - contact, 0.0), contact, other};
        }
      }
    }
    return nearest;
  }

  void advance(int disk, int axis, double path) {
    double& coordinate = places_[disk][axis];
    coordinate += path;
    if (coordinate >= side_) coordinate -= side_;
    int const now = cell_at(places_[disk]);
    if (now == cell_of_[disk]) return;
    leave(disk);
    enter(disk, now);
  }

  [[nodiscard]] int cell_at(std::array<double, 2> const& place) const {
    int const column = static_cast<int>(place[0] / width_) % cells_;
    int const row = static_cast<int>(place[1] / width_) % cells_;
    return row * cells_ + column;
  }
  void enter(int disk, int cell) {
    if (counts_[cell] == max_in_cell) std::abort();
    members_[cell][counts_[cell]++] = disk;
    cell_of_[disk] = cell;
  }
  void leave(int disk) {
    int const cell = cell_of_[disk];
    int k = 0;
    while (members_[cell][k] != disk) ++k;
    members_[cell][k] = members_[cell][--counts_[cell]];
  }
  double uniform() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }

  double side_;
  int cells_;  ///< along each side
  double width_;
  std::vector<std::array<int, max_in_cell>> members_;
  std::vector<int> counts_;
  std::vector<std::array<double, 2>> places_;
  std::vector<int> cell_of_;
  std::uint64_t state_ = 88172645463325252U;
};

}  // namespace

int main(int count, char** words) {
  if (count != 4) return 2;
  double const fraction = std::atof(words[1]);
  int const along = std::atoi(words[2]);
  long const chains = std::atol(words[3]);
  PlainChains disks(fraction, along);
  double const length = 0.3 * disks.side();
  double jumps = 0.0;
  long events = 0;
  long measured = 0;
  std::clock_t const begin = std::clock();
  for (long chain = 0; chain < chains; ++chain) {
    double of_chain = 0.0;
    disks.chain(static_cast<int>(chain % 2), length, of_chain, events);
    if (chain < chains / 4) continue;
    jumps += of_chain;
    ++measured;
  }
  double const seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("%d disks at %g: %.2f million events a second, Z = %.4f\n", along * along, fraction,
              1e-6 * static_cast<double>(events) / seconds, 1.0 + jumps / (static_cast<double>(measured) * length));
  return 0;
}
