#include "gridlock/run/result_files.hpp"

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace gridlock {

namespace {

namespace fs = std::filesystem;

constexpr char const* list_name = ".gridlock.files";

/// The names listed that stay within the directory, whoever has written the list.
std::vector<std::string> listed(fs::path const& directory) {
  std::vector<std::string> names;
  std::ifstream list(directory / list_name);
  for (std::string name; std::getline(list, name);) {
    bool const is_inside = !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
    if (is_inside) names.push_back(name);
  }
  return names;
}

/// Removes a file or a link, never a directory.
void remove_file(fs::path const& file) {
  std::error_code ignored;
  if (!fs::is_directory(fs::symlink_status(file, ignored))) fs::remove(file, ignored);
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

void record_result(fs::path const& file) {
  std::string const name = file.filename().string();
  std::vector<std::string> const names = listed(file.parent_path());
  if (std::ranges::find(names, name) != names.end()) return;
  std::ofstream list(file.parent_path() / list_name, std::ios::app);
  list << name + '\n' << std::flush;
}

void record_further_result(fs::path const& file) {
  std::error_code ignored;
  if (fs::exists(file.parent_path() / list_name, ignored)) record_result(file);
}

void remove_results(fs::path const& directory) {
  std::vector<std::string> const names = listed(directory);
  if (std::ranges::find(names, "summary.json") != names.end()) remove_file(directory / "summary.json");
  for (std::string const& name : names) remove_file(directory / name);
  bool const is_sweep = std::ranges::find(names, "plan.json") != names.end();
  std::error_code ignored;
  if (is_sweep && fs::is_directory(fs::symlink_status(directory / "runs", ignored))) remove_runs(directory / "runs");
  fs::remove(directory / list_name, ignored);
}

}  // namespace gridlock
