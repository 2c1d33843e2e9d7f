#include <algorithm>
#include <cmath>

#include "engine/exact/dynamics.hpp"
#include "engine/exact/strips.hpp"

namespace gridlock::exact {

namespace {

/// Factors of the caution after a window in which copies went wrong, and after a good window.
constexpr double more_caution = 1.2;
constexpr double less_caution = 0.99;
constexpr double max_caution = 5.0;
/// Largest number of hits of a disk in an epoch that threads share. With more, the epoch may have to end early at an
/// exact time, which only one thread finds.
constexpr std::uint64_t max_hits_in_shared_epoch = 512;

}  // namespace

bool Dynamics::share_epoch(double hits_per_time, bool is_sort_due) {
  // Strips note heights at events, and the top of a fall is none; times of contacts and reports stay with the whole.
  if (is_growing() || falls() || !last_contact_.empty() || reporting_.report != nullptr) return false;
  if (sharing_.threads == nullptr || sharing_.threads->size() < 2) return false;
  hits_per_time_ = hits_per_time;
  sharing_.caution = std::min(sharing_.caution, max_caution);
  StripPlan const plan = plan_strips();
  if (plan.count == 0) return false;
  lists_ = {.wish = lists_.wish};
  if (is_sort_due) {
    lay_cells(layout_for(2.0 * largest_radius_), 0.0);
    sort_disks_by_cell(0.0);
  }
  size_classes_.clear();
  cells_ = {};
  calendar_ = Calendar();
  if (strips_ == nullptr) strips_ = std::make_unique<Strips>(*sharing_.threads);
  strips_->begin(*this, plan, 0.0);
  return true;
}

double Dynamics::window() const { return strips_ != nullptr ? strips_->plan().window : 0.0; }

/// Adapts the caution so that wrong copies stay one to three diameters away from the copies that are compared.
void Dynamics::adapt_caution(double slack) {
  if (slack < 0.8) sharing_.caution *= 1.0 + 0.03 * (0.8 - slack);
  if (slack > 1.4) sharing_.caution = std::max(0.5, sharing_.caution * less_caution);
}

StripPlan Dynamics::plan_strips() const {
  return Strips::plan(*this, sharing_.threads->size(), hits_per_time_, sharing_.caution, sharing_.wherever_possible);
}

Dynamics::End Dynamics::run_shared(double elapsed, std::uint64_t pair_collisions, std::uint64_t audit_every,
                                   Counters& counters, std::function<bool()> const& should_continue) {
  double const target = elapsed - epoch_start_;
  double const end_of_run = std::min(target, epoch_length_);
  double const start = strips_->time();
  if (start < end_of_run) {
    std::uint64_t const hits = hits_ - hits_before_epoch_;
    bool const is_near_end = collisions_to_go(pair_collisions, audit_every, counters) < collisions_worth_sharing();
    if (is_near_end || hits > max_hits_in_shared_epoch * size_) {
      end_sharing();
      return End::sharing;
    }
    double const windows = std::ceil((end_of_run - start) / strips_->plan().window);
    double const end = windows > 1.0 ? start + (end_of_run - start) / windows : end_of_run;
    ++windows_.flown;
    if (!strips_->fly(*this, end, counters)) {
      ++windows_.given_up;
      sharing_.caution *= more_caution;
      StripPlan const wider = sharing_.caution < max_caution ? plan_strips() : StripPlan{};
      if (wider.count > 0) {
        strips_->begin(*this, wider, start);
      } else {
        end_sharing();
      }
      return End::sharing;
    }
    adapt_caution(strips_->slack() / (2.0 * largest_radius_));
    now_ = std::max(now_, strips_->last_event());
    hits_ += strips_->hits_in_window();
    watch_.looks += strips_->moves_in_window() / events_per_look;
    require_time_to_pass();
    if (should_continue && !should_continue()) return End::early;
    return End::sharing;
  }
  // Without further events the epoch is over, as it would be with one thread.
  if (!strips_->has_events()) return End::epoch;
  return End::time;
}

/// Continues on one thread from the time that the strips have reached.
void Dynamics::end_sharing() {
  double const time = strips_->time();
  strips_ = nullptr;
  renew_lists(time);
  make_room_in_cells(time);
  refresh_prediction_input();
  predict_all(time);
  open_calendar();
}

std::uint64_t Dynamics::events_made() const { return strips_ != nullptr ? strips_->events_made() : calendar_.made(); }

/// Returns the number of pair collisions until the run must stop or an audit is due.
std::uint64_t Dynamics::collisions_to_go(std::uint64_t pair_collisions, std::uint64_t audit_every,
                                         Counters const& counters) {
  std::uint64_t const done = counters.pair_collisions;
  std::uint64_t const to_go = pair_collisions > done ? pair_collisions - done : 0;
  return audit_every > 0 ? std::min(to_go, audit_every - done % audit_every) : to_go;
}

}  // namespace gridlock::exact
