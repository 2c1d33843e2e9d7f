#include "gridlock/io/xyz.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>
#include <vector>

#include "io/xyz_reader.hpp"

namespace gridlock {

namespace xyz {

namespace {

/// Puts rows in the order of their Ids. Errors: Error where two have one.
void sort_by_id(Rows& rows, Reader& reader) {
  std::vector<Row>& disks = rows.disks;
  if (disks.empty()) return;
  auto const descends = [](Row const& one, Row const& next) { return one.id >= next.id; };
  bool const ascends = std::ranges::adjacent_find(disks, descends) == disks.end();
  if (ascends && are_plain(disks.front().id, disks.back().id, reader.count())) return;
  std::vector<IdOfRow> ids;
  ids.reserve(disks.size());
  for (Row const& row : disks) ids.push_back({row.id, row.number});
  if (auto const wrong = find_wrong_id(ids, reader.count())) reader.refuse(*wrong);
  std::ranges::sort(disks, {}, &Row::id);
}

/// The columns that disks do not have.
std::vector<FrameColumn> others_of(Rows const& rows, Header const& header) {
  std::vector<FrameColumn> others;
  for (auto const& [column, name] : header.others) {
    std::vector<double> values;
    values.reserve(rows.disks.size());
    for (Row const& row : rows.disks) {
      values.push_back(rows.others[row.number * header.others.size() + others.size()]);
    }
    others.push_back({name, std::move(values)});
  }
  return others;
}

}  // namespace

XyzFrame read_all(Reader& reader) {
  Header const& header = reader.header();
  Rows rows;
  rows.disks.reserve(reader.likely_count());
  constexpr std::size_t piece = std::size_t{1} << 16;
  while (reader.read(piece, rows)) {
  }
  sort_by_id(rows, reader);
  XyzFrame frame{.state = {.box = header.box, .agents = {}, .clock = header.clock, .seed = header.seed},
                 .has_velocities = header.has(Role::velocity_x),
                 .has_radii = header.has(Role::radius),
                 .has_masses = header.has(Role::mass),
                 .has_images = header.has(Role::image_x)};
  Disks& disks = frame.state.agents;
  disks.reserve(rows.disks.size());
  for (Row const& row : rows.disks) {
    bool const is_new = disks.add_as(row.id, row.position.x, row.position.y, row.velocity.x, row.velocity.y, row.radius,
                                     row.mass, row.image_x, row.image_y);
    assert(is_new);
    static_cast<void>(is_new);
  }
  frame.others = others_of(rows, header);
  return frame;
}

}  // namespace xyz

XyzFrame parse_xyz(std::string_view text, std::string const& name) {
  xyz::Reader reader(TextReader(text, name));
  return xyz::read_all(reader);
}

XyzFrame read_xyz(std::filesystem::path const& path) {
  xyz::Reader reader{TextReader(path)};
  return xyz::read_all(reader);
}

}  // namespace gridlock
