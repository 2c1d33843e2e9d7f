#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/simulation/setup.hpp"
#include "io/xyz_reader.hpp"

namespace gridlock {

/// The properties of a start file that are compared with the settings.
struct StartFileSummary {
  Box box;
  bool has_radii = false;  ///< false: radius_without_column() gives the radius of all disks
  std::uint64_t count = 0;
  RadiusRange radii;
  double covered_area = 0.0;
  bool are_radii_as_asked = true;  ///< result of AskedRadii::are_of()
};

/// Checks whether each radius is one that the settings give, to disks or to one of their species.
class AskedRadii {
 public:
  explicit AskedRadii(DisksSettings const& settings);

  [[nodiscard]] bool are_of(Disks const& disks) const;

 private:
  std::vector<double> radii_;  ///< allowed radii; empty if all are allowed
};

/// Returns the radius of disks from a file without radii; 0 if the settings give no size.
double radius_without_column(DisksSettings const& settings, Box const& box, std::uint64_t count);

/// Sets the settings that the file determines. Errors: Error if a given setting contradicts the file.
void take_summary(Configuration& configuration, StartFileSummary const& file, IsGiven const& is_given);

/// Reads all disks of a file after its header into this process, and sets the settings that the file determines.
/// Errors: Error.
State read_whole_start(xyz::Reader& reader, Configuration& configuration, IsGiven const& is_given);

/// Returns a note on a tilt that leans farther than the box which was made of it: beyond half a width.
std::optional<Event> flipped_tilt(double given, Box const& box, std::string key);

/// Returns notes on a start file: on missing columns and unused data.
std::vector<Event> notes_of_start(xyz::Reader const& reader, VelocitySettings const& velocities);

}  // namespace gridlock
