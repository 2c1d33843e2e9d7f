#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gridlock::xyz {

/// A property of extended XYZ and the columns of a frame that are its components.
struct PropertyName {
  std::string name;
  std::vector<std::string> columns;
  bool pads = false;  ///< whether a third component 0 is added
};

/// Returns the names that other programs use for Gridlock's columns; other columns keep their names.
///
/// OVITO reads "velo" and "radius", ASE "masses" and "momenta". Both would read whole numbers named "species" or "type"
/// as names of kinds.
inline std::vector<PropertyName> const& known_names() {
  static std::vector<PropertyName> const names{{"velo", {"velocity_x", "velocity_y"}, true},
                                               {"radius", {"radius"}, false},
                                               {"masses", {"mass"}, false},
                                               {"image", {"image_x", "image_y"}, false},
                                               {"momenta", {"momentum_x", "momentum_y"}, true},
                                               {"species_number", {"species"}, false},
                                               {"type_number", {"type"}, false}};
  return names;
}

/// Returns the name of the column for a property with one component.
inline std::string column_name(std::string_view property) {
  for (PropertyName const& known : known_names()) {
    if (known.name == property && known.columns.size() == 1) return known.columns.front();
  }
  return std::string(property);
}

}  // namespace gridlock::xyz
