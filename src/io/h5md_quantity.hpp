#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gridlock/core/frame.hpp"
#include "io/hdf5.hpp"

// Elements of H5MD as other programs store them: values of each frame or of all frames, with steps and times.

namespace gridlock::h5md {

/// A quantity of each agent, with values for every frame or fixed values for all frames.
struct Quantity {
  std::string name;
  std::string path;  ///< path of the dataset
  bool is_fixed;     ///< whether the values are the same in all frames
  bool is_vector;    ///< with as many components as positions
};

/// Selects one component of a quantity, for all agents in one frame.
struct Place {
  std::size_t frame = 0;
  std::size_t component = 0;
  std::size_t agents = 0;
};

/// Returns the steps or times of an element for each frame; a file may store only their increment and offset. Returns
/// nothing if the file has none.
std::vector<double> clock_of(hdf5::Handle const& file, std::string const& element, char const* name, std::size_t count);

/// Returns one component as the values of a column; positions become real numbers if the file has integers.
FrameValues values_of(hdf5::Handle const& file, Quantity const& quantity, Place const& place);

}  // namespace gridlock::h5md
