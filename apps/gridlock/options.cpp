#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <utility>

#include "verbs.hpp"

namespace gridlock::cli {

namespace {
std::string name_of_program = "gridlock";
}

std::string const& program_name() { return name_of_program; }

void set_program_name(std::string name) { name_of_program = std::move(name); }
void set_program_name_of(int argc, char** argv) {
  if (argc > 0) set_program_name(std::filesystem::path(argv[0]).filename().string());
}

std::string name_with_all_commands() {
  std::string const suffix = "-mpi";
  bool const has_suffix = name_of_program.size() > suffix.size() && name_of_program.ends_with(suffix);
  return has_suffix ? name_of_program.substr(0, name_of_program.size() - suffix.size()) : name_of_program;
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
  bool const is_bounded = most < std::numeric_limits<std::uint64_t>::max();
  std::string const range = is_bounded ? fmt::format("from {} to {}", least, most) : fmt::format("at least {}", least);
  return {[=](std::string& text) {
            // As in TOML, 10_000 means ten thousand.
            std::erase(text, '_');
            std::uint64_t number = 0;
            auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
            bool const is_read = error == std::errc{} && end == text.data() + text.size();
            if (!is_read || number < least || number > most) {
              return fmt::format("must be a whole number, {}, but is {}", range, text);
            }
            // CLI11 would read "010" as an octal number.
            text = fmt::format("{}", number);
            return std::string();
          },
          range};
}

CLI::Validator not_empty() {
  return {[](std::string const& text) { return text.empty() ? std::string("must not be empty") : std::string(); }, ""};
}

CLI::Validator one_of(std::vector<std::string> const& words) {
  return {[=](std::string const& text) {
            if (std::ranges::find(words, text) != words.end()) return std::string();
            return fmt::format("must be one of {}, but is {}", fmt::join(words, ", "), text);
          },
          fmt::format("{{{}}}", fmt::join(words, ","))};
}

void ConfigurationOptions::add_to(CLI::App& verb) {
  verb.add_option("FILE", file, "Configuration, TOML")->required();
  // Each --set takes one value, so that a following word is not read as another assignment.
  verb.add_option("--set", assignments, "Set a value over the file's, as disks.packing_fraction=0.7")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

gridlock::SettingsFile ConfigurationOptions::read() const {
  auto settings = gridlock::SettingsFile::from_path(file);
  for (std::string const& assignment : assignments) settings.set(assignment);
  return settings;
}

void OutputOptions::add_to(CLI::App& verb, std::string const& default_directory) {
  verb.add_option("-o,--output", directory, "Directory for the results; left out: " + default_directory)
      ->type_name("DIR");
  verb.add_flag("--overwrite", overwrites, "Replace existing results");
}

std::filesystem::path OutputOptions::directory_for(std::string const& stem) const {
  return directory.empty() ? std::filesystem::path("results") / stem : std::filesystem::path(directory);
}

}  // namespace gridlock::cli
