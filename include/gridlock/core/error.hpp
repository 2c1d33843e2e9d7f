#pragma once

/// \file
/// The two errors that the library throws: Error for wrong input, RunFailure for a run that cannot continue.
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

/// One mistake in the input, as it is shown to the user.
struct Problem {
  std::string what;         ///< the mistake, with the numbers
  std::string hint;         ///< advice on how to correct the mistake; may be empty
  std::string key;          ///< the wrong setting with its table, "disks.packing_fraction"; may be empty
  std::string file;         ///< the file with the mistake; empty for input from no file
  int line = 0;             ///< from 1; 0 when unknown
  int column = 0;           ///< from 1; 0 when unknown
  std::string source_line;  ///< the text of the line with the mistake
};

/// Returns the text for the user: `what`, then `--> file:line:column   source` and `hint:` where they are known.
std::string to_text(Problem const& problem);

/// The error for input that cannot be used. It lists every problem found, not only the first. The command line then
/// ends with exit code 2.
class Error : public std::runtime_error {
 public:
  explicit Error(Problem problem);
  /// Contract: at least one problem.
  explicit Error(std::vector<Problem> problems);

  [[nodiscard]] std::vector<Problem> const& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// The error for a run that started and cannot continue (the physics broke an invariant, the disk is full). The command
/// line then ends with exit code 1.
class RunFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace gridlock
