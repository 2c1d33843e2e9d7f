#include "lattice/insertion_on_ranks.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>

#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/exchange.hpp"
#include "lattice/random_insertion.hpp"

// One process takes the disks in an order, the largest first, and gives each the first of its points that overlaps no
// disk before it. Here a batch of disks next in the order looks for places together:
//
//     rank that draws        draws the points of a disk; disks are dealt out to ranks in turn, so that each batch is shared evenly
//     rank that has a place  has a slab of the box, with the disks in it and in a rim as wide as two disks that touch
//
// A point that overlaps a disk of an earlier batch fails for ever. Of the other points of a disk, its free points, the
// first counts that overlaps no chosen point of an earlier disk of the batch: it is chosen. Choices change until none
// has to: a point that is chosen may block free points of later disks, which then choose others. That ends, and with
// the choices of one process: those of the first disk of the batch are right after one round, and once those of the
// first n disks are right they stay, and those of disk n + 1 are right after another round. Most points block none, so
// that some rounds are enough for batches of any length.

namespace gridlock {

namespace {

/// The place of a disk in the order in which one process puts disks down.
struct PlaceInOrder {
  double radius;
  std::uint64_t row;
};
bool is_before(PlaceInOrder one, PlaceInOrder other) {
  return one.radius != other.radius ? one.radius > other.radius : one.row < other.row;
}
constexpr PlaceInOrder after_all{.radius = 0.0, .row = std::numeric_limits<std::uint64_t>::max()};

/// A point that a disk tries, the number of those before it, and who wants to know: the disk has a number on the rank
/// that draws.
struct Attempt {
  Vector p;
  PlaceInOrder place;
  std::uint64_t number;
  std::uint32_t rank;
  std::uint32_t disk;
};
/// A point of a disk has been chosen, or is no longer.
struct Choice {
  Attempt attempt;
  std::uint64_t is_chosen;
};
/// What a rank that has places says of a free point: whether a chosen one of an earlier disk blocks it.
struct FreePoint {
  Vector p;
  std::uint64_t number;
  std::uint32_t disk;
  std::uint32_t is_blocked;
};
struct Answer {
  std::uint32_t rank;
  FreePoint point;
};

/// The box cut into slabs of rows of cells across its longer side, one for each rank; a rank without a row has an empty
/// one.
class Slabs {
 public:
  Slabs(Box const& box, double largest_radius, std::uint64_t disks, std::size_t ranks)
      : is_turned_(box.width() > box.height()),
        layout_(layout_for_cutoff(is_turned_ ? Box(box.height(), box.width(), box.edge()) : box, 2.0 * largest_radius,
                                  disks)),
        rows_(RowDivision::even(static_cast<std::uint64_t>(layout_.rows()), ranks)),
        rim_(layout_.rows_within(2.0 * largest_radius)),
        owners_(static_cast<std::size_t>(layout_.rows())) {
    for (std::size_t row = 0; row < owners_.size(); ++row)
      owners_[row] = static_cast<std::uint32_t>(rows_.rank_of(row));
  }

  [[nodiscard]] std::size_t owner_of(Vector p) const {
    return owners_[static_cast<std::size_t>(layout_.row_of(along(p).y))];
  }
  /// Calls give(rank) once for each rank that has the point in its slab or in the rim of it.
  template <class Give>
  void for_each_rank_near(Vector p, Give give) const {
    int const row = layout_.row_of(along(p).y);
    bool const is_all = layout_.is_periodic() && 2 * rim_ + 1 >= layout_.rows();
    int first = is_all ? 0 : row - rim_;
    int end = is_all ? layout_.rows() : row + rim_ + 1;
    if (!layout_.is_periodic()) {
      first = std::max(first, 0);
      end = std::min(end, layout_.rows());
    }
    // Slabs follow one another, so that only the first of them may come again, around the box.
    std::uint32_t const first_owner = owners_[wrapped(first)];
    give(std::size_t{first_owner});
    std::uint32_t last = first_owner;
    for (int k = first + 1; k < end; ++k) {
      std::uint32_t const owner = owners_[wrapped(k)];
      if (owner != last && owner != first_owner) give(std::size_t{owner});
      last = owner;
    }
  }

  /// Cells of a slab and its rims: they follow one another, around the box if need be.
  struct Cells {
    int first = 0;
    std::size_t count = 0;
  };
  [[nodiscard]] Cells cells_of(std::size_t rank) const {
    if (rows_.rows_of(rank) == 0) return {};
    int first = static_cast<int>(rows_.first(rank)) - rim_;
    int end = static_cast<int>(rows_.end(rank)) + rim_;
    bool const is_all = end - first >= layout_.rows();
    if (is_all || !layout_.is_periodic()) {
      first = is_all ? 0 : std::max(first, 0);
      end = is_all ? layout_.rows() : std::min(end, layout_.rows());
    }
    return {.first = static_cast<int>(wrapped(first)) * layout_.columns(),
            .count = static_cast<std::size_t>(end - first) * static_cast<std::size_t>(layout_.columns())};
  }
  [[nodiscard]] int cell_of(Vector p) const { return layout_.cell_of(along(p)); }
  /// Calls visit(cell) for all cells with points nearer to p than `cutoff`.
  template <class Visit>
  void for_each_cell_near(Vector p, double cutoff, Visit visit) const {
    layout_.for_each_cell_in_block(cell_of(p), layout_.columns_within(cutoff), layout_.rows_within(cutoff), visit);
  }
  [[nodiscard]] int count_of_cells() const { return layout_.count(); }

 private:
  [[nodiscard]] Vector along(Vector p) const { return is_turned_ ? Vector{p.y, p.x} : p; }
  [[nodiscard]] std::size_t wrapped(int row) const {
    int const rows = layout_.rows();
    return static_cast<std::size_t>(row < 0 ? row + rows : row >= rows ? row - rows : row);
  }

  bool is_turned_;  ///< x and y are exchanged
  CellLayout layout_;
  RowDivision rows_;
  int rim_;  ///< rows on each side of a slab whose disks may touch one in it
  std::vector<std::uint32_t> owners_;
};

/// Things that are somewhere in a slab or its rims, listed by cell.
template <class Thing>
class SlabLists {
 public:
  SlabLists(Slabs const& slabs, std::size_t rank)
      : slabs_(slabs), cells_(slabs.cells_of(rank)), heads_(cells_.count, none) {}

  [[nodiscard]] std::vector<Thing> const& things() const { return things_; }
  [[nodiscard]] Thing& operator[](std::uint32_t number) { return things_[number]; }
  void reserve(std::size_t things) {
    things_.reserve(things);
    next_.reserve(things);
  }
  std::uint32_t insert(Thing const& thing) {
    auto const number = static_cast<std::uint32_t>(things_.size());
    std::uint32_t& head = heads_[place_of(slabs_.cell_of(thing.p))];
    things_.push_back(thing);
    next_.push_back(head);
    head = number;
    return number;
  }
  void clear() {
    for (Thing const& thing : things_) heads_[place_of(slabs_.cell_of(thing.p))] = none;
    things_.clear();
    next_.clear();
  }
  /// Calls visit(number, thing) for all that are nearer to p than `cutoff`, and some others, until it returns false.
  /// Cells of other slabs have none.
  template <class Visit>
  void for_each_near(Vector p, double cutoff, Visit visit) const {
    bool is_wanted = true;
    slabs_.for_each_cell_near(p, cutoff, [&](int cell) {
      if (is_wanted) is_wanted = visit_cell(cell, visit);
    });
  }
  /// The same for those in the cell of p.
  template <class Visit>
  void for_each_beside(Vector p, Visit visit) const {
    visit_cell(slabs_.cell_of(p), visit);
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  template <class Visit>
  bool visit_cell(int cell, Visit& visit) const {
    std::size_t const place = place_of(cell);
    if (place >= heads_.size()) return true;
    for (std::uint32_t k = heads_[place]; k != none; k = next_[k]) {
      if (!visit(k, things_[k])) return false;
    }
    return true;
  }
  [[nodiscard]] std::size_t place_of(int cell) const {
    int const place = cell - cells_.first;
    return static_cast<std::size_t>(place < 0 ? place + slabs_.count_of_cells() : place);
  }

  Slabs const& slabs_;
  Slabs::Cells cells_;
  std::vector<Thing> things_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> heads_;
};

/// The places in a slab: what is there, and which points of a batch are free.
class PlacesOfSlab {
 public:
  PlacesOfSlab(Box const& box, Slabs const& slabs, std::size_t rank, double largest_radius, std::size_t likely_disks)
      : box_(box), largest_(largest_radius), placed_(slabs, rank), free_(slabs, rank) {
    placed_.reserve(likely_disks);
  }

  /// A point in the slab: an answer, unless it overlaps a disk of an earlier batch.
  void try_point(Attempt const& attempt) {
    bool is_free = true;
    placed_.for_each_near(attempt.p, attempt.place.radius + largest_, [&](std::uint32_t /*number*/, Disk const& disk) {
      is_free = !overlap(attempt.p, attempt.place.radius, disk.p, disk.radius);
      return is_free;
    });
    if (!is_free) return;
    Candidate candidate{attempt};
    candidate.is_in_slab = true;
    for_each_overlapping(attempt, [&](std::uint32_t /*number*/, Candidate const& other) {
      if (other.is_chosen && is_before(other.place, attempt.place)) ++candidate.blockers;
    });
    candidate.was_blocked = candidate.blockers > 0;
    free_.insert(candidate);
    answers_.push_back(answer_of(candidate));
  }

  /// A point in the slab or its rims, which blocks others.
  void change(Choice const& choice) {
    Candidate& chosen = free_[number_of(choice.attempt)];
    chosen.is_chosen = choice.is_chosen != 0;
    for_each_overlapping(choice.attempt, [&](std::uint32_t number, Candidate const& other) {
      if (!other.is_in_slab || !is_before(choice.attempt.place, other.place)) return;
      std::uint32_t& blockers = free_[number].blockers;
      chosen.is_chosen ? ++blockers : --blockers;
      changed_.push_back(number);
    });
  }
  /// After the choices of all ranks: answers for the points that are blocked now and were not, or the other way round.
  void answer_changes() {
    for (std::uint32_t const number : changed_) {
      Candidate& candidate = free_[number];
      if ((candidate.blockers > 0) == candidate.was_blocked) continue;
      candidate.was_blocked = !candidate.was_blocked;
      answers_.push_back(answer_of(candidate));
    }
    changed_.clear();
  }

  [[nodiscard]] std::vector<Answer> const& answers() const { return answers_; }
  void forget_answers() { answers_.clear(); }

  /// As if the batch had not begun.
  void forget_batch() { free_.clear(); }
  /// The batch is over: disks stay where they have chosen to be.
  void keep_chosen() {
    for (Candidate const& candidate : free_.things()) {
      if (candidate.is_chosen) placed_.insert({.p = candidate.p, .radius = candidate.place.radius});
    }
    free_.clear();
  }

 private:
  struct Disk {
    Vector p;
    double radius;
  };
  /// A point that overlaps no disk of an earlier batch.
  struct Candidate : Attempt {
    std::uint32_t blockers = 0;  ///< chosen points of earlier disks that overlap it
    bool is_in_slab = false;     ///< otherwise in a rim, where other ranks say what is blocked
    bool is_chosen = false;
    bool was_blocked = false;  ///< when the rank that draws was told last
  };

  [[nodiscard]] bool overlap(Vector one, double radius_of_one, Vector other, double radius_of_other) const {
    double const contact = radius_of_one + radius_of_other;
    return squared_length(box_.displacement(one, other)) < contact * contact;
  }
  template <class Visit>
  void for_each_overlapping(Attempt const& attempt, Visit visit) const {
    free_.for_each_near(attempt.p, attempt.place.radius + largest_, [&](std::uint32_t number, Candidate const& other) {
      if (overlap(attempt.p, attempt.place.radius, other.p, other.place.radius)) visit(number, other);
      return true;
    });
  }
  /// That of the point, which a rim may not have yet.
  std::uint32_t number_of(Attempt const& attempt) {
    std::optional<std::uint32_t> found;
    free_.for_each_beside(attempt.p, [&](std::uint32_t number, Candidate const& other) {
      if (other.place.row == attempt.place.row && other.number == attempt.number) found = number;
      return !found;
    });
    return found ? *found : free_.insert({attempt});
  }
  static Answer answer_of(Candidate const& candidate) {
    return {.rank = candidate.rank,
            .point = {.p = candidate.p,
                      .number = candidate.number,
                      .disk = candidate.disk,
                      .is_blocked = candidate.was_blocked ? 1U : 0U}};
  }

  Box box_;
  double largest_;
  SlabLists<Disk> placed_;
  SlabLists<Candidate> free_;
  std::vector<std::uint32_t> changed_;
  std::vector<Answer> answers_;
};

/// A disk of the batch that looks for its place.
class Seeker {
 public:
  void begin(PlaceInOrder place, std::uint64_t seed, Box const& box) {
    place_ = place;
    random_ = places_of(seed, place.row);
    centres_ = AllowedCentres(box, place.radius);
    drawn_ = 0;
    free_.clear();
    chosen_.reset();
    was_blocked_ = false;
  }

  [[nodiscard]] PlaceInOrder place() const { return place_; }
  [[nodiscard]] std::uint64_t drawn() const { return drawn_; }
  [[nodiscard]] bool was_blocked() const { return was_blocked_; }
  [[nodiscard]] std::size_t kept() const { return free_.size(); }
  Attempt draw(std::uint32_t rank, std::uint32_t disk) {
    return {.p = centres_.draw(random_), .place = place_, .number = drawn_++, .rank = rank, .disk = disk};
  }

  void take(FreePoint const& point) {
    auto const at = std::ranges::lower_bound(free_, point.number, {}, &FreePoint::number);
    if (at != free_.end() && at->number == point.number) {
      *at = point;
    } else {
      free_.insert(at, point);
    }
    was_blocked_ = was_blocked_ || point.is_blocked != 0;
  }
  /// The first point that nothing blocks.
  [[nodiscard]] FreePoint const* best() const {
    auto const at = std::ranges::find(free_, 0U, &FreePoint::is_blocked);
    return at == free_.end() ? nullptr : &*at;
  }
  /// Points before it, as far as they are known.
  [[nodiscard]] std::uint64_t failures() const {
    FreePoint const* const point = best();
    return point == nullptr ? drawn_ : point->number;
  }
  [[nodiscard]] std::optional<FreePoint> const& chosen() const { return chosen_; }
  [[nodiscard]] bool has_to_choose() const {
    FreePoint const* const point = best();
    if (point == nullptr || !chosen_) return (point != nullptr) != chosen_.has_value();
    return point->number != chosen_->number;
  }
  void choose() {
    FreePoint const* const point = best();
    chosen_ = point == nullptr ? std::nullopt : std::optional(*point);
  }
  [[nodiscard]] Choice choice_of(FreePoint const& point, bool is_chosen) const {
    return {.attempt = {.p = point.p, .place = place_, .number = point.number, .rank = 0, .disk = 0},
            .is_chosen = is_chosen ? std::uint64_t{1} : 0};
  }

 private:
  PlaceInOrder place_{};
  RandomStream random_{0, 0, 0, Purpose::start_position};
  AllowedCentres centres_{Box(), 0.0};
  std::uint64_t drawn_ = 0;
  std::vector<FreePoint> free_;  ///< in the order in which they were drawn
  std::optional<FreePoint> chosen_;
  bool was_blocked_ = false;  ///< one of them at some time
};

/// The part of one rank.
class PartOfInsertion {
 public:
  PartOfInsertion(Communicator& ranks, Box const& box, double largest_radius, std::uint64_t count, std::uint64_t seed)
      : ranks_(ranks),
        box_(box),
        seed_(seed),
        count_(count),
        slabs_(box, largest_radius, count, ranks.count()),
        places_(box_, slabs_, ranks.rank(), largest_radius, count / ranks.count() + count / ranks.count() / 8),
        attempts_left_(max_attempts_for(count)) {}

  /// Deals the disks out to the ranks that draw their points.
  void deal(std::span<double const> radii_of_own_rows, std::uint64_t first_row) {
    disks_.reserve(count_ / ranks_.count() + 1);
    exchange_values<PlaceInOrder>(
        ranks_, radii_of_own_rows.size(),
        [&](std::size_t k, auto give) {
          std::uint64_t const row = first_row + k;
          give(static_cast<std::size_t>(row % ranks_.count()),
               PlaceInOrder{.radius = radii_of_own_rows[k], .row = row});
        },
        [&](PlaceInOrder const& place) { disks_.push_back({.place = place, .site = {}}); });
    std::ranges::sort(disks_, is_before, &Disk::place);
  }

  void place_all() {
    while (placed_ < count_ && !end_) {
      begin_batch();
      do {
        search();
        choose();
        look_at_batch();
      } while (sums_[busy] > 0 && !is_crowded());
      sums_[busy] == 0 ? finish_batch() : give_batch_up();
    }
  }

  [[nodiscard]] InsertedRows result(RowDivision const& rows) {
    InsertedRows result{.sites = std::vector<Vector>(rows.rows_of(ranks_.rank())), .placed = placed_};
    struct Site {
      std::uint64_t row;
      Vector site;
    };
    ExactSum covered;
    exchange_values<Site>(
        ranks_, next_,
        [&](std::size_t k, auto give) {
          covered.add(std::numbers::pi * disks_[k].place.radius * disks_[k].place.radius);
          give(rows.rank_of(disks_[k].place.row), Site{.row = disks_[k].place.row, .site = disks_[k].site});
        },
        [&](Site const& site) { result.sites[site.row - rows.first(ranks_.rank())] = site.site; });
    all_sum(ranks_, std::span(&covered, 1));
    result.packing_fraction = covered.value() / box_.area();
    return result;
  }

 private:
  struct Disk {
    PlaceInOrder place;
    Vector site;
  };

  /// The next disks of the order, about as many on each rank.
  void begin_batch() {
    PlaceInOrder last = after_all;
    if (next_ + share_ <= disks_.size()) last = disks_[next_ + share_ - 1].place;
    all_combine(ranks_, std::span(&last, 1), [](PlaceInOrder& first, PlaceInOrder const& other) {
      if (is_before(other, first)) first = other;
    });
    std::size_t end = next_;
    while (end < disks_.size() && !is_before(last, disks_[end].place)) ++end;
    size_ = end - next_;
    if (seekers_.size() < size_) seekers_.resize(size_);
    for (std::size_t k = 0; k < size_; ++k) seekers_[k].begin(disks_[next_ + k].place, seed_, box_);
  }

  [[nodiscard]] std::span<Seeker> seekers() { return std::span(seekers_).first(size_); }
  [[nodiscard]] std::span<Seeker const> seekers() const { return std::span(seekers_).first(size_); }
  /// How many of the batch come before the end of the insertion.
  [[nodiscard]] std::size_t count_before_end() const {
    if (!end_) return size_;
    std::size_t count = 0;
    while (count < size_ && is_before(seekers_[count].place(), *end_)) ++count;
    return count;
  }
  /// How many points a disk of the batch draws now: as many again as before, while nothing tells that its next point is
  /// free.
  [[nodiscard]] std::uint64_t points_of(Seeker const& seeker) const {
    if (seeker.best() != nullptr) return 0;
    std::uint64_t const most = attempts_left_ - std::min(attempts_left_, seeker.drawn());
    return std::min(std::max(seeker.drawn(), first_points_), most);
  }

  /// Those that have no point draw some, and learn which are free.
  void search() {
    std::size_t const end = count_before_end();
    std::vector<std::uint64_t> points(end);
    std::uint64_t count = 0;
    // The first ones first: where one finds no place, those behind it need not try.
    for (std::size_t k = 0; k < end && count < max_points_of_round; ++k) {
      points[k] = std::min(points_of(seekers_[k]), max_points_of_round - count);
      count += points[k];
    }
    std::size_t disk = 0;
    exchange_values<Attempt>(
        ranks_, count,
        [&](std::size_t /*number*/, auto give) {
          while (points[disk] == 0) ++disk;
          --points[disk];
          Attempt const attempt =
              seekers_[disk].draw(static_cast<std::uint32_t>(ranks_.rank()), static_cast<std::uint32_t>(disk));
          give(slabs_.owner_of(attempt.p), attempt);
        },
        [&](Attempt const& attempt) { places_.try_point(attempt); });
    exchange_answers();
  }

  /// All choose their first point that is not blocked, and learn what has become of their points thereby.
  void choose() {
    std::vector<Choice> choices;
    std::size_t const end = count_before_end();
    for (std::size_t k = 0; k < end; ++k) {
      Seeker& seeker = seekers_[k];
      if (!seeker.has_to_choose()) continue;
      if (seeker.chosen()) choices.push_back(seeker.choice_of(*seeker.chosen(), false));
      seeker.choose();
      if (seeker.chosen()) choices.push_back(seeker.choice_of(*seeker.chosen(), true));
    }
    exchange_values<Choice>(
        ranks_, choices.size(),
        [&](std::size_t k, auto give) {
          slabs_.for_each_rank_near(choices[k].attempt.p, [&](std::size_t rank) { give(rank, choices[k]); });
        },
        [&](Choice const& choice) { places_.change(choice); });
    places_.answer_changes();
    exchange_answers();
  }

  void exchange_answers() {
    std::vector<Answer> const& answers = places_.answers();
    exchange_values<FreePoint>(
        ranks_, answers.size(), [&](std::size_t k, auto give) { give(answers[k].rank, answers[k].point); },
        [&](FreePoint const& point) { seekers_[point.disk].take(point); });
    places_.forget_answers();
  }

  /// Who has to draw or to choose still. Those behind the end need not: if all before it have what one process gives
  /// them, so has the end.
  void look_at_batch() {
    end_.reset();
    sums_ = sums_of_batch();
    if (sums_[failures] < attempts_left_) return;
    end_ = find_end();
    sums_ = sums_of_batch();
  }
  /// Where disks of one batch block most points of another, these are kept and looked at again and again. A batch of
  /// one disk keeps one.
  [[nodiscard]] bool is_crowded() const { return share_ > 1 && sums_[kept] > 4 * sums_[disks] + 1000; }

  enum Sum : std::size_t { busy, failures, blocked, disks, kept, number_of_sums };
  using Sums = std::array<std::uint64_t, number_of_sums>;
  /// Of the disks of all ranks before the end.
  [[nodiscard]] Sums sums_of_batch() {
    Sums sums{};
    sums[disks] = count_before_end();
    for (Seeker const& seeker : seekers().first(sums[disks])) {
      if (seeker.has_to_choose() || points_of(seeker) > 0) ++sums[busy];
      if (seeker.was_blocked()) ++sums[blocked];
      sums[failures] += seeker.failures();
      sums[kept] += seeker.kept();
    }
    all_sum(ranks_, std::span<std::uint64_t>(sums));
    return sums;
  }

  /// The disk at which the insertion is given up, as far as it is known: where the failures of all before it and its
  /// own use the attempts up. Every rank looks at all disks of the batch that failed. Batches are short by then: few
  /// points are free, and those block each other.
  [[nodiscard]] PlaceInOrder find_end() {
    struct Failed {
      PlaceInOrder place;
      std::uint64_t failures;
    };
    std::vector<Failed> own;
    for (Seeker const& seeker : seekers()) {
      if (seeker.failures() > 0) own.push_back({.place = seeker.place(), .failures = seeker.failures()});
    }
    std::vector<Failed> all;
    for (Message const& bytes : all_gather(ranks_, message_of_all(std::span<Failed const>(own)))) {
      std::vector<Failed> const some = MessageReader(bytes).rest<Failed>();
      all.insert(all.end(), some.begin(), some.end());
    }
    std::ranges::sort(all, is_before, &Failed::place);
    std::uint64_t so_far = 0;
    auto const end = std::ranges::find_if(all, [&](Failed const& failed) {
      so_far += failed.failures;
      return so_far >= attempts_left_;
    });
    assert(end != all.end());
    return end->place;
  }

  /// It begins again, with fewer disks.
  void give_batch_up() {
    places_.forget_batch();
    end_.reset();
    share_ = std::max<std::size_t>(share_ / 4, 1);
  }

  void finish_batch() {
    std::size_t const end = count_before_end();
    for (std::size_t k = 0; k < end; ++k) disks_[next_ + k].site = seekers_[k].chosen()->p;
    next_ += end;
    placed_ += sums_[disks];
    if (end_) return;
    places_.keep_chosen();
    attempts_left_ -= sums_[failures];
    // Batches are as long as they can be while few of their points block one another.
    if (4 * sums_[blocked] > sums_[disks]) share_ = std::max<std::size_t>(share_ / 2, 1);
    if (8 * sums_[blocked] < sums_[disks]) share_ = std::min<std::size_t>(2 * share_, max_of_batch);
    first_points_ = 1 + sums_[failures] / sums_[disks] / 4;
  }

  /// Disks of a batch on each rank.
  static constexpr std::size_t first_of_batch = 64;
  static constexpr std::size_t max_of_batch = std::size_t{1} << 15;
  /// Points that a rank draws at once.
  static constexpr std::uint64_t max_points_of_round = std::uint64_t{1} << 16;

  Communicator& ranks_;
  Box box_;
  std::uint64_t seed_;
  std::uint64_t count_;  ///< of disks on all ranks
  Slabs slabs_;
  PlacesOfSlab places_;
  std::vector<Disk> disks_;   ///< whose points this rank draws, in the order of the insertion
  std::size_t next_ = 0;      ///< the first of them without a place
  std::uint64_t placed_ = 0;  ///< disks of all ranks that have a place
  std::uint64_t attempts_left_;
  std::vector<Seeker> seekers_;  ///< the first are the batch, in the order of the insertion
  std::size_t size_ = 0;
  std::size_t share_ = first_of_batch;
  std::uint64_t first_points_ = 1;  ///< that a disk draws at once at first
  std::optional<PlaceInOrder> end_;
  Sums sums_{};
};

}  // namespace

InsertedRows insert_on_ranks(Communicator& ranks, Box const& box, std::span<double const> radii_of_own_rows,
                             RowDivision const& rows, std::uint64_t seed) {
  double const own_largest = radii_of_own_rows.empty() ? 0.0 : *std::ranges::max_element(radii_of_own_rows);
  double const largest = -all_min(ranks, -own_largest);
  if (AllowedCentres(box, largest).are_none()) {
    return {.sites = std::vector<Vector>(radii_of_own_rows.size()), .placed = 0, .packing_fraction = 0.0};
  }
  PartOfInsertion part(ranks, box, largest, rows.rows(), seed);
  part.deal(radii_of_own_rows, rows.first(ranks.rank()));
  part.place_all();
  return part.result(rows);
}

}  // namespace gridlock
