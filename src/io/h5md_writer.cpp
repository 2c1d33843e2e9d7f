#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "core/all_cores.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "io/deflated_chunk.hpp"
#include "io/h5md_layout.hpp"
#include "io/hdf5.hpp"

namespace gridlock {

namespace {

using hdf5::Access;
using hdf5::Handle;

/// Frames below this many numbers are not worth waking other threads for.
constexpr std::size_t least_parallel_numbers = 100'000;
constexpr std::size_t room_for_indices = 65536;

hid_t native_of(FrameValues const& values) {
  return std::visit([](auto const& numbers) { return hdf5::native<std::remove_cvref_t<decltype(numbers[0])>>(); },
                    values);
}

/// The shape of a new dataset, whose first dimension is the frames, none yet.
struct Shape {
  std::vector<hsize_t> extent;
  std::vector<hsize_t> most;
  std::vector<hsize_t> chunk;
};

Shape one_for_each_frame() { return {{0}, {H5S_UNLIMITED}, {h5md::frames_per_chunk}}; }

struct Filling {
  int compression = 0;
  std::uint64_t fill = 0;
};

void create_dataset(Handle const& file, std::string const& path, hid_t type, Shape const& shape,
                    Filling const& filling = {}) {
  Handle const space(H5Screate_simple(static_cast<int>(shape.extent.size()), shape.extent.data(), shape.most.data()),
                     H5Sclose, "describe " + path);
  Handle const list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "describe " + path);
  hdf5::require(H5Pset_chunk(list.id(), static_cast<int>(shape.chunk.size()), shape.chunk.data()), "describe " + path);
  if (filling.fill != 0) hdf5::require(H5Pset_fill_value(list.id(), type, &filling.fill), "describe " + path);
  if (filling.compression > 0) {
    hdf5::require(H5Pset_shuffle(list.id()), "describe " + path);
    hdf5::require(H5Pset_deflate(list.id(), static_cast<unsigned>(filling.compression)), "describe " + path);
  }
  Handle const links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "describe " + path);
  hdf5::require(H5Pset_create_intermediate_group(links.id(), 1), "describe " + path);
  Handle const dataset(H5Dcreate2(file.id(), path.c_str(), type, space.id(), links.id(), list.id(), H5P_DEFAULT),
                       H5Dclose, "create " + path);
}

void set_unit(Handle const& file, std::string const& path, std::string const& unit) {
  // Not H5MD's attribute "unit": these are reduced units, and readers refuse a unit they cannot convert.
  if (!unit.empty()) hdf5::set_attribute(hdf5::open_dataset(file, path), "reduced_unit", unit);
}

/// Writes the head of a new trajectory: everything that is there before the first frame.
class Beginning {
 public:
  Beginning(Handle const& file, H5mdSettings const& settings, Frame const& first)
      : file_(file), settings_(settings), frame_(first), group_("/particles/" + settings.agents) {}

  void write() {
    write_origin();
    hdf5::create_group(file_, "/particles");
    hdf5::create_group(file_, group_);
    write_elements();
    write_box();
    write_observables();
    write_parameters();
    if (settings_.contacts) write_contacts(*settings_.contacts);
  }

 private:
  void write_origin() {
    Handle const root = hdf5::create_group(file_, "/h5md");
    constexpr std::array version{1, 1};
    hdf5::set_attribute(root, "version", version);
    Handle const author = hdf5::create_group(file_, "/h5md/author");
    hdf5::set_attribute(author, "name", settings_.author.empty() ? "N/A" : settings_.author);
    Handle const creator = hdf5::create_group(file_, "/h5md/creator");
    hdf5::set_attribute(creator, "name", "gridlock");
    hdf5::set_attribute(creator, "version", settings_.version);
  }

  void write_elements() {
    std::size_t const rounded = (frame_.size() + 63) / 64 * 64;
    hsize_t const rows = std::clamp<std::size_t>(rounded, 64, h5md::most_rows_per_chunk);
    int const compression = static_cast<int>(settings_.compression);
    Shape const scalars{{0, 0}, {H5S_UNLIMITED, H5S_UNLIMITED}, {1, rows}};
    Shape const vectors{{0, 0, h5md::dimensions}, {H5S_UNLIMITED, H5S_UNLIMITED, h5md::dimensions}, {1, rows, 1}};
    hdf5::create_group(file_, group_ + "/id");
    create_dataset(file_, group_ + "/id/value", hdf5::native<std::uint64_t>(), scalars,
                   {.compression = compression, .fill = h5md::absent_id});
    create_dataset(file_, group_ + "/id/step", hdf5::native<std::uint64_t>(), one_for_each_frame());
    create_dataset(file_, group_ + "/id/time", hdf5::native<double>(), one_for_each_frame());
    set_unit(file_, group_ + "/id/time", "time");
    for (h5md::Element const& element : h5md::elements_of(frame_)) {
      std::string const path = group_ + "/" + element.name;
      hdf5::create_group(file_, path);
      create_dataset(file_, path + "/value", native_of(frame_.columns[element.columns[0]].values),
                     element.is_vector() ? vectors : scalars, {.compression = compression});
      set_unit(file_, path + "/value", element.unit);
      link_clock(path);
    }
  }

  void write_box() {
    Handle const box = hdf5::create_group(file_, group_ + "/box");
    constexpr int dimension = h5md::dimensions;
    hdf5::set_attribute(box, "dimension", std::span(&dimension, 1));
    std::string const edge = frame_.box.is_periodic() ? "periodic" : "none";
    hdf5::set_attribute(box, "boundary", std::vector<std::string>{edge, edge, "none"});
    hdf5::create_group(file_, group_ + "/box/edges");
    constexpr hsize_t d = h5md::dimensions;
    create_dataset(file_, group_ + "/box/edges/value", hdf5::native<double>(),
                   {{0, d, d}, {H5S_UNLIMITED, d, d}, {h5md::frames_per_chunk, d, d}});
    set_unit(file_, group_ + "/box/edges/value", "length");
    link_clock(group_ + "/box/edges");
  }

  void write_observables() {
    hdf5::create_group(file_, "/observables");
    for (auto const& [name, unit] : settings_.observables) {
      std::string const path = "/observables/" + name;
      hdf5::create_group(file_, path);
      create_dataset(file_, path + "/value", hdf5::native<double>(), one_for_each_frame());
      set_unit(file_, path + "/value", unit);
      link_clock(path);
    }
  }

  void write_parameters() {
    hdf5::create_group(file_, "/parameters");
    hdf5::write_text(file_, "/parameters/configuration", settings_.configuration);
    hdf5::write_text(file_, "/parameters/version", settings_.version);
    write_one("/parameters/seed", frame_.seed);
    hdf5::create_group(file_, "/parameters/frames");
    for (char const* name : {"state_hash", "checksum"}) {
      create_dataset(file_, std::string("/parameters/frames/") + name, hdf5::native<std::uint64_t>(),
                     one_for_each_frame());
    }
    link_clock("/parameters/frames");
  }

  /// In the form of H5MD that depends on time: disks that move afterwards have other contacts.
  void write_contacts(FrameContacts const& contacts) {
    hsize_t const count = contacts.size();
    hsize_t const chunk = std::clamp<hsize_t>(count, 1, h5md::most_rows_per_chunk);
    int const compression = static_cast<int>(settings_.compression);
    hdf5::create_group(file_, "/connectivity");
    Handle const group = hdf5::create_group(file_, "/connectivity/contacts");
    hdf5::set_reference(group, "particles_group", file_, group_);
    std::string const path = "/connectivity/contacts/";
    create_dataset(file_, path + "value", hdf5::native<std::uint64_t>(),
                   {{1, count, 2}, {H5S_UNLIMITED, H5S_UNLIMITED, 2}, {1, chunk, 2}}, {.compression = compression});
    create_dataset(file_, path + "force", hdf5::native<double>(),
                   {{1, count}, {H5S_UNLIMITED, H5S_UNLIMITED}, {1, chunk}}, {.compression = compression});
    set_unit(file_, path + "force", "energy/length");
    if (count > 0) {
      hdf5::write(hdf5::open_dataset(file_, path + "value"), {{0, 0, 0}, {1, count, 2}},
                  std::span<std::uint64_t const>(contacts.ids));
      hdf5::write(hdf5::open_dataset(file_, path + "force"), {{0, 0}, {1, count}},
                  std::span<double const>(contacts.forces));
    }
    write_one(path + "step", contacts.clock.step);
    write_one(path + "time", contacts.clock.time);
    set_unit(file_, path + "time", "time");
    write_one("/parameters/checksum_of_contacts", h5md::checksum(contacts));
  }

  template <class Number>
  void write_one(std::string const& path, Number number) {
    create_dataset(file_, path, hdf5::native<Number>(), {{1}, {1}, {1}});
    hdf5::write(hdf5::open_dataset(file_, path), {{0}, {1}}, std::span<Number const>(&number, 1));
  }

  void link_clock(std::string const& path) {
    hdf5::link(file_, group_ + "/id/step", path + "/step");
    hdf5::link(file_, group_ + "/id/time", path + "/time");
  }

  Handle const& file_;
  H5mdSettings const& settings_;
  Frame const& frame_;
  std::string group_;
};

/// A chunk ready to go into the file.
struct Chunk {
  std::string dataset;
  ChunkSource source;
  std::vector<hsize_t> offset;  ///< frame, row and component of its first number
  std::vector<std::byte> bytes;
};

}  // namespace

class H5mdWriter::Trajectory {
 public:
  Trajectory(std::filesystem::path path, Frame const& first)
      : path_(std::move(path)), elements_(h5md::elements_of(first)) {
    for (FrameColumn const& column : first.columns) columns_.emplace_back(column.name, column.values.index());
  }

  void create(H5mdSettings const& settings, Frame const& first);
  void append();
  void write(H5mdFrame const& frame);

  [[nodiscard]] std::filesystem::path const& path() const { return path_; }
  [[nodiscard]] std::vector<std::uint64_t> const& steps() const { return steps_; }
  [[nodiscard]] std::vector<std::uint64_t> const& state_hashes() const { return state_hashes_; }

 private:
  void require_whole() const;
  void look_into(Handle const& file);
  void require_columns(Frame const& frame) const;
  void add_chunks(std::string const& dataset, FrameValues const& values, std::optional<hsize_t> component);
  void gather_chunks(Frame const& frame);
  void deflate_chunks();
  [[nodiscard]] std::size_t most_bytes_of_frame() const;
  void put_values(Handle const& file, H5mdFrame const& frame);
  void put_chunks(Handle const& file, std::size_t agents);
  template <class Number>
  void put(Handle const& file, std::string const& path, Number value) const;
  [[nodiscard]] std::size_t frame_count() const { return steps_.size(); }

  std::filesystem::path path_;
  std::vector<h5md::Element> elements_;
  std::vector<std::pair<std::string, std::size_t>> columns_;  ///< name and type of each
  std::string group_;
  std::vector<std::string> observables_;
  std::size_t rows_per_chunk_ = 0;
  int compression_ = 0;
  bool is_edge_periodic_ = false;
  std::vector<std::uint64_t> steps_;
  std::vector<std::uint64_t> state_hashes_;
  std::vector<Chunk> chunks_;
};

void H5mdWriter::Trajectory::create(H5mdSettings const& settings, Frame const& first) {
  std::filesystem::path temporary = path_;
  temporary += ".part";
  {
    Handle file = hdf5::create_file(temporary);
    Beginning(file, settings, first).write();
    file.close("write the file");
  }
  std::filesystem::rename(temporary, path_);
  look_into(hdf5::open_file(path_, Access::read));
}

/// The last frame lies behind all the others: where it is whole, nothing is cut off.
void H5mdWriter::Trajectory::require_whole() const {
  H5mdReader const reader(path_);
  if (reader.frame_count() > 0) static_cast<void>(reader.frame(reader.frame_count() - 1));
}

void H5mdWriter::Trajectory::append() {
  // Both only read: HDF5 writes into a file as soon as it opens it for writing, and makes a short one longer.
  require_whole();
  look_into(hdf5::open_file(path_, Access::read));
  try {
    hdf5::open_file(path_, Access::append);
  } catch (hdf5::Failure const&) {
    // Its writer was killed.
    hdf5::repair_file(path_);
    hdf5::open_file(path_, Access::append);
  }
}

void H5mdWriter::Trajectory::look_into(Handle const& file) {
  Handle const particles = hdf5::open_group(file, "/particles");
  std::vector<std::string> const groups = hdf5::names_in(particles);
  if (groups.size() != 1) throw hdf5::Failure("the file holds other agents");
  group_ = "/particles/" + groups[0];
  observables_ = hdf5::names_in(hdf5::open_group(file, "/observables"));
  Handle const ids = hdf5::open_dataset(file, group_ + "/id/value");
  Handle const list(H5Dget_create_plist(ids.id()), H5Pclose, "look at the ids");
  std::array<hsize_t, 2> chunk{};
  if (H5Pget_chunk(list.id(), 2, chunk.data()) != 2) throw hdf5::Failure("the ids are not stored as they should be");
  rows_per_chunk_ = chunk[1];
  if (rows_per_chunk_ == 0 || rows_per_chunk_ > h5md::most_rows_per_chunk) {
    throw hdf5::Failure("the ids are not stored as they should be");
  }
  unsigned level = 0;
  std::size_t parameters = 1;
  bool const is_deflated =
      H5Pget_filter_by_id2(list.id(), H5Z_FILTER_DEFLATE, nullptr, &parameters, &level, 0, nullptr, nullptr) >= 0;
  compression_ = is_deflated ? static_cast<int>(level) : 0;
  is_edge_periodic_ = hdf5::read_texts(hdf5::open_group(file, group_ + "/box"), "boundary")[0] == "periodic";
  for (h5md::Element const& element : elements_) {
    if (!hdf5::has(file, group_ + "/" + element.name)) throw hdf5::Failure("the file holds no " + element.name);
  }
  Handle const steps = hdf5::open_dataset(file, group_ + "/id/step");
  std::vector<hsize_t> const frames = hdf5::extent_of(steps);
  if (frames.size() != 1) throw hdf5::Failure("the steps are not stored as they should be");
  steps_ = hdf5::read<std::uint64_t>(steps, {{0}, frames});
  state_hashes_ = hdf5::read<std::uint64_t>(hdf5::open_dataset(file, "/parameters/frames/state_hash"), {{0}, frames});
}

void H5mdWriter::Trajectory::require_columns(Frame const& frame) const {
  bool const is_same = std::ranges::equal(frame.columns, columns_, {}, [](FrameColumn const& column) {
    return std::pair(column.name, column.values.index());
  });
  if (!is_same || frame.box.is_periodic() != is_edge_periodic_) {
    throw RunFailure(fmt::format("{}: a frame has other columns or edges than the first one", path_.string()));
  }
}

void H5mdWriter::Trajectory::add_chunks(std::string const& dataset, FrameValues const& values,
                                        std::optional<hsize_t> component) {
  std::span<std::byte const> const bytes = h5md::bytes_of(values);
  std::size_t const width = h5md::width_of(values);
  std::size_t const size = rows_per_chunk_ * width;
  std::size_t at = 0;
  do {  // also for no agents: the dataset gets longer all the same
    std::vector<hsize_t> offset{frame_count(), at / width};
    if (component) offset.push_back(*component);
    chunks_.push_back({.dataset = dataset,
                       .source = {.bytes = bytes.subspan(at, std::min(size, bytes.size() - at)),
                                  .width = width,
                                  .capacity = rows_per_chunk_},
                       .offset = std::move(offset),
                       .bytes = {}});
    at += size;
  } while (at < bytes.size());
}

void H5mdWriter::Trajectory::gather_chunks(Frame const& frame) {
  chunks_.clear();
  for (h5md::Element const& element : elements_) {
    std::string const dataset = group_ + "/" + element.name + "/value";
    for (std::size_t c = 0; c < element.columns.size(); ++c) {
      add_chunks(dataset, frame.columns[element.columns[c]].values,
                 element.is_vector() ? std::optional<hsize_t>(c) : std::nullopt);
    }
  }
}

void H5mdWriter::Trajectory::deflate_chunks() {
  auto const deflate = [&](std::size_t k) { chunks_[k].bytes = deflated_chunk(chunks_[k].source, compression_); };
  std::size_t const numbers = chunks_.size() * rows_per_chunk_;
  if (numbers < least_parallel_numbers) {
    for (std::size_t k = 0; k < chunks_.size(); ++k) deflate(k);
  } else {
    on_all_cores([&] { tbb::parallel_for(std::size_t{0}, chunks_.size(), deflate); });
  }
}

/// Numbers that cannot be deflated grow by less than a hundredth; the indices of the chunks need the rest.
std::size_t H5mdWriter::Trajectory::most_bytes_of_frame() const {
  std::size_t bytes = 0;
  for (Chunk const& chunk : chunks_) bytes += chunk.source.capacity * chunk.source.width;
  return bytes + bytes / 100 + room_for_indices;
}

template <class Number>
void H5mdWriter::Trajectory::put(Handle const& file, std::string const& path, Number value) const {
  Handle const dataset = hdf5::open_dataset(file, path);
  hsize_t const extent = frame_count() + 1;
  hdf5::require(H5Dset_extent(dataset.id(), &extent), "extend " + path);
  hdf5::write(dataset, {{frame_count()}, {1}}, std::span<Number const>(&value, 1));
}

void H5mdWriter::Trajectory::put_chunks(Handle const& file, std::size_t agents) {
  std::string present;
  Handle dataset;
  std::vector<hsize_t> extent;
  for (Chunk const& chunk : chunks_) {
    if (chunk.dataset != present) {
      present = chunk.dataset;
      dataset = hdf5::open_dataset(file, present);
      extent = hdf5::extent_of(dataset);
      extent[0] = frame_count() + 1;
      extent[1] = std::max<hsize_t>(extent[1], agents);
      hdf5::require(H5Dset_extent(dataset.id(), extent.data()), "extend " + present);
    }
    // While there has never been an agent, the dataset has no room for a chunk, not even for one of fill values.
    if (chunk.bytes.empty() || extent[1] == 0) continue;
    hdf5::require(
        H5Dwrite_chunk(dataset.id(), H5P_DEFAULT, 0, chunk.offset.data(), chunk.bytes.size(), chunk.bytes.data()),
        "write " + present);
  }
}

void H5mdWriter::Trajectory::put_values(Handle const& file, H5mdFrame const& frame) {
  for (std::size_t k = 0; k < observables_.size(); ++k) {
    put(file, "/observables/" + observables_[k] + "/value", frame.observables[k]);
  }
  put(file, "/parameters/frames/state_hash", frame.state_hash);
  put(file, "/parameters/frames/checksum", h5md::checksum(frame.frame, frame.observables, frame.state_hash));
  Handle const edges = hdf5::open_dataset(file, group_ + "/box/edges/value");
  constexpr hsize_t d = h5md::dimensions;
  std::array<hsize_t, 3> const extent{frame_count() + 1, d, d};
  hdf5::require(H5Dset_extent(edges.id(), extent.data()), "extend the box");
  double const box[] = {frame.frame.box.width(), 0, 0, 0, frame.frame.box.height(), 0, 0, 0, 1};
  hdf5::write(edges, {{frame_count(), 0, 0}, {1, d, d}}, std::span<double const>(box));
}

void H5mdWriter::Trajectory::write(H5mdFrame const& frame) {
  require_columns(frame.frame);
  assert(frame.observables.size() == observables_.size());
  gather_chunks(frame.frame);
  FrameValues const ids = frame.frame.ids;
  std::size_t const first_of_ids = chunks_.size();
  add_chunks(group_ + "/id/value", ids, std::nullopt);
  for (std::size_t k = first_of_ids; k < chunks_.size(); ++k) chunks_[k].source.fill = h5md::absent_id;

  hdf5::reserve(path_, most_bytes_of_frame());
  Handle file = hdf5::open_file(path_, Access::append);
  // A frame that was cut short may have left other numbers where this one has none but the fill value.
  bool const was_cut_short = hdf5::extent_of(hdf5::open_dataset(file, group_ + "/id/value"))[0] > frame_count();
  for (Chunk& chunk : chunks_) chunk.source.keeps_fill = was_cut_short;
  deflate_chunks();
  put_chunks(file, frame.frame.size());
  put_values(file, frame);
  put(file, group_ + "/id/time", frame.frame.clock.time);
  // The frame counts as soon as its step is there, so that goes to the file after all the rest.
  hdf5::flush(file);
  put(file, group_ + "/id/step", frame.frame.clock.step);
  hdf5::flush(file);
  file.close("write to the file");
  steps_.push_back(frame.frame.clock.step);
  state_hashes_.push_back(frame.state_hash);
  chunks_.clear();
}

namespace {

/// Calls `work`; what HDF5 cannot do becomes an exception of the kind that fits.
template <class Failure, class Work>
void guarded(std::filesystem::path const& path, Work const& work) {
  std::string reason;
  try {
    return work();
  } catch (hdf5::Failure const& failure) {
    reason = failure.what();
  } catch (std::filesystem::filesystem_error const& failure) {
    reason = failure.code().message();
  }
  if constexpr (std::is_same_v<Failure, Error>) {
    throw Error({.what = fmt::format("{} is damaged or no trajectory of this run: {}", path.string(), reason),
                 .hint = "name another directory, or remove the file",
                 .file = path.string()});
  } else {
    throw RunFailure(fmt::format("cannot write {}: {}", path.string(), reason));
  }
}

/// After a full disk: takes the mark of the writer off the file, so that every reader opens it, if that is still possible.
void leave_readable(std::filesystem::path const& path) {
  try {
    hdf5::repair_file(path);
  } catch (hdf5::Failure const&) {  // NOLINT(bugprone-empty-catch): the failure before this one is the one to tell
  }
}

}  // namespace

H5mdWriter::H5mdWriter(std::unique_ptr<Trajectory> trajectory) : trajectory_(std::move(trajectory)) {}
H5mdWriter::~H5mdWriter() = default;
H5mdWriter::H5mdWriter(H5mdWriter&&) noexcept = default;
H5mdWriter& H5mdWriter::operator=(H5mdWriter&&) noexcept = default;

H5mdWriter H5mdWriter::create(std::filesystem::path const& path, H5mdSettings const& settings, Frame const& first) {
  auto trajectory = std::make_unique<Trajectory>(path, first);
  guarded<RunFailure>(path, [&] { trajectory->create(settings, first); });
  return H5mdWriter(std::move(trajectory));
}

H5mdWriter H5mdWriter::append(std::filesystem::path const& path, Frame const& first) {
  auto trajectory = std::make_unique<Trajectory>(path, first);
  guarded<Error>(path, [&] { trajectory->append(); });
  return H5mdWriter(std::move(trajectory));
}

std::size_t H5mdWriter::frame_count() const { return trajectory_->steps().size(); }

std::optional<std::uint64_t> H5mdWriter::last_step() const {
  if (trajectory_->steps().empty()) return std::nullopt;
  return trajectory_->steps().back();
}

std::optional<std::uint64_t> H5mdWriter::state_hash_at(std::uint64_t step) const {
  auto const& steps = trajectory_->steps();
  auto const found = std::ranges::lower_bound(steps, step);
  if (found == steps.end() || *found != step) return std::nullopt;
  return trajectory_->state_hashes()[static_cast<std::size_t>(found - steps.begin())];
}

void H5mdWriter::write(H5mdFrame const& frame) {
  guarded<RunFailure>(trajectory_->path(), [&] {
    try {
      trajectory_->write(frame);
    } catch (hdf5::Failure const&) {
      leave_readable(trajectory_->path());
      throw;
    }
  });
}

}  // namespace gridlock
