#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gridlock/io/h5md.hpp"
#include "gridlock/simulation/setup.hpp"
#include "gridlock/workspace/verify.hpp"
#include "workspace/hash_chain.hpp"

namespace gridlock {

/// Advances the simulation of a recorded run again and compares it with the record. The first difference goes into
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
  bool compare(HashLink const& link, std::uint64_t hash);
  bool compare_frame(std::size_t frame, std::uint64_t hash);
  [[nodiscard]] std::string difference_of_frame(std::size_t frame, std::uint64_t hash) const;
  bool differ(std::string difference);

  std::filesystem::path directory_;
  Setup const& setup_;
  Simulation& simulation_;
  StopCondition end_;  ///< of the whole run
  std::span<HashLink const> links_;
  Verification& found_;
  std::optional<H5mdReader> trajectory_;
  std::uint64_t known_step_ = 0;  ///< the last step at which replay and record agreed
};

}  // namespace gridlock
