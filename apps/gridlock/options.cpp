#include <utility>

#include "verbs.hpp"

namespace gridlock::cli {

namespace {
std::string name_of_program = "gridlock";
}

std::string const& program_name() { return name_of_program; }

void set_program_name(std::string name) { name_of_program = std::move(name); }

void ConfigurationOptions::add_to(CLI::App& verb) {
  verb.add_option("FILE", file, "Configuration, TOML")->required();
  // One value an option, so that what follows is never taken for another assignment.
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
  verb.add_flag("--overwrite", overwrites, "Replace results that are there already");
}

std::filesystem::path OutputOptions::directory_for(std::string const& stem) const {
  return directory.empty() ? std::filesystem::path("results") / stem : std::filesystem::path(directory);
}

}  // namespace gridlock::cli
