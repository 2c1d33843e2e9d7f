#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gridlock::view {

/// A run to be shown, or a single file in the role of a run.
struct ShownRun {
  std::string id;  ///< id in requests: name of the run in a sweep, otherwise "run"
  std::filesystem::path directory;
  std::vector<std::string> files;  ///< names that may be served, of existing files or not
  std::string trajectory;          ///< name of the trajectory in H5MD; empty if there can be none
};

enum class Kind { run, sweep, file };

/// The runs, tables and files below a path of the command line that may be served. Only names on a fixed list are
/// served, and no symbolic links that lead out of the directory.
class Contents {
 public:
  /// Errors: Error if the path has nothing that can be shown.
  explicit Contents(std::filesystem::path const& path);

  [[nodiscard]] Kind kind() const { return kind_; }
  /// Returns the path as the user gave it.
  [[nodiscard]] std::string const& name() const { return name_; }
  /// Returns the names of the tables of a sweep.
  [[nodiscard]] std::vector<std::string> const& tables() const { return tables_; }
  /// Returns the ids of the runs. They are read at each call, since a sweep in progress adds runs.
  [[nodiscard]] std::vector<std::string> runs() const;
  [[nodiscard]] std::optional<ShownRun> run(std::string const& id) const;

  /// Returns the path of a file of a run, or of a table if `run` is nothing. Returns nothing if the name is not on the
  /// list, or the file is missing, not regular, or a link out of the directory.
  [[nodiscard]] std::optional<std::filesystem::path> find(std::optional<ShownRun> const& run,
                                                          std::string const& name) const;

 private:
  Kind kind_ = Kind::run;
  std::string name_;
  std::filesystem::path root_;  ///< without links; files outside are not served
  std::vector<std::string> tables_;
};

}  // namespace gridlock::view
