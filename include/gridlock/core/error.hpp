#pragma once

/// \file
/// The two errors that the library throws: Error for input, RunFailure for a run that broke.
///
/// ```cpp
/// try {
///   throw Error({.what = "the temperature is -1", .hint = "use a number above 0", .key = "gas.temperature"});
/// } catch (Error const& error) {
///   for (Problem const& problem : error.problems()) std::string const text = to_text(problem);
/// }
/// ```

#include <stdexcept>
#include <string>
#include <vector>

namespace gridlock {

/// One thing that is wrong, in the words shown to the user.
struct Problem {
  std::string what;         ///< what is wrong, with the numbers
  std::string hint;         ///< what to do about it; may be empty
  std::string key;          ///< the setting to blame, dotted ("disks.packing_fraction"); may be empty
  std::string file;         ///< where it is; empty when it comes from no file
  int line = 0;             ///< from 1; 0 when unknown
  int column = 0;           ///< from 1; 0 when unknown
  std::string source_line;  ///< the text of that line
};

/// The text of a problem as the user reads it: `what`, then `--> file:line:column   source` and `hint:` where known.
std::string to_text(Problem const& problem);

/// The user's input cannot be used; carries every problem found, not only the first. Exit code 2 of the command line.
class Error : public std::runtime_error {
 public:
  explicit Error(Problem problem);
  /// Requires at least one problem.
  explicit Error(std::vector<Problem> problems);

  [[nodiscard]] std::vector<Problem> const& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// A run that started well could not continue (the physics broke an invariant, the disk is full). Exit code 1.
class RunFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace gridlock
