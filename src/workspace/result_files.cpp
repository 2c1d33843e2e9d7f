#include "workspace/result_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/checkpoint.hpp"
#include "io/file.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

constexpr char const* list_name = ".gridlock.files";

/// A line of the list. No name holds the slash that parts the two.
struct Entry {
  std::string name;
  std::string maker;  ///< the command that made it on demand; empty for what a run or a sweep writes by itself
};

/// The entries that stay within the directory, whoever has written the list.
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

/// Adds files of one directory to its list, each once.
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

/// Where a symbolic link leads; the path itself where it is none.
fs::path followed(fs::path const& path) {
  std::error_code ignored;
  fs::path const real = fs::is_symlink(path, ignored) ? fs::weakly_canonical(path, ignored) : path;
  return real.empty() ? path : real;
}

/// Removes a file or a link, never a directory.
void remove_file(fs::path const& file) {
  std::error_code ignored;
  if (!fs::is_directory(fs::symlink_status(file, ignored))) fs::remove(file, ignored);
}

/// Removes what a command has made in a directory that it has listed, and the directory where nothing else is in it.
/// One with anything else in its list, as a run of the user's there has, stays.
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
    fs::remove(run, ignored);  // only where nothing is left in it
  }
  fs::remove(directory, ignored);
}

}  // namespace

void record_result(fs::path const& file) { add_to_list(file, ""); }

void record_further_result(fs::path const& file, std::string const& maker) {
  std::error_code ignored;
  if (fs::exists(file.parent_path() / list_name, ignored)) add_to_list(file, maker);
}

void record_further_results(std::vector<fs::path> const& files, std::string const& maker) {
  std::error_code ignored;
  if (!fs::exists(files.front().parent_path() / list_name, ignored)) return;
  add_to_list(files.front(), maker);
  std::span<fs::path const> const others = std::span(files).subspan(1);
  if (others.empty()) return;
  fs::path const directory = others.front().parent_path();
  add_to_list(directory, maker);
  fs::create_directories(directory, ignored);
  add_to_list(others, maker);
}

void require_no_other_result(fs::path const& file, std::string const& maker) {
  for (fs::path const& place : {file, followed(file)}) {
    std::vector<Entry> entries = listed(place.parent_path());
    // By these Gridlock knows which files are results, and who works in the directory.
    if (!entries.empty()) entries.insert(entries.end(), {{list_name, ""}, {DirectoryLock::file_name, ""}});
    for (Entry const& entry : entries) {
      std::error_code ignored;
      bool const is_same =
          entry.name == place.filename() || fs::equivalent(place.parent_path() / entry.name, place, ignored);
      if (!is_same || entry.maker == maker) continue;
      throw Error({.what = fmt::format("{} is a result that gridlock {} must not replace",
                                       (place.parent_path() / entry.name).string(), maker),
                   .hint = "name another file",
                   .key = "-o",
                   .file = file.string()});
    }
  }
}

void remove_results(fs::path const& directory) {
  std::vector<Entry> const entries = listed(directory);
  if (has(entries, "summary.json")) remove_file(directory / "summary.json");
  for (Entry const& entry : entries) {
    remove_file(directory / entry.name);
    remove_directory_of(entry.maker, directory / entry.name);
  }
  // The names of their parts are not known before they are written.
  if (has(entries, "checkpoint.gridlock")) remove_checkpoints(directory);
  std::error_code ignored;
  if (has(entries, "plan.json") && fs::is_directory(fs::symlink_status(directory / "runs", ignored))) {
    remove_runs(directory / "runs");
  }
  fs::remove(directory / list_name, ignored);
}

}  // namespace gridlock
