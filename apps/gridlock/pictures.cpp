#include "pictures.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

#include "drawing/process.hpp"
#include "other_program.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

/// Time limit for drawing, above the time for pictures of ten million disks.
constexpr std::chrono::minutes time_limit{10};

}  // namespace

void draw_pictures(std::filesystem::path const& directory, bool is_quiet) {
  std::filesystem::path const program = find_other_program("plot");
  if (program.empty()) {
    if (is_quiet) return;
    fmt::print(stderr, "note: the pictures are drawn by gridlock-plot, which is not installed: {}\n",
               python_package("plot"));
    return;
  }
  gridlock::ProcessResult const result = gridlock::run_process({program.string(), "--if-any", "--", directory.string()},
                                                               std::filesystem::current_path(), time_limit);
  if (result.timed_out) {
    fmt::print(stderr, "note: the pictures are not finished after {} minutes; later: {} plot {}\n", time_limit.count(),
               name_with_all_commands(), directory.string());
  } else if (!result.succeeded) {
    std::string_view const error = "error: ";
    std::size_t const begin = result.errors.starts_with(error) ? error.size() : 0;
    fmt::print(stderr, "note: the pictures could not be drawn: {}", result.errors.substr(begin));
  } else {
    fmt::print(stderr, "{}", result.errors);
  }
}

}  // namespace gridlock::cli
