#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/hdf5.hpp"

namespace gridlock::h5md {

/// The shape of a new dataset; its first dimension is the frames, 0 at first.
struct Shape {
  std::vector<hsize_t> extent;
  std::vector<hsize_t> max;
  std::vector<hsize_t> chunk;
};

struct Filling {
  int compression = 0;
  std::uint64_t fill = 0;
};

/// Creates a dataset, and the groups around it that do not exist. Errors: hdf5::Failure.
void create_dataset(hdf5::Handle const& file, std::string const& path, hid_t type, Shape const& shape,
                    Filling const& filling = {});

}  // namespace gridlock::h5md
