#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gridlock {

/// Adds a file that is about to be written to the list of results in its directory, `.gridlock.files`: one name a line.
///
/// The list is what remove_results() goes by. Names alone do not tell whose a file is: a user may keep a report.html, an
/// energy.png or a table beside the results, models and sweeps name files after their columns, and other versions write
/// other files. A name is listed before its file is written, so that a kill leaves no file that is not listed. A list that
/// cannot be written is no failure: the file itself cannot be written then either.
void record_result(std::filesystem::path const& file);

/// The same where the directory has a list already: for files that a user may want anywhere, and often beside results.
/// The line is `NAME/MAKER` then, with the command that makes the file.
void record_further_result(std::filesystem::path const& file, std::string const& maker);

/// The same for several files. Those in a directory beside the first one are listed in that directory, in a list that
/// is made where it is missing, and that list is in the list of the first one.
void record_further_results(std::vector<std::filesystem::path> const& files, std::string const& maker);

/// Refuses a file that is a listed result, by its name or by a link, unless the same command has made it.
/// Errors: Error under the key "-o".
void require_no_other_result(std::filesystem::path const& file, std::string const& maker);

/// Removes what the list of a directory names, summary.json first, of a sweep the runs that have lists of their own, and
/// what record_further_results() has listed in directories beside its first file.
/// Directories with anything else in them stay, and so does every file that is not listed.
void remove_results(std::filesystem::path const& directory);

}  // namespace gridlock
