#include "workspace/continued_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <system_error>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/checkpoint.hpp"
#include "io/file.hpp"
#include "workspace/result_files.hpp"
#include "workspace/summary.hpp"

namespace gridlock {

std::string length_text(RunLength const& length) {
  std::vector<std::string> parts;
  if (length.steps) parts.push_back(fmt::format("{} steps", *length.steps));
  if (length.time) parts.push_back(fmt::format("time {}", *length.time));
  if (length.collisions_per_disk) parts.push_back(fmt::format("{} collisions per disk", *length.collisions_per_disk));
  return fmt::format("{}", fmt::join(parts, " or "));
}

namespace {

/// Throws an Error if a length is below the run's own of the same kind, since samples may exist beyond it.
void require_longer(RunSettings const& old, RunLength const& length, std::filesystem::path const& directory) {
  RunLength const had{.steps = old.steps, .time = old.time, .collisions_per_disk = old.collisions_per_disk};
  bool const is_shorter =
      (length.steps && had.steps && *length.steps < *had.steps) ||
      (length.time && had.time && *length.time < *had.time) ||
      (length.collisions_per_disk && had.collisions_per_disk && *length.collisions_per_disk < *had.collisions_per_disk);
  if (!is_shorter) return;
  throw Error({.what = fmt::format("the run in {} has a length of {} already, which {} is below", directory.string(),
                                   length_text(had), length_text(length)),
               .hint = "give the whole length, counted from the start of the run",
               .file = directory.string()});
}

void set_length(SettingsFile& file, RunLength const& length) {
  auto const set = [&](char const* key, char const* option, auto const& value) {
    file.leave_out(key);
    if (!value) return;
    std::string const text = fmt::format("{}", *value);
    file.set(key, text, {.file = option, .source_line = text});
  };
  set("run.steps", "--steps", length.steps);
  set("run.time", "--time", length.time);
  set("run.collisions_per_disk", "--collisions-per-disk", length.collisions_per_disk);
}

[[noreturn]] void refuse_finished(std::filesystem::path const& directory) {
  if (has_checkpoint(directory)) {
    throw Error({.what = fmt::format("the run in {} is finished", directory.string()),
                 .hint = fmt::format("gridlock resume {} --steps N lengthens it to N steps from its start",
                                     directory.string())});
  }
  throw Error(
      {.what = fmt::format("the run in {} is finished and kept no checkpoint to continue from", directory.string()),
       .hint = fmt::format("run {} in another directory with a longer run.steps",
                           (directory / configuration_name).string())});
}

bool are_same(RunSettings const& old, RunLength const& length) {
  return old.steps == length.steps && old.time == length.time && old.collisions_per_disk == length.collisions_per_disk;
}

}  // namespace

SettingsFile settings_to_continue(std::filesystem::path const& directory, std::optional<RunLength>& length) {
  remove_leftovers(directory);
  auto const summary = read_summary(directory);
  bool const is_finished = summary && summary->status == RunStatus::finished;
  if (is_finished && (!length || !has_checkpoint(directory))) refuse_finished(directory);
  SettingsFile file = SettingsFile::from_path(directory / configuration_name);
  if (!length) return file;
  Configuration const old = read_configuration(file);
  require_longer(old.run, *length, directory);
  // A run that was killed while it was lengthened already has the new length.
  if (!is_finished && are_same(old.run, *length)) length.reset();
  if (length) set_length(file, *length);
  return file;
}

void require_run(std::filesystem::path const& directory) {
  std::filesystem::path const path = directory / configuration_name;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    throw Error({.what = fmt::format("{} holds no run: there is no {}", directory.string(), configuration_name),
                 .hint = "name the directory of a run, or start one with gridlock run"});
  }
  require_regular_file(path);
}

}  // namespace gridlock
