#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gridlock::xyz {

/// Columns of a frame that are stored side by side under one property name of extended XYZ.
struct PropertyName {
  std::string name;
  std::vector<std::string> columns;
  bool pads = false;  ///< whether a third component, 0, follows
};

/// The names that other programs know for our columns; all other columns keep their own.
///
/// OVITO reads "velo" and "radius", ASE "masses" and "momenta". Both would take columns of whole numbers called
/// "species" or "type" for the names of kinds.
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

/// The name of the column that a property with one component holds.
inline std::string column_name(std::string_view property) {
  for (PropertyName const& known : known_names()) {
    if (known.name == property && known.columns.size() == 1) return known.columns.front();
  }
  return std::string(property);
}

}  // namespace gridlock::xyz
