#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gridlock::view {

/// A run that is shown, or a file as if it were one.
struct ShownRun {
  std::string id;  ///< how requests name it: the name in a sweep, "run" otherwise
  std::filesystem::path directory;
  std::vector<std::string> files;  ///< names that may be served, whether they are there or not
  std::string trajectory;          ///< the one among them that holds frames in H5MD; empty where none may
};

enum class Kind { run, sweep, file };

/// The contents of a path on the command line, and the files of it that may be served: those on a fixed list of names,
/// inside the directory. Symbolic links that lead out of it are not followed.
class Contents {
 public:
  /// Errors: Error where there is nothing at the path that can be shown.
  explicit Contents(std::filesystem::path const& path);

  [[nodiscard]] Kind kind() const { return kind_; }
  /// As the user named it.
  [[nodiscard]] std::string const& name() const { return name_; }
  /// Tables of a sweep.
  [[nodiscard]] std::vector<std::string> const& tables() const { return tables_; }
  /// The names of the runs. Those of a sweep are looked up at each call, as new ones begin while it goes.
  [[nodiscard]] std::vector<std::string> runs() const;
  [[nodiscard]] std::optional<ShownRun> run(std::string const& id) const;

  /// The place of a file of a run, or of a table where `run` is nothing. Nothing where it is not on the list, missing,
  /// no regular file, or a link out of the directory.
  [[nodiscard]] std::optional<std::filesystem::path> find(std::optional<ShownRun> const& run,
                                                          std::string const& name) const;

 private:
  Kind kind_ = Kind::run;
  std::string name_;
  std::filesystem::path root_;  ///< without links; nothing outside is served
  std::vector<std::string> tables_;
};

}  // namespace gridlock::view
