#include "other_program.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <set>
#include <string_view>
#include <system_error>

#include "gridlock/core/error.hpp"

namespace gridlock::cli {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "gridlock-";

bool is_word(std::string_view text) {
  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
  return !text.empty() && text.front() != '-' && text.find_first_not_of(letters) == std::string_view::npos;
}

bool is_program(fs::path const& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

/// Returns the directories of PATH. An empty entry means the working directory.
std::vector<fs::path> directories() {
  std::vector<fs::path> found{program_directory()};
  char const* const path = std::getenv("PATH");
  if (path == nullptr) return found;
  std::string_view rest = path;
  while (true) {
    std::size_t const end = rest.find(':');
    std::string_view const entry = rest.substr(0, end);
    found.emplace_back(entry.empty() ? "." : entry);
    if (end == std::string_view::npos) return found;
    rest.remove_prefix(end + 1);
  }
}

}  // namespace

fs::path program_directory() {
  std::error_code error;
  fs::path const self = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path("/usr/bin") : self.parent_path();
}

fs::path find_other_program(std::string const& word) {
  if (!is_word(word)) return {};
  for (fs::path const& directory : directories()) {
    fs::path program = directory / (std::string(prefix) + word);
    if (is_program(program)) return program;
  }
  return {};
}

std::vector<std::string> other_programs() {
  std::set<std::string> words;
  for (fs::path const& directory : directories()) {
    std::error_code error;
    for (fs::directory_iterator entry(directory, error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
      std::string const name = entry->path().filename().string();
      if (!name.starts_with(prefix)) continue;
      std::string word = name.substr(prefix.size());
      if (is_word(word) && is_program(entry->path())) words.insert(std::move(word));
    }
  }
  return {words.begin(), words.end()};
}

std::string python_package(std::string_view command) {
  return fmt::format("it comes with the Python package: pip install \".{}\" in the sources of Gridlock",
                     command == "plot"   ? "[plots]"
                     : command == "show" ? ""
                                         : "[paper]");
}

void become(fs::path const& program, std::vector<std::string> const& arguments) {
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (std::string const& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
  throw Error(
      {.what = fmt::format("{} could not be started: {}", program.string(), std::generic_category().message(errno)),
       .hint = "is it a program, or a script whose first line names one after #!?"});
}

}  // namespace gridlock::cli
