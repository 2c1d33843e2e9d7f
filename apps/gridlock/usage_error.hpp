#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "gridlock/core/error.hpp"

namespace gridlock::cli {

/// The problem of a command line that CLI11 refused, with a hint: the setting that was meant, the option or command
/// with nearly the same name, or where the help is.
Problem usage_problem(CLI::App const& app, CLI::ParseError const& error, std::string const& first_word);

}  // namespace gridlock::cli
