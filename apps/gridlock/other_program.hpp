#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gridlock::cli {

/// The directory of this program; /usr/bin where the system does not tell.
std::filesystem::path program_directory();

/// The prefix of this program, whose bin and share are its own: the directory above the program's, or, where a wheel
/// with its libraries keeps programs in PREFIX/lib/pythonX.Y/site-packages/gridlock.scripts, that prefix.
std::filesystem::path installation();

/// The program `gridlock-WORD` in the directory of this program or in bin of its installation, else in the first
/// directory of PATH that has one; empty where there is none, and for a word of anything but letters, digits, - and _.
///
/// The prefix is `gridlock-` whatever this program is called: `plot` of a program with models of its own is the same
/// gridlock-plot, and what somebody puts on the path serves every such program.
/// A file that may not be executed, or that is none, is passed over, as a shell does.
std::filesystem::path find_other_program(std::string const& word);

/// The words of all such programs, each once, in alphabetical order. Cost: a walk through the directories of PATH.
std::vector<std::string> other_programs();

/// Where a command of Gridlock's own Python package comes from: "plot" and "paper" need different packages of others.
std::string python_package(std::string_view command);

/// Becomes the program, with the arguments that follow its word: its output, exit code and signals are those of this
/// process.
/// Errors: Error where the system cannot start it.
[[noreturn]] void become(std::filesystem::path const& program, std::vector<std::string> const& arguments);

}  // namespace gridlock::cli
