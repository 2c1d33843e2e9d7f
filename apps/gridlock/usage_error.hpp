#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "gridlock/core/error.hpp"

namespace gridlock::cli {

/// Returns the problem of a command line that CLI11 refused. The hint names the intended setting, an option or command
/// with a similar name, or the help.
Problem usage_problem(CLI::App const& app, CLI::ParseError const& error, std::string const& first_word);

}  // namespace gridlock::cli
