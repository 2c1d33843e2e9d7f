#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/saturating.hpp"
#include "gridlock/simulation/run.hpp"

namespace gridlock {

inline constexpr char const* hashes_name = "hashes.csv";
inline constexpr char const* states_name = "states";

/// A link of the chain of hashes: a hash of an input of the run, or of its state at a step.
struct HashLink {
  std::string of;  ///< "settings", "start", "stage 1" …, "run", "state" (kept in states/) or "end"
  std::uint64_t step = 0;
  std::uint64_t hash = 0;

  friend bool operator==(HashLink const&, HashLink const&) = default;
};

/// Returns the hash of all settings of a TOML text that affect results.
std::uint64_t hash_of_settings(std::string const& toml);

/// Writes links as a table, each line with a hash of itself and all lines before it. Errors: RunFailure.
void write_hashes(std::vector<HashLink> const& links, std::filesystem::path const& file);
/// Reads the table of write_hashes(). Errors: Error for a file that is missing or no such table.
std::vector<HashLink> read_hashes(std::filesystem::path const& file);
/// Returns the first line of the file that does not fit those before it, in words; empty if all fit.
std::string find_changed_line(std::filesystem::path const& file);

/// Returns the directory of the state that a run has kept at a step.
std::filesystem::path directory_of_state(std::filesystem::path const& run, std::uint64_t step);
/// Removes all kept states of a run, and no other file.
void remove_kept_states(std::filesystem::path const& run);

/// Records state hashes during a run, at samples: at least 100 steps apart, and between 100 and 200 of them in a long
/// run; of samples even in the logarithm each has one. They depend on the steps only, not on the length of the run or
/// on interruptions. Cost: one pass over the agents a hash, at most 0.2 % of a run of even samples.
///
/// States to be kept are recorded too. They are spread evenly along the run, at samples.
class HashChain final : public Writer {
 public:
  /// `keep` is called with the step of each state that is to be kept, `states` times in the whole run.
  HashChain(Run const& run, RunPlan const& plan, std::uint64_t states, std::function<void(std::uint64_t step)> keep);

  [[nodiscard]] bool is_due(std::uint64_t steps) const override;
  /// The run never stops for a hash.
  [[nodiscard]] std::uint64_t next_after(std::uint64_t) const override { return never_reached; }
  void write(Simulation const& simulation, std::span<double const> sample) override;
  void serialize(Archive& archive) override;

  [[nodiscard]] std::vector<HashLink> const& links() const { return links_; }

 private:
  [[nodiscard]] bool is_link_due(std::uint64_t steps) const;
  [[nodiscard]] bool is_state_due(std::uint64_t steps) const;
  void thin_out(std::uint64_t first_step);

  Run const& run_;
  RunPlan plan_;
  std::uint64_t every_;  ///< steps between links
  std::uint64_t states_;
  std::function<void(std::uint64_t)> keep_;
  Extent last_state_;  ///< length of the run at the last kept state
  std::vector<HashLink> links_;
};

}  // namespace gridlock
