#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "agent_table.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "model.hpp"

namespace gridlock::python {

/// A search among the agents of a model: for pairs of some rows, or for the neighbours of some rows among others.
struct SearchOfRows {
  bool is_for_pairs = false;
  double cutoff = 0.0;
  RowSpan seeking;
  RowSpan among;

  friend bool operator==(SearchOfRows const&, SearchOfRows const&) = default;
};

/// The results of the last searches among agents, which hold as long as no agent moves, is born or dies. The GIL guards
/// it.
class KeptSearches {
 public:
  /// Returns the result of a search, or nothing if it was not yet made for the agents as they are.
  /// Cost: a comparison of all positions with those of the search before, if they can have changed since.
  nb::object find(SearchOfRows const& search, AgentTable const& agents, bool can_have_changed) {
    if (can_have_changed) expect_changes();
    if (!is_current_ && (!std::ranges::equal(x_, agents.x()) || !std::ranges::equal(y_, agents.y()))) {
      results_.clear();
      x_.assign(agents.x().begin(), agents.x().end());
      y_.assign(agents.y().begin(), agents.y().end());
      ++version_;
    }
    is_current_ = true;
    auto const found = std::ranges::find(results_, search, &Result::search);
    return found == results_.end() ? nb::object() : nb::borrow(found->object.get());
  }
  /// Makes the next search compare the positions: agents can have moved, died or been born.
  void expect_changes() { is_current_ = false; }
  /// Keeps the result of a search that find() did not find when the version was `version`.
  void keep(SearchOfRows const& search, nb::object const& result, std::uint64_t version) {
    if (version != version_) return;
    if (results_.size() == max_results) results_.pop_front();
    results_.push_back({search, SharedObject(result)});
  }
  /// Returns how often positions were found to have changed.
  [[nodiscard]] std::uint64_t version() const { return version_; }

 private:
  static constexpr std::size_t max_results = 8;
  struct Result {
    SearchOfRows search;
    SharedObject object;
  };

  std::deque<Result> results_;
  LargeArray<double> x_;  ///< positions of the agents of the results
  LargeArray<double> y_;
  std::uint64_t version_ = 0;
  bool is_current_ = false;  ///< whether these are the positions of the agents now
};

}  // namespace gridlock::python
