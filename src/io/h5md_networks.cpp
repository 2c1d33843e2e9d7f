#include "io/h5md_networks.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/h5md_dataset.hpp"
#include "io/h5md_fields.hpp"
#include "io/h5md_layout.hpp"
#include "io/h5md_source.hpp"
#include "io/network_file.hpp"

namespace gridlock::h5md {

namespace {

constexpr char const* networks = "/connectivity/networks";
constexpr char const* directed = "directed";
constexpr hsize_t ends = 2;

/// Makes room for the edges of frame `frame`; returns for how many the file then has room.
hsize_t extend(hdf5::Handle const& values, hdf5::Handle const& weights, std::size_t frame, std::size_t edges) {
  std::vector<hsize_t> const present = hdf5::extent_of(values);
  if (present.size() != 3) throw hdf5::Failure("a network is not stored as it should be");
  hsize_t const room = std::max<hsize_t>(present[1], edges);
  std::array<hsize_t, 3> const extent{frame + 1, room, ends};
  hdf5::require(H5Dset_extent(values.id(), extent.data()), "extend a network");
  hdf5::require(H5Dset_extent(weights.id(), extent.data()), "extend a network");
  return room;
}

Network read_network(hdf5::Handle const& file, std::string const& name, std::size_t frame, std::uint64_t bytes) {
  std::string const path = path_of_network(name);
  hdf5::Handle const values = hdf5::open_dataset(file, path + "/value");
  std::vector<hsize_t> const extent = hdf5::extent_of(values);
  if (extent.size() != 3 || extent[2] != ends) {
    throw hdf5::Failure("the network " + name + " is not stored as it should be");
  }
  if (extent[1] / max_deflation > bytes) throw hdf5::Failure("the number of edges of " + name + " is damaged");
  std::vector<double> const direction = hdf5::read_numbers(hdf5::open_group(file, path), directed);
  Network network(name, direction.size() == 1 && direction[0] != 0.0);
  if (extent[1] == 0) return network;
  auto const ids = hdf5::read<std::uint64_t>(values, {{frame, 0, 0}, {1, extent[1], ends}});
  auto const weights = hdf5::read<double>(hdf5::open_dataset(file, path + "/weight"), {{frame, 0}, {1, extent[1]}});
  std::vector<NetworkEdge> edges;
  for (std::size_t k = 0; k < weights.size() && ids[2 * k] != absent_id; ++k) {
    edges.push_back({ids[2 * k], ids[2 * k + 1], weights[k]});
  }
  try {
    network.connect(std::move(edges));
  } catch (Error const& error) {
    throw hdf5::Failure(error.problems().front().what);
  }
  return network;
}

}  // namespace

std::string path_of_network(std::string const& name) { return std::string(networks) + "/" + name; }

void create_network(hdf5::Handle const& file, Network const& network, std::string const& agents, int compression) {
  std::string const path = path_of_network(network.name());
  hsize_t const chunk = std::clamp<hsize_t>(network.size(), 64, max_rows_per_chunk);
  create_dataset(file, path + "/value", hdf5::native<std::uint64_t>(),
                 {{0, 0, ends}, {H5S_UNLIMITED, H5S_UNLIMITED, ends}, {1, chunk, ends}},
                 {.compression = compression, .fill = absent_id});
  create_dataset(file, path + "/weight", hdf5::native<double>(), {{0, 0}, {H5S_UNLIMITED, H5S_UNLIMITED}, {1, chunk}},
                 {.compression = compression});
  hdf5::Handle const group = hdf5::open_group(file, path);
  int const is_directed = network.is_directed() ? 1 : 0;
  hdf5::set_attribute(group, directed, std::span(&is_directed, 1));
  if (!agents.empty()) hdf5::set_reference(group, "particles_group", file, agents);
}

void put_network(hdf5::Handle const& file, Network const& network, std::size_t frame) {
  std::string const path = path_of_network(network.name());
  hdf5::Handle const values = hdf5::open_dataset(file, path + "/value");
  hdf5::Handle const weights = hdf5::open_dataset(file, path + "/weight");
  hsize_t const room = extend(values, weights, frame, network.size());
  if (room == 0) return;
  // All entries are written, since those of a frame that was cut short may have other values than the absent ones.
  std::vector<std::uint64_t> ids(ends * room, absent_id);
  std::vector<double> numbers(room);
  for (std::size_t k = 0; k < network.size(); ++k) {
    NetworkEdge const& edge = network.edges()[k];
    ids[2 * k] = edge.from;
    ids[2 * k + 1] = edge.to;
    numbers[k] = edge.weight;
  }
  hdf5::write(values, {{frame, 0, 0}, {1, room, ends}}, std::span<std::uint64_t const>(ids));
  hdf5::write(weights, {{frame, 0}, {1, room}}, std::span<double const>(numbers));
}

std::vector<Network> read_networks(hdf5::Handle const& file, std::size_t frame, std::uint64_t bytes) {
  std::vector<Network> found;
  if (!hdf5::has(file, "/connectivity") || !hdf5::has(file, networks)) return found;
  for (std::string const& name : hdf5::names_in(hdf5::open_group(file, networks))) {
    found.push_back(read_network(file, name, frame, bytes));
  }
  return found;
}

void create_beside(hdf5::Handle const& file, FrameSource const& frame, std::string const& agents, int compression) {
  auto const link_clock = [&](std::string const& path) {
    hdf5::link(file, agents + "/id/step", path + "/step");
    hdf5::link(file, agents + "/id/time", path + "/time");
  };
  for (Field const& field : frame.fields()) {
    create_field(file, field, compression);
    link_clock(path_of_field(field.name()));
  }
  for (Network const& network : frame.networks()) {
    create_network(file, network, agents, compression);
    link_clock(path_of_network(network.name()));
  }
}

void put_beside(hdf5::Handle const& file, FrameSource const& frame, std::size_t k) {
  for (Field const& field : frame.fields()) put_field(file, field, k);
  for (Network const& network : frame.networks()) put_network(file, network, k);
}

std::size_t max_bytes_beside(FrameSource const& frame) {
  constexpr std::size_t room_for_indices = 65536;
  std::size_t bytes = 0;
  for (Field const& field : frame.fields()) bytes += field.values().size_bytes() + room_for_indices;
  for (Network const& network : frame.networks()) {
    bytes += (network.size() + max_rows_per_chunk) * sizeof(NetworkEdge) + room_for_indices;
  }
  return bytes + bytes / 100;
}

}  // namespace gridlock::h5md

namespace gridlock {

void write_networks(std::span<Network const> networks, std::filesystem::path const& path) {
  write_hdf5(path, [&](hdf5::Handle const& file) {
    for (Network const& network : networks) {
      h5md::create_network(file, network, "", 1);
      h5md::put_network(file, network, 0);
    }
  });
}

std::vector<Network> read_networks(std::filesystem::path const& path) {
  return h5md::guarded(path, [&] {
    std::uint64_t const bytes = hdf5::size_of_file(path);
    return h5md::read_networks(hdf5::open_file(path, hdf5::Access::read), 0, bytes);
  });
}

}  // namespace gridlock
