#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace gridlock {

/// Adds a file that is about to be written to the list of results in its directory, `.gridlock.files`: one name a line.
///
/// The list is what remove_results() goes by. Names alone do not tell whose a file is: a user may keep a report.html,
/// an energy.png or a table beside the results, models and sweeps name files after their columns, and other versions
/// write other files. A name is listed before its file is written, so that a kill leaves no file that is not listed. A
/// list that cannot be written is no failure: the file itself cannot be written then either.
/// Errors: Error where something of that name is there that is not listed: protect_files() has not been asked in time.
void record_result(std::filesystem::path const& file);

/// The same where the directory has a list already: for files that a user may want anywhere, and often beside results.
/// The line is `NAME/MAKER` then, with the command that makes the file.
void record_further_result(std::filesystem::path const& file, std::string const& maker);

/// The same for several files. Those in a directory beside the first one are listed in that directory, in a list that
/// is made where it is missing, and that list is in the list of the first one.
void record_further_results(std::vector<std::filesystem::path> const& files, std::string const& maker);

/// The files that a command is about to write, and those it reads.
struct PlannedFiles {
  std::vector<std::filesystem::path> results;  ///< whether they are there already or not
  std::vector<std::filesystem::path> inputs;   ///< empty paths count for nothing
  std::string maker;                           ///< of files made on demand; empty for results of a directory
  std::string hint;                            ///< how to get files of the user out of the way
  bool overwrites = false;                     ///< whether the user has said that files of theirs may be replaced
};

/// Decides, for every command, whether it may write its files, before it writes the first.
///
/// Refused are always an input of the command, a directory, and a result that another command has made on demand or a
/// run has written where `maker` is given. Refused without `overwrites` is every file that is not listed in its
/// directory: Gridlock has not written it. With `overwrites` such files are listed: they are results from then on.
/// Devices, pipes and open descriptors such as /dev/stdout are written into and never refused.
/// Errors: Error under the key "-o".
void protect_files(PlannedFiles const& planned);

/// Refuses to remove the results in a directory where one of them is an input of the command that asks for it.
/// Errors: Error under the key "-o".
void protect_inputs(std::filesystem::path const& directory, std::span<std::filesystem::path const> inputs);

/// Whether the list of its directory names the file.
bool is_listed(std::filesystem::path const& file);

/// Whether the directory has a list of results. One that was copied without its hidden files has none.
bool has_list(std::filesystem::path const& directory);

/// Lists those of the files of a directory without a list that are there.
void adopt_results(std::filesystem::path const& directory, std::vector<std::filesystem::path> const& files);

/// Removes what the list of a directory names, summary.json first, of a sweep the runs that have lists of their own,
/// and what record_further_results() has listed in directories beside its first file. Directories with anything else in
/// them stay, and so does every file that is not listed.
void remove_results(std::filesystem::path const& directory);

}  // namespace gridlock
