#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/simulation/setup.hpp"
#include "io/xyz_reader.hpp"

namespace gridlock {

/// The facts about a file that disks start from with which the settings are compared.
struct StartFileSummary {
  Box box;
  bool has_radii = false;  ///< otherwise the disks have the size asked for, see radius_without_column()
  std::uint64_t count = 0;
  RadiusRange radii;
  double covered_area = 0.0;
  bool are_radii_as_asked = true;  ///< see AskedRadii
};

/// Whether disks have a radius that the settings ask for, as one of the kinds asked for.
class AskedRadii {
 public:
  explicit AskedRadii(DisksSettings const& settings);

  [[nodiscard]] bool are_of(Disks const& disks) const;

 private:
  std::vector<double> radii_;  ///< none where any will do
};

/// The radius of disks whose file has none; 0 where the settings give no size.
double radius_without_column(DisksSettings const& settings, Box const& box, std::uint64_t count);

/// Fills in what the file decides. Errors: Error where a setting contradicts it.
void take_summary(Configuration& configuration, StartFileSummary const& file, IsGiven const& is_given);

/// The disks of a file of which the head has been read, all in this process; the configuration learns what the file
/// decides. Errors: Error.
State read_whole_start(xyz::Reader& reader, Configuration& configuration, IsGiven const& is_given);

/// Notes on a file that has been read: what it lacks, and what is not used.
std::vector<Event> notes_of_start(xyz::Reader const& reader, VelocitySettings const& velocities);

}  // namespace gridlock
