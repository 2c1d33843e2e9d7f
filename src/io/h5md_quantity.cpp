#include "io/h5md_quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace gridlock::h5md {

using hdf5::Handle;
using hdf5::NumberKind;

std::vector<double> clock_of(Handle const& file, std::string const& element, char const* name, std::size_t count) {
  auto const dataset = hdf5::find_dataset(file, element + "/" + name);
  if (!dataset) return {};
  std::vector<hsize_t> const extent = hdf5::extent_of(*dataset);
  if (extent.size() == 1) return hdf5::read_as<double>(*dataset, {{0}, {std::min<hsize_t>(extent[0], count)}});
  if (!extent.empty()) throw hdf5::Failure(fmt::format("{}/{} is not stored as it should be", element, name));
  double const every = hdf5::read_as<double>(*dataset, {{}, {}}).front();
  std::vector<double> const offset = hdf5::read_numbers(*dataset, "offset");
  std::vector<double> found(count);
  for (std::size_t k = 0; k < count; ++k)
    found[k] = (offset.empty() ? 0.0 : offset.front()) + every * static_cast<double>(k);
  return found;
}

FrameValues values_of(Handle const& file, Quantity const& quantity, Place const& place) {
  Handle const dataset = hdf5::open_dataset(file, quantity.path);
  hdf5::Part part;
  if (!quantity.is_fixed) part = {{place.frame}, {1}};
  part.start.push_back(0);
  part.count.push_back(place.agents);
  if (quantity.is_vector) {
    part.start.push_back(place.component);
    part.count.push_back(1);
  }
  NumberKind const kind = quantity.name == "position" ? NumberKind::real : hdf5::kind_of_numbers(dataset);
  bool const is_wide = hdf5::width_of_numbers(dataset) > sizeof(std::uint32_t);
  if (kind == NumberKind::positive_whole && is_wide) return hdf5::read_as<std::uint64_t>(dataset, part);
  if (kind == NumberKind::positive_whole) return hdf5::read_as<std::uint32_t>(dataset, part);
  if (kind != NumberKind::whole) return hdf5::read_as<double>(dataset, part);
  if (!is_wide) return hdf5::read_as<std::int32_t>(dataset, part);
  std::vector<std::int32_t> narrow;
  for (std::int64_t const value : hdf5::read_as<std::int64_t>(dataset, part)) {
    if (value != static_cast<std::int32_t>(value))
      throw hdf5::Failure(fmt::format("{} has the number {}", quantity.path, value));
    narrow.push_back(static_cast<std::int32_t>(value));
  }
  return narrow;
}

}  // namespace gridlock::h5md
