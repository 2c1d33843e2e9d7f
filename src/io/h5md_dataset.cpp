#include "io/h5md_dataset.hpp"

namespace gridlock::h5md {

void create_dataset(hdf5::Handle const& file, std::string const& path, hid_t type, Shape const& shape,
                    Filling const& filling) {
  hdf5::Handle const space(
      H5Screate_simple(static_cast<int>(shape.extent.size()), shape.extent.data(), shape.max.data()), H5Sclose,
      "describe " + path);
  hdf5::Handle const list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "describe " + path);
  hdf5::require(H5Pset_chunk(list.id(), static_cast<int>(shape.chunk.size()), shape.chunk.data()), "describe " + path);
  if (filling.fill != 0) hdf5::require(H5Pset_fill_value(list.id(), type, &filling.fill), "describe " + path);
  if (filling.compression > 0) {
    hdf5::require(H5Pset_shuffle(list.id()), "describe " + path);
    hdf5::require(H5Pset_deflate(list.id(), static_cast<unsigned>(filling.compression)), "describe " + path);
  }
  hdf5::Handle const links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "describe " + path);
  hdf5::require(H5Pset_create_intermediate_group(links.id(), 1), "describe " + path);
  hdf5::Handle const dataset(H5Dcreate2(file.id(), path.c_str(), type, space.id(), links.id(), list.id(), H5P_DEFAULT),
                             H5Dclose, "create " + path);
}

}  // namespace gridlock::h5md
