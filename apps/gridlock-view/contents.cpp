#include "contents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/observe/observable.hpp"
#include "io/file_format.hpp"

namespace gridlock::view {

namespace {

namespace fs = std::filesystem;

constexpr char const* only_run = "run";

std::vector<std::string> const& files_of_run() {
  static std::vector<std::string> const names = [] {
    std::vector<std::string> files{"config.resolved.toml", "run.log",    "summary.json",     "trajectory.h5",
                                   "series.csv",           "hashes.csv", "final.xyz",        "start.xyz",
                                   "stages.csv",           "levels.csv", "contacts.csv",     "swap_correlations.csv",
                                   "swap_density.csv",     "shear.csv",  "shear_events.csv", "shear_motions.csv",
                                   "shear_cycles.csv"};
    for (std::string_view const curve : names_of_curves()) files.push_back(std::string(curve) + ".csv");
    return files;
  }();
  return names;
}

std::vector<std::string> const& tables_of_sweep() {
  static std::vector<std::string> const names{"plan.json", "sweep.csv", "means.csv"};
  return names;
}

bool is_there(fs::path const& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// Returns whether a path is a directory and no link, since a link could lead out of the served directory.
bool is_own_directory(fs::path const& path) {
  std::error_code ignored;
  return fs::is_directory(fs::symlink_status(path, ignored));
}

bool holds_run(fs::path const& directory) {
  return std::ranges::any_of(std::array{"config.resolved.toml", "trajectory.h5", "final.xyz"},
                             [&](char const* name) { return is_there(directory / name); });
}

/// Returns whether a file is in HDF5 by its first bytes, since other programs use other extensions for trajectories.
bool is_trajectory(fs::path const& file) {
  auto const format = recognize_format(file);
  return format && format->id == "hdf5";
}
/// Returns whether a file is XYZ text that is not packed, since the page cannot unpack files.
bool is_xyz(fs::path const& file) { return file.extension() != ".gz" && has_xyz_ending(file); }

Kind kind_of(fs::path const& path) {
  std::error_code error;
  fs::file_status const status = fs::status(path, error);
  if (!fs::exists(status)) {
    throw Error(
        {.what = fmt::format("there is no {}{}", path.string(),
                             error && error != std::errc::no_such_file_or_directory ? ": " + error.message() : ""),
         .hint = "name the directory of a run or sweep, or an .h5 or .xyz file; gridlock show shows models and "
                 "settings"});
  }
  if (fs::is_directory(status)) {
    if (is_there(path / "plan.json") || is_own_directory(path / "runs")) return Kind::sweep;
    if (holds_run(path)) return Kind::run;
    throw Error({.what = fmt::format("{} holds neither a run nor a sweep", path.string()),
                 .hint = "a run has config.resolved.toml from its start; a sweep has runs/"});
  }
  auto const format = recognize_format(path);
  if (format && format->id != "hdf5")
    throw wrong_format(*format, path.string(), "a trajectory in H5MD or extended XYZ");
  if (fs::is_regular_file(status) && (is_trajectory(path) || is_xyz(path))) return Kind::file;
  throw Error({.what = fmt::format("{} cannot be shown", path.string()),
               .hint = "name the directory of a run or sweep, or an .h5 or .xyz file; gridlock show shows models and "
                       "settings"});
}

/// Returns whether a path is equal to a directory or inside it. Both must be free of links.
bool is_inside(fs::path const& path, fs::path const& directory) {
  auto const [rest, end] = std::mismatch(directory.begin(), directory.end(), path.begin(), path.end());
  return rest == directory.end();
}

}  // namespace

Contents::Contents(fs::path const& path) : kind_(kind_of(path)), name_(path.lexically_normal().string()) {
  if (name_.size() > 1 && name_.ends_with('/')) name_.pop_back();
  if (kind_ == Kind::sweep) tables_ = tables_of_sweep();
  root_ = fs::canonical(path);
}

std::vector<std::string> Contents::runs() const {
  if (kind_ != Kind::sweep) return {only_run};
  std::vector<std::string> names;
  if (!is_own_directory(root_ / "runs")) return names;
  std::error_code error;
  for (fs::directory_iterator entry(root_ / "runs", error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (is_own_directory(entry->path()) && holds_run(entry->path())) names.push_back(entry->path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

std::optional<ShownRun> Contents::run(std::string const& id) const {
  if (kind_ == Kind::sweep) {
    // An id must be one component of a path, so that it cannot lead to another directory.
    bool const is_component =
        !id.empty() && !id.starts_with('.') && id.find('/') == std::string::npos && id.find('\0') == std::string::npos;
    fs::path const directory = root_ / "runs" / id;
    if (!is_component || !is_own_directory(directory.parent_path()) || !is_own_directory(directory))
      return std::nullopt;
    return ShownRun{.id = id, .directory = directory, .files = files_of_run(), .trajectory = "trajectory.h5"};
  }
  if (id != only_run) return std::nullopt;
  if (kind_ == Kind::run) {
    return ShownRun{.id = id, .directory = root_, .files = files_of_run(), .trajectory = "trajectory.h5"};
  }
  std::string const file = root_.filename().string();
  return ShownRun{.id = id,
                  .directory = root_.parent_path(),
                  .files = {file},
                  .trajectory = is_trajectory(root_) ? file : std::string()};
}

std::optional<fs::path> Contents::find(std::optional<ShownRun> const& run, std::string const& name) const {
  std::vector<std::string> const& names = run ? run->files : tables_;
  if (std::ranges::find(names, name) == names.end()) return std::nullopt;
  std::error_code error;
  fs::path const place = fs::canonical((run ? run->directory : root_) / name, error);
  if (error || !is_inside(place, root_) || !fs::is_regular_file(place, error)) return std::nullopt;
  return place;
}

}  // namespace gridlock::view
