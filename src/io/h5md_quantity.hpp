#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gridlock/core/frame.hpp"
#include "io/hdf5.hpp"

// How other programs store what H5MD calls an element: values of each frame or of all, with their steps and times.

namespace gridlock::h5md {

/// A quantity of each agent: numbers of every frame, or one for all.
struct Quantity {
  std::string name;
  std::string path;  ///< of the dataset
  bool is_fixed;     ///< in time
  bool is_vector;    ///< of the dimensions of the positions
};

/// Numbers of a quantity: one component, of all agents in one frame.
struct Place {
  std::size_t frame = 0;
  std::size_t component = 0;
  std::size_t agents = 0;
};

/// Steps or times of an element: one for each frame, or the distance between them and where they begin. Empty where the
/// file has none.
std::vector<double> clock_of(hdf5::Handle const& file, std::string const& element, char const* name, std::size_t count);

/// Numbers of a component as a column of a frame has them; positions are real in any case.
FrameValues values_of(hdf5::Handle const& file, Quantity const& quantity, Place const& place);

}  // namespace gridlock::h5md
