#include "workspace/result_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/checkpoint.hpp"
#include "io/file.hpp"
#include "workspace/hash_chain.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

constexpr char const* list_name = ".gridlock.files";

/// A line NAME or NAME/MAKER of the list of results.
struct Entry {
  std::string name;
  std::string maker;  ///< command that made the file on request; empty for results of a run or a sweep
};

/// Returns the entries of a directory's list, without names that lead out of it, since a list may be hostile.
std::vector<Entry> listed(fs::path const& directory) {
  std::vector<Entry> entries;
  std::error_code ignored;
  if (!fs::exists(directory / list_name, ignored)) return entries;
  require_regular_file(directory / list_name);
  std::ifstream list(directory / list_name);
  for (std::string line; std::getline(list, line);) {
    std::size_t const slash = line.find('/');
    Entry entry{.name = line.substr(0, slash), .maker = slash == std::string::npos ? "" : line.substr(slash + 1)};
    bool const is_inside = !entry.name.empty() && entry.name != "." && entry.name != "..";
    if (is_inside) entries.push_back(std::move(entry));
  }
  return entries;
}

bool has(std::vector<Entry> const& entries, char const* name) {
  return std::ranges::find(entries, name, &Entry::name) != entries.end();
}

/// Adds files of one directory to its list; files already listed are not repeated.
void add_to_list(std::span<fs::path const> files, std::string const& maker) {
  if (files.empty()) return;
  fs::path const directory = files.front().parent_path();
  std::set<std::pair<std::string, std::string>> known;
  for (Entry const& entry : listed(directory)) known.emplace(entry.name, entry.maker);
  std::string lines;
  for (fs::path const& file : files) {
    std::string const name = file.filename().string();
    if (!known.emplace(name, maker).second) continue;
    lines += maker.empty() ? fmt::format("{}\n", name) : fmt::format("{}/{}\n", name, maker);
  }
  if (lines.empty()) return;
  std::ofstream list(directory / list_name, std::ios::app);
  list << lines << std::flush;
}

void add_to_list(fs::path const& file, std::string const& maker) { add_to_list(std::span(&file, 1), maker); }

/// Returns the target of a symbolic link; the path itself if it is no link.
fs::path followed(fs::path const& path) {
  std::error_code ignored;
  fs::path const real = fs::is_symlink(path, ignored) ? fs::weakly_canonical(path, ignored) : path;
  return real.empty() ? path : real;
}

/// Removes a file or a link, but not a directory.
void remove_file(fs::path const& file) {
  std::error_code ignored;
  if (!fs::is_directory(fs::symlink_status(file, ignored))) fs::remove(file, ignored);
}

/// Removes the files of a listed directory if all are by `maker`, then the directory if it is empty. Does nothing if
/// the directory lists other files, for example a run of the user.
void remove_directory_of(std::string const& maker, fs::path const& directory) {
  std::error_code ignored;
  if (maker.empty() || !fs::is_directory(fs::symlink_status(directory, ignored))) return;
  std::vector<Entry> const entries = listed(directory);
  if (entries.empty() || !std::ranges::all_of(entries, [&](Entry const& entry) { return entry.maker == maker; }))
    return;
  remove_leftovers(directory);
  for (Entry const& entry : entries) remove_file(directory / entry.name);
  fs::remove(directory / list_name, ignored);
  fs::remove(directory, ignored);
}

void remove_runs(fs::path const& directory) {
  std::error_code error;
  std::vector<fs::path> runs;
  for (fs::directory_iterator entry(directory, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    std::error_code ignored;
    if (fs::is_directory(entry->symlink_status(ignored))) runs.push_back(entry->path());
  }
  std::error_code ignored;
  for (fs::path const& run : runs) {
    if (!fs::exists(run / list_name, ignored)) continue;
    remove_results(run);
    fs::remove(run, ignored);  // only succeeds if the directory is empty
  }
  fs::remove(directory, ignored);
}

/// Returns whether writing a file of this name would destroy an existing file. Devices, pipes and open descriptors are
/// written into instead.
bool is_in_the_way(fs::path const& file) {
  if (descriptor_named(file)) return false;
  std::error_code ignored;
  using enum fs::file_type;
  fs::file_type const type = fs::symlink_status(file, ignored).type();
  if (type != symlink) return type == regular || type == directory;
  fs::file_type const target = fs::status(file, ignored).type();
  return target == regular || target == directory || target == not_found;
}

/// Returns the full name of a command of the program or a function of the Python package.
std::string called(std::string const& maker) { return maker.starts_with("gridlock.") ? maker : "gridlock " + maker; }

/// Throws an Error if a file, or the target of a link, is a listed result of a command other than `maker`.
void require_no_other_result(fs::path const& file, std::string const& maker) {
  for (fs::path const& place : {file, followed(file)}) {
    std::vector<Entry> entries = listed(place.parent_path());
    // The list and the lock of the directory also count as results.
    if (!entries.empty()) entries.insert(entries.end(), {{list_name, ""}, {DirectoryLock::file_name, ""}});
    for (Entry const& entry : entries) {
      std::error_code ignored;
      bool const is_same =
          entry.name == place.filename() || fs::equivalent(place.parent_path() / entry.name, place, ignored);
      if (!is_same || entry.maker == maker) continue;
      throw Error({.what = fmt::format("{} is a result that {} must not replace",
                                       (place.parent_path() / entry.name).string(), called(maker)),
                   .hint = "name another file",
                   .key = "-o",
                   .file = file.string()});
    }
  }
}

/// Returns whether the list of the directory names `maker` as the maker of the file.
bool is_made_by(std::string const& maker, fs::path const& file) {
  std::string const name = file.filename().string();
  return std::ranges::any_of(listed(file.parent_path()),
                             [&](Entry const& entry) { return entry.name == name && entry.maker == maker; });
}

[[noreturn]] void refuse_input(fs::path const& input, char const* fate) {
  throw Error({.what = fmt::format("{} is read here, and would be {}", input.string(), fate),
               .hint = "name another file or directory to write",
               .key = "-o",
               .file = input.string()});
}

void require_no_input(fs::path const& file, std::vector<fs::path> const& inputs) {
  for (fs::path const& input : inputs) {
    std::error_code ignored;
    if (!input.empty() && fs::equivalent(file, input, ignored)) refuse_input(input, "replaced");
  }
}

Error foreign_files(std::vector<fs::path> const& files, std::string const& hint) {
  constexpr std::size_t max_named = 5;
  std::vector<std::string> names;
  for (fs::path const& file : files) names.push_back(file.string());
  std::string const further = names.size() > max_named ? fmt::format(" and {} more", names.size() - max_named) : "";
  names.resize(std::min(names.size(), max_named));
  return Error(
      {.what = fmt::format("{}{} would be replaced, which Gridlock has not written", fmt::join(names, ", "), further),
       .hint = hint,
       .key = "-o",
       .file = files.front().string()});
}

}  // namespace

bool is_listed(fs::path const& file) { return has(listed(file.parent_path()), file.filename().c_str()); }

bool has_list(fs::path const& directory) {
  std::error_code ignored;
  return fs::exists(directory / list_name, ignored);
}

void adopt_results(fs::path const& directory, std::vector<fs::path> const& files) {
  if (has_list(directory)) return;
  std::vector<fs::path> found;
  std::ranges::copy_if(files, std::back_inserter(found), is_in_the_way);
  add_to_list(found, "");
}

void protect_files(PlannedFiles const& planned) {
  std::map<fs::path, std::set<std::string>> known;  // sets, since a list may have thousands of names
  std::vector<fs::path> foreign;
  for (fs::path const& file : planned.results) {
    if (is_in_the_way(file)) require_no_input(file, planned.inputs);
    if (!planned.maker.empty()) require_no_other_result(file, planned.maker);
    if (!is_in_the_way(file)) continue;
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) {
      throw Error({.what = fmt::format("{} is a directory, and a file of that name is to be written", file.string()),
                   .hint = "move that directory away, or write elsewhere",
                   .key = "-o",
                   .file = file.string()});
    }
    if (!planned.maker.empty() && is_made_by(planned.maker, followed(file))) continue;
    auto const [place, is_new] = known.try_emplace(file.parent_path());
    if (is_new) {
      for (Entry const& entry : listed(file.parent_path())) place->second.insert(entry.name);
    }
    // A file that is planned twice is listed once.
    if (place->second.insert(file.filename().string()).second) foreign.push_back(file);
  }
  if (foreign.empty()) return;
  if (!planned.overwrites) throw foreign_files(foreign, planned.hint);
  for (fs::path const& file : foreign) {
    planned.maker.empty() ? add_to_list(file, "") : record_further_result(file, planned.maker);
  }
}

void protect_inputs(fs::path const& directory, std::span<fs::path const> inputs) {
  std::error_code ignored;
  fs::path const base = fs::weakly_canonical(directory, ignored);
  for (fs::path const& input : inputs) {
    if (input.empty()) continue;
    fs::path const real = fs::weakly_canonical(input, ignored);
    fs::path const inside = real.lexically_relative(base);
    auto const parts = std::distance(inside.begin(), inside.end());
    // remove_results() descends into the runs of a sweep, but no deeper.
    bool const is_within_reach = parts == 1 || (parts == 3 && *inside.begin() == "runs");
    if (is_within_reach && is_listed(real)) refuse_input(input, "removed with the other results there");
  }
}

void record_result(fs::path const& file) {
  if (is_in_the_way(file) && !is_listed(file)) throw foreign_files({file}, "move it away");
  add_to_list(file, "");
}

void record_further_result(fs::path const& file, std::string const& maker) {
  if (has_list(file.parent_path())) add_to_list(file, maker);
}

void record_further_results(std::vector<fs::path> const& files, std::string const& maker) {
  if (!has_list(files.front().parent_path())) return;
  add_to_list(files.front(), maker);
  std::span<fs::path const> const others = std::span(files).subspan(1);
  if (others.empty()) return;
  fs::path const directory = others.front().parent_path();
  add_to_list(directory, maker);
  std::error_code ignored;
  fs::create_directories(directory, ignored);
  add_to_list(others, maker);
}

void remove_results(fs::path const& directory) {
  std::vector<Entry> const entries = listed(directory);
  if (has(entries, "summary.json")) remove_file(directory / "summary.json");
  for (Entry const& entry : entries) {
    remove_file(directory / entry.name);
    remove_directory_of(entry.maker, directory / entry.name);
  }
  // Parts of checkpoints are not listed, since their names contain checksums.
  if (has(entries, "checkpoint.gridlock")) remove_checkpoints(directory);
  if (has(entries, states_name)) remove_kept_states(directory);
  std::error_code ignored;
  if (has(entries, "plan.json") && fs::is_directory(fs::symlink_status(directory / "runs", ignored))) {
    remove_runs(directory / "runs");
  }
  fs::remove(directory / list_name, ignored);
}

}  // namespace gridlock
