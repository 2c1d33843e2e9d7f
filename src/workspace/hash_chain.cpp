#include "workspace/hash_chain.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/io/table.hpp"
#include "io/checkpoint.hpp"
#include "io/file.hpp"
#include "simulation/settings_difference.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t min_steps_between_links = 100;
constexpr std::size_t max_links = 200;

std::uint64_t hash_of_text(std::string_view text) { return XXH3_64bits(text.data(), text.size()); }

std::string hexadecimal(std::uint64_t number) { return fmt::format("{:016x}", number); }

/// Returns the hash of a line and, by `before`, of all lines before it.
std::string hash_of_line(std::string const& before, std::string const& of, std::uint64_t step,
                         std::string const& hash) {
  return hexadecimal(hash_of_text(fmt::format("{},{},{},{}", before, of, step, hash)));
}

Error no_chain(fs::path const& file, std::string const& why) {
  return Error({.what = fmt::format("{} is damaged: {}", file.string(), why),
                .hint = "put back a copy of the file; without it the run cannot be verified",
                .file = file.string()});
}

/// The columns of the table as they are in the file.
struct Lines {
  std::vector<std::string> of;
  std::vector<std::uint64_t> step;
  std::vector<std::string> hash;
  std::vector<std::string> chain;
};

/// Returns a column of the table whose entries have this type. Numbers in quotes are words.
template <class Value>
std::vector<Value> column_of(Table const& table, char const* name, fs::path const& file) {
  auto const* const values = table.contains(name) ? std::get_if<std::vector<Value>>(&table.column(name)) : nullptr;
  if (values == nullptr) throw no_chain(file, fmt::format("its column {} is missing or has other values", name));
  return *values;
}

Lines lines_of(fs::path const& file) {
  require_regular_file(file);
  Table const table = read_csv(file);
  if (table.row_count() == 0) throw no_chain(file, "it has no rows");
  return {.of = column_of<std::string>(table, "of", file),
          .step = column_of<std::uint64_t>(table, "step", file),
          .hash = column_of<std::string>(table, "hash", file),
          .chain = column_of<std::string>(table, "chain", file)};
}

}  // namespace

std::uint64_t hash_of_settings(std::string const& toml) {
  std::string text;
  for (auto const& [key, value] : setting_texts(toml, "config.resolved.toml")) {
    if (affects_results(key)) text += fmt::format("{} = {}\n", key, value);
  }
  return hash_of_text(text);
}

void write_hashes(std::vector<HashLink> const& links, fs::path const& file) {
  Lines lines;
  std::string before;
  for (HashLink const& link : links) {
    lines.of.push_back(link.of);
    lines.step.push_back(link.step);
    lines.hash.push_back(hexadecimal(link.hash));
    before = hash_of_line(before, link.of, link.step, lines.hash.back());
    lines.chain.push_back(before);
  }
  Table table;
  table.add_column("of", std::move(lines.of));
  table.add_column("step", std::move(lines.step));
  table.add_column("hash", std::move(lines.hash));
  table.add_column("chain", std::move(lines.chain));
  write_csv(table, file);
}

std::vector<HashLink> read_hashes(fs::path const& file) {
  Lines const lines = lines_of(file);
  std::vector<HashLink> links;
  for (std::size_t k = 0; k < lines.of.size(); ++k) {
    std::string const& digits = lines.hash[k];
    HashLink link{.of = lines.of[k], .step = lines.step[k]};
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), link.hash, 16);
    if (error != std::errc() || end != digits.data() + digits.size()) {
      throw no_chain(file, fmt::format("\"{}\" is no hash", digits));
    }
    links.push_back(std::move(link));
  }
  return links;
}

std::string find_changed_line(fs::path const& file) {
  Lines const lines = lines_of(file);
  std::string before;
  for (std::size_t k = 0; k < lines.of.size(); ++k) {
    before = hash_of_line(before, lines.of[k], lines.step[k], lines.hash[k]);
    if (before == lines.chain[k]) continue;
    constexpr std::size_t first_line = 2;  // behind the names
    return fmt::format("line {}, \"{}\" of step {},", k + first_line, lines.of[k], lines.step[k]);
  }
  return "";
}

fs::path directory_of_state(fs::path const& run, std::uint64_t step) {
  return run / states_name / fmt::format("{:012}", step);
}

void remove_kept_states(fs::path const& run) {
  std::error_code error;
  std::vector<fs::path> states;
  for (fs::directory_iterator entry(run / states_name, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    states.push_back(entry->path());
  }
  std::error_code ignored;
  for (fs::path const& state : states) {
    if (!fs::is_directory(fs::symlink_status(state, ignored))) continue;
    remove_leftovers(state);
    remove_checkpoints(state);
    fs::remove(state, ignored);  // only succeeds if the directory is empty
  }
  fs::remove(run / states_name, ignored);
}

HashChain::HashChain(Run const& run, RunPlan const& plan, std::uint64_t states, std::function<void(std::uint64_t)> keep)
    : run_(run),
      plan_(plan),
      every_((min_steps_between_links + plan.sample_every - 1) / plan.sample_every * plan.sample_every),
      states_(states),
      keep_(std::move(keep)) {}

bool HashChain::is_link_due(std::uint64_t steps) const {
  return plan_.samples_per_decade > 0 ? plan_.is_sample_due(steps) : steps % every_ == 0;
}

/// Returns whether another of equal parts of the run has ended since the last kept state.
bool HashChain::is_state_due(std::uint64_t steps) const {
  if (states_ == 0 || !plan_.is_sample_due(steps) || run_.has_reached_end()) return false;
  auto const part = [&](Extent const& extent) {
    return std::floor(static_cast<double>(states_ + 1) * run_.fraction_of(extent));
  };
  return part(run_.extent()) > part(last_state_);
}

bool HashChain::is_due(std::uint64_t steps) const { return is_link_due(steps) || is_state_due(steps); }

void HashChain::write(Simulation const& simulation, std::span<double const> /*sample*/) {
  std::uint64_t const steps = run_.extent().steps;
  std::uint64_t const step = simulation.clock().step;
  bool const is_state = is_state_due(steps);
  // The start has a link already, unless a protocol has made another state of it.
  if (steps == 0 && simulation.preparation().stages == 0) return;
  links_.push_back({.of = is_state ? "state" : "run", .step = step, .hash = simulation.state_hash()});
  if (is_state) {
    last_state_ = run_.extent();
    keep_(step);
  }
  thin_out(step - steps);
}

/// Removes every second link if there are too many, and takes them half as often from here on.
void HashChain::thin_out(std::uint64_t first_step) {
  auto const links = std::ranges::count(links_, "run", &HashLink::of);
  if (plan_.samples_per_decade > 0 || static_cast<std::size_t>(links) <= max_links) return;
  every_ *= 2;
  std::erase_if(links_,
                [&](HashLink const& link) { return link.of == "run" && (link.step - first_step) % every_ != 0; });
}

void HashChain::serialize(Archive& archive) {
  // Checkpoints of earlier versions have no chain.
  if (archive.is_restoring() && !archive.has("hashes")) return;
  std::vector<std::uint64_t> steps;
  std::vector<std::uint64_t> hashes;
  std::vector<std::uint64_t> are_states;
  for (HashLink const& link : links_) {
    steps.push_back(link.step);
    hashes.push_back(link.hash);
    are_states.push_back(link.of == "state" ? 1 : 0);
  }
  archive.visit("steps", steps);
  archive.visit("hashes", hashes);
  archive.visit("are_states", are_states);
  archive.visit("every", every_);
  serialize_inside(archive, "last_state", [&] { gridlock::serialize(archive, last_state_); });
  archive.require(hashes.size() == steps.size() && are_states.size() == steps.size() && every_ > 0,
                  "the steps and hashes of the run differ in number");
  links_.clear();
  for (std::size_t k = 0; k < steps.size(); ++k) {
    links_.push_back({.of = are_states[k] != 0 ? "state" : "run", .step = steps[k], .hash = hashes[k]});
  }
}

}  // namespace gridlock
