#include "io/h5md_fields.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "gridlock/core/error.hpp"
#include "io/field_file.hpp"
#include "io/h5md_dataset.hpp"
#include "io/h5md_layout.hpp"
#include "io/h5md_source.hpp"

namespace gridlock::h5md {

namespace {

constexpr char const* fields = "/fields";

hdf5::Handle open_values(hdf5::Handle const& file, std::string const& name) {
  return hdf5::open_dataset(file, path_of_field(name) + "/value");
}

}  // namespace

std::string path_of_field(std::string const& name) { return std::string(fields) + "/" + name; }

void create_field(hdf5::Handle const& file, Field const& field, int compression) {
  hsize_t const rows = field.rows();
  hsize_t const columns = field.columns();
  hsize_t const wide = std::min<hsize_t>(columns, max_rows_per_chunk);
  hsize_t const high = std::clamp<hsize_t>(max_rows_per_chunk / wide, 1, rows);
  create_dataset(file, path_of_field(field.name()) + "/value", hdf5::native<double>(),
                 {{0, rows, columns}, {H5S_UNLIMITED, rows, columns}, {1, high, wide}}, {.compression = compression});
}

void put_field(hdf5::Handle const& file, Field const& field, std::size_t frame) {
  hdf5::Handle const values = open_values(file, field.name());
  std::array<hsize_t, 3> const extent{frame + 1, field.rows(), field.columns()};
  std::vector<hsize_t> const present = hdf5::extent_of(values);
  if (!std::ranges::equal(std::span(present).subspan(1), std::span(extent).subspan(1))) {
    throw hdf5::Failure("the field " + field.name() + " has another number of cells there");
  }
  hdf5::require(H5Dset_extent(values.id(), extent.data()), "extend " + field.name());
  hdf5::write(values, {{frame, 0, 0}, {1, extent[1], extent[2]}}, field.values());
}

std::vector<Field> read_fields(hdf5::Handle const& file, std::size_t frame, std::uint64_t bytes) {
  std::vector<Field> found;
  if (!hdf5::has(file, fields)) return found;
  for (std::string& name : hdf5::names_in(hdf5::open_group(file, fields))) {
    hdf5::Handle const values = open_values(file, name);
    std::vector<hsize_t> const extent = hdf5::extent_of(values);
    if (extent.size() != 3) throw hdf5::Failure("the field " + name + " is not stored as it should be");
    if (extent[1] / max_deflation > bytes || extent[2] / max_deflation > bytes ||
        extent[1] * extent[2] / max_deflation > bytes) {
      throw hdf5::Failure("the number of cells of the field " + name + " is damaged");
    }
    auto const numbers = hdf5::read<double>(values, {{frame, 0, 0}, {1, extent[1], extent[2]}});
    found.emplace_back(std::move(name), extent[2], extent[1]);
    std::ranges::copy(numbers, found.back().values().begin());
  }
  return found;
}

}  // namespace gridlock::h5md

namespace gridlock {

void write_hdf5(std::filesystem::path const& path, std::function<void(hdf5::Handle const&)> const& fill) {
  try {
    std::filesystem::path temporary = path;
    temporary += ".part";
    hdf5::Handle file = hdf5::create_file(temporary);
    fill(file);
    file.close("write the file");
    std::filesystem::rename(temporary, path);
  } catch (hdf5::Failure const& failure) {
    throw RunFailure("cannot write " + path.string() + ": " + failure.what());
  } catch (std::filesystem::filesystem_error const& failure) {
    throw RunFailure("cannot write " + path.string() + ": " + failure.code().message());
  }
}

void write_fields(std::span<Field const> fields, std::filesystem::path const& path) {
  write_hdf5(path, [&](hdf5::Handle const& file) {
    for (Field const& field : fields) {
      h5md::create_field(file, field, 1);
      h5md::put_field(file, field, 0);
    }
  });
}

std::vector<Field> read_fields(std::filesystem::path const& path) {
  auto const read = [&] {
    std::uint64_t const bytes = hdf5::size_of_file(path);
    return h5md::read_fields(hdf5::open_file(path, hdf5::Access::read), 0, bytes);
  };
  return h5md::guarded(path, read, "put back a copy of the file: a run writes its last fields to it");
}

}  // namespace gridlock
