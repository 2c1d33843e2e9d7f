#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace gridlock {

/// Adds a file to the list of results in its directory, `.gridlock.files`, before it is written. Each line is a name.
///
/// remove_results() removes only listed files. A name alone does not show who wrote a file: users keep files such as
/// report.html beside results, models and sweeps name files after columns, and other versions write other files. The
/// file is listed first, so that a kill leaves no unlisted file. Failure to write the list is ignored, since then the
/// file cannot be written either.
/// Errors: Error if an unlisted file of this name exists; call protect_files() first to find it in time.
void record_result(std::filesystem::path const& file);

/// Adds the line `NAME/MAKER` for a file that a command makes on request, if its directory has a list. Such files may
/// be written anywhere, and often beside results.
void record_further_result(std::filesystem::path const& file, std::string const& maker);

/// Calls record_further_result() for several files. Files in a directory beside the first file are listed in that
/// directory, in a new list if needed, and the directory is listed beside the first file.
void record_further_results(std::vector<std::filesystem::path> const& files, std::string const& maker);

/// The files that a command will write, and the files that it reads.
struct PlannedFiles {
  std::vector<std::filesystem::path> results;  ///< existing or not
  std::vector<std::filesystem::path> inputs;   ///< empty paths are ignored
  std::string maker;                           ///< command that makes files on request; empty for a run or sweep
  std::string hint;                            ///< hint for the error about files of the user
  bool overwrites = false;                     ///< whether the user allowed to replace own files
};

/// Checks whether a command may write its files, before it writes the first.
///
/// Never allowed is to replace an input of the command, a directory, or, if `maker` is given, a result of a run or of
/// another command. Files that are not listed in their directory, which Gridlock did not write, are replaced only with
/// `overwrites`, and are then listed as results. Devices, pipes and open descriptors such as /dev/stdout are always
/// written into. Errors: Error under the key "-o".
void protect_files(PlannedFiles const& planned);

/// Throws an Error if removing the results of a directory would remove an input of the command. Errors: Error under the
/// key "-o".
void protect_inputs(std::filesystem::path const& directory, std::span<std::filesystem::path const> inputs);

/// Returns whether the list of the file's directory contains the file.
bool is_listed(std::filesystem::path const& file);

/// Returns whether a directory has a list of results; a directory copied without hidden files has none.
bool has_list(std::filesystem::path const& directory);

/// Lists those of `files` that exist, if the directory has no list.
void adopt_results(std::filesystem::path const& directory, std::vector<std::filesystem::path> const& files);

/// Removes the files that a directory lists, summary.json first; of a sweep also the runs that have lists; and files of
/// record_further_results() in directories beside. Unlisted files stay, and so do directories that contain other files.
void remove_results(std::filesystem::path const& directory);

}  // namespace gridlock
