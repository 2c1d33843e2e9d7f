#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "gridlock/io/h5md.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"
#include "gridlock/workspace/verify.hpp"
#include "simulation/frame_schedule.hpp"
#include "workspace/hash_chain.hpp"

namespace gridlock {

/// Keeps the sample of the step at which a run has stopped.
class LastSample final : public Writer {
 public:
  [[nodiscard]] bool is_due(std::uint64_t) const override { return true; }
  /// The run never stops for it.
  [[nodiscard]] std::uint64_t next_after(std::uint64_t) const override { return never_reached; }
  void write(Simulation const&, std::span<double const> sample) override {
    values_.emplace(sample.begin(), sample.end());
  }
  void serialize(Archive&) override {}

  void forget() { values_.reset(); }
  /// Returns one value for each column of the simulation, none where no sample was due; nothing where it is not known.
  [[nodiscard]] std::optional<std::vector<double>> const& values() const { return values_; }

 private:
  std::optional<std::vector<double>> values_;
};

/// Carries out a recorded run again and compares it with the record. The first difference goes into
/// Verification::difference, and each function returns whether there is none.
class Replay {
 public:
  /// Errors: Error for a trajectory.h5 that cannot be opened.
  Replay(std::filesystem::path const& directory, Setup const& setup, std::span<HashLink const> links,
         Verification& found);

  /// Replays from the start to the last link.
  bool replay_all(std::function<void(double)> const& on_progress);
  /// Replays from a kept state to the last link at most `steps` later, but to the next link at least.
  bool replay_window(HashLink const& state, std::uint64_t steps, std::function<void(double)> const& on_progress);
  /// Restores a kept state and compares its hash.
  bool restore(HashLink const& state);

 private:
  bool prepare();
  bool advance_to(std::uint64_t step, std::function<void(double)> const& on_progress);
  bool advance_to_end(HashLink const& end);
  void advance_run_to(std::uint64_t step);
  bool compare(HashLink const& link, std::uint64_t hash);
  bool compare_frame(std::uint64_t step, std::uint64_t hash);
  bool compare_results();
  [[nodiscard]] std::string difference_of_frame(std::size_t frame, std::uint64_t hash) const;
  [[nodiscard]] std::string difference_of_observables(std::vector<double> const& recorded) const;
  [[nodiscard]] std::set<std::uint64_t> frames_between(std::uint64_t first, std::uint64_t last) const;
  [[nodiscard]] bool is_frame_due(std::uint64_t step) const;
  bool differ(std::string difference);

  std::filesystem::path directory_;
  Setup const& setup_;
  Simulation& simulation_;
  Run run_;
  LastSample sample_;
  FrameSchedule schedule_;
  std::span<HashLink const> links_;
  Verification& found_;
  std::optional<H5mdReader> trajectory_;
  std::uint64_t known_step_ = 0;  ///< the last step at which replay and record agreed
};

}  // namespace gridlock
