#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gridlock::cli {

/// Returns the directory of this program; /usr/bin if the system does not provide it.
std::filesystem::path program_directory();

/// Returns the program `gridlock-WORD` in the directory of this program or PATH; empty if there is none, or if the word
/// has characters other than letters, digits, - and _.
///
/// The prefix is always `gridlock-`, whatever the name of this program, so that programs with additional models find
/// gridlock-plot and programs of users too. Files that are not executable are skipped, as in a shell.
std::filesystem::path find_other_program(std::string const& word);

/// Returns the words of all programs gridlock-WORD, in alphabetical order. Cost: reads all directories of PATH.
std::vector<std::string> other_programs();

/// Returns how to install the Python package for a command; "plot", "show" and "paper" need different other packages.
std::string python_package(std::string_view command);

/// Replaces this process by the program, with the arguments after its word, so that output, exit code and signals are
/// the program's. Errors: Error if the system cannot start the program.
[[noreturn]] void become(std::filesystem::path const& program, std::vector<std::string> const& arguments);

}  // namespace gridlock::cli
