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

/// Sorts rows by Id. Errors: Error if Ids are invalid, such as two equal ones.
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

/// Returns the columns of the file that disks do not have.
std::vector<FrameColumn> others_of(Rows const& rows, Columns const& columns) {
  std::vector<FrameColumn> others;
  for (auto const& [column, name] : columns.others) {
    std::vector<double> values;
    values.reserve(rows.disks.size());
    for (Row const& row : rows.disks) {
      values.push_back(rows.others[row.number * columns.others.size() + others.size()]);
    }
    others.push_back({name, std::move(values)});
  }
  return others;
}

}  // namespace

XyzFrame read_all(Reader& reader) {
  Header const& header = reader.header();
  Columns const& columns = reader.columns();
  Rows rows;
  rows.disks.reserve(reader.likely_count());
  constexpr std::size_t piece = std::size_t{1} << 16;
  while (reader.read(piece, rows)) {
  }
  sort_by_id(rows, reader);
  XyzFrame frame{
      .state = {.box = reader.box(), .agents = {}, .clock = clock_of(header), .seed = header.seed.value_or(0)},
      .has_velocities = columns.has_velocities(),
      .has_radii = columns.has_radii(),
      .has_masses = columns.has(Role::mass),
      .has_images = columns.has(Role::image_x) || reader.folded() > 0,
      .given_tilt = reader.given_tilt(),
      .unused_columns = reader.unused(),
      .unused_entries = header.unused_entries};
  Disks& disks = frame.state.agents;
  disks.reserve(rows.disks.size());
  for (Row const& row : rows.disks) {
    bool const is_new = disks.add_as(row.id, row.position.x, row.position.y, row.velocity.x, row.velocity.y, row.radius,
                                     row.mass, row.image_x, row.image_y);
    assert(is_new);
    static_cast<void>(is_new);
  }
  frame.others = others_of(rows, columns);
  return frame;
}

}  // namespace xyz

XyzFrame parse_xyz(std::string_view text, std::string const& name) {
  xyz::Reader reader(TextReader(text, name));
  return xyz::read_all(reader);
}

XyzFrame read_xyz(std::filesystem::path const& path, std::optional<std::int64_t> frame, std::string const& setting) {
  xyz::Reader reader(TextReader(path), {.frame = frame, .setting = setting});
  return xyz::read_all(reader);
}

bool has_xyz_ending(std::filesystem::path const& path) {
  std::filesystem::path const name = path.extension() == ".gz" ? path.stem() : path.filename();
  std::filesystem::path const ending = name.extension();
  return ending == ".xyz" || ending == ".extxyz" || ending == ".exyz";
}

std::uint64_t count_xyz_frames(std::filesystem::path const& path) {
  xyz::Lines lines{TextReader(path)};
  return xyz::count_frames(lines);
}

}  // namespace gridlock
