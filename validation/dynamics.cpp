// Brownian disks, swimmers, cooling grains, falling disks, channels, cages and viscosities in the engine `exact`, and
// soft disks that are sheared, that flow and that move, from runs that are too long for the tests.
//
//     gridlock_validate_dynamics [SECTION] …      all if none is named
//
// Units: σ = m = kT = 1; of soft disks σ = m = ε = 1. Each number is the mean of runs with different seeds, with one
// standard error. It is compared with an exact number, or with the number and the error of an independent program
// that shares no code with Gridlock: within four errors of the difference, or within a tolerance. The program
// returns 1 if one number differs. The bits of the runs do not depend on the number of threads, nor does the table.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>
#include <vector>

#include "dynamics/sections.hpp"

int main(int argument_count, char** arguments) {
  using namespace gridlock::validation;
  struct Section {
    std::string_view name;
    void (*print)();
  };
  constexpr std::array sections{
      Section{"diffusion", diffusion}, Section{"swimmers", swimmers}, Section{"cooling", cooling},
      Section{"falling", falling},     Section{"channels", channels}, Section{"shear", shear},
      Section{"flow", flow},           Section{"soft", soft},         Section{"viscosity", viscosity}};
  std::vector<std::string_view> const names(arguments + 1, arguments + argument_count);
  for (std::string_view const name : names) {
    if (std::ranges::find(sections, name, &Section::name) == sections.end()) {
      fmt::print(stderr, "there is no section {}; there are", name);
      for (Section const& section : sections) fmt::print(stderr, " {}", section.name);
      fmt::print(stderr, "\n");
      return 2;
    }
  }
  fmt::print("check,measured,error,expected,expected_error,allowed_difference,difference_in_errors,verdict\n");
  for (Section const& section : sections) {
    if (names.empty() || std::ranges::find(names, section.name) != names.end()) section.print();
  }
  return all_agree() ? 0 : 1;
}
