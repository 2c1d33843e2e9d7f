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
#include "core/resources.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "io/deflated_chunk.hpp"
#include "io/h5md_dataset.hpp"
#include "io/h5md_layout.hpp"
#include "io/h5md_networks.hpp"
#include "io/hdf5.hpp"

namespace gridlock {

namespace {

using hdf5::Access;
using hdf5::Handle;

/// Smallest number of values that several threads deflate; waking threads for fewer takes longer.
constexpr std::size_t min_parallel_numbers = 100'000;
constexpr std::size_t room_for_indices = 65536;
/// Maximum number of chunks in memory for each core, so that all cores stay busy; at least min_chunks_in_memory.
constexpr std::size_t chunks_per_core = 3;
constexpr std::size_t min_chunks_in_memory = 12;

hid_t native_of(FrameValues const& values) {
  return std::visit([](auto const& numbers) { return hdf5::native<std::remove_cvref_t<decltype(numbers[0])>>(); },
                    values);
}

using h5md::create_dataset;
using h5md::Shape;

Shape one_for_each_frame() { return {{0}, {H5S_UNLIMITED}, {h5md::frames_per_chunk}}; }

void set_unit(Handle const& file, std::string const& path, std::string const& unit) {
  // The attribute is not H5MD's "unit", since readers refuse units that they cannot convert, such as reduced units.
  if (!unit.empty()) hdf5::set_attribute(hdf5::open_dataset(file, path), "reduced_unit", unit);
}

/// Writes the parts of a new trajectory that precede the first frame.
class Beginning {
 public:
  Beginning(Handle const& file, H5mdSettings const& settings, FrameSource const& first)
      : file_(file), settings_(settings), frame_(first), group_("/particles/" + settings.agents) {}

  void write() {
    write_origin();
    hdf5::create_group(file_, "/particles");
    hdf5::create_group(file_, group_);
    write_elements();
    write_box();
    write_observables();
    write_parameters();
    h5md::create_beside(file_, frame_, group_, static_cast<int>(settings_.compression));
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
    hsize_t const rows = std::clamp<std::size_t>(rounded, 64, h5md::max_rows_per_chunk);
    int const compression = static_cast<int>(settings_.compression);
    Shape const scalars{{0, 0}, {H5S_UNLIMITED, H5S_UNLIMITED}, {1, rows}};
    Shape const vectors{{0, 0, h5md::dimensions}, {H5S_UNLIMITED, H5S_UNLIMITED, h5md::dimensions}, {1, rows, 1}};
    hdf5::create_group(file_, group_ + "/id");
    create_dataset(file_, group_ + "/id/value", hdf5::native<std::uint64_t>(), scalars,
                   {.compression = compression, .fill = h5md::absent_id});
    create_dataset(file_, group_ + "/id/step", hdf5::native<std::uint64_t>(), one_for_each_frame());
    create_dataset(file_, group_ + "/id/time", hdf5::native<double>(), one_for_each_frame());
    set_unit(file_, group_ + "/id/time", "time");
    for (h5md::Element const& element : h5md::elements_of(frame_.columns())) {
      std::string const path = group_ + "/" + element.name;
      hdf5::create_group(file_, path);
      create_dataset(file_, path + "/value", native_of(frame_.columns()[element.columns[0]].values),
                     element.is_vector() ? vectors : scalars, {.compression = compression});
      set_unit(file_, path + "/value", element.unit);
      if (auto const names = settings_.value_names.find(element.name); names != settings_.value_names.end()) {
        hdf5::set_attribute(hdf5::open_group(file_, path), h5md::value_names, names->second);
      }
      link_clock(path);
    }
  }

  void write_box() {
    Handle const box = hdf5::create_group(file_, group_ + "/box");
    constexpr int dimension = h5md::dimensions;
    hdf5::set_attribute(box, "dimension", std::span(&dimension, 1));
    hdf5::set_attribute(box, "boundary", h5md::boundary_of(frame_.box()));
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
    write_one("/parameters/seed", frame_.seed());
    hdf5::create_group(file_, "/parameters/frames");
    for (char const* name : {"state_hash", "checksum"}) {
      create_dataset(file_, std::string("/parameters/frames/") + name, hdf5::native<std::uint64_t>(),
                     one_for_each_frame());
    }
    link_clock("/parameters/frames");
  }

  /// The contacts are written as one frame of a time-dependent element, since they change when disks move afterwards.
  void write_contacts(FrameContacts const& contacts) {
    hsize_t const count = contacts.size();
    hsize_t const chunk = std::clamp<hsize_t>(count, 1, h5md::max_rows_per_chunk);
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
  FrameSource const& frame_;
  std::string group_;
};

/// A dataset with a number or vector for each agent.
struct Dataset {
  std::string path;
  Handle handle;
  std::vector<std::size_t> columns;  ///< indices in the frame, one per component; empty for Ids
  std::uint64_t fill = 0;            ///< value of absent agents
};

/// A chunk to be written into the file.
struct Chunk {
  Dataset const* dataset = nullptr;
  std::vector<hsize_t> offset;  ///< frame, row and component of its first number
  FrameValues values;
  std::vector<std::byte> bytes = {};
};

}  // namespace

class H5mdWriter::Trajectory {
 public:
  Trajectory(std::filesystem::path path, FrameSource const& first)
      : path_(std::move(path)), elements_(h5md::elements_of(first.columns())), columns_(first.columns()) {}

  void create(H5mdSettings const& settings, FrameSource const& first);
  void append();
  void write(FrameSource const& frame, std::span<double const> observables, std::uint64_t state_hash);

  [[nodiscard]] std::filesystem::path const& path() const { return path_; }
  [[nodiscard]] std::vector<std::uint64_t> const& steps() const { return steps_; }
  [[nodiscard]] std::vector<std::uint64_t> const& state_hashes() const { return state_hashes_; }

 private:
  void require_whole() const;
  void look_into(Handle const& file);
  void require_columns(FrameSource const& frame) const;
  [[nodiscard]] std::vector<Dataset> open_datasets(Handle const& file) const;
  [[nodiscard]] std::size_t max_bytes_of_frame(std::size_t agents) const;
  [[nodiscard]] std::size_t extend(Dataset const& dataset, std::size_t agents) const;
  [[nodiscard]] std::uint64_t put_agents(Handle const& file, FrameSource const& frame,
                                         std::span<double const> observables, std::uint64_t state_hash) const;
  void deflate(std::vector<Chunk>& chunks, bool keeps_fill) const;
  void put_chunks(std::vector<Chunk>& chunks, bool keeps_fill) const;
  void put_box(Handle const& file, Box const& box) const;
  template <class Number>
  void put(Handle const& file, std::string const& path, Number value) const;
  [[nodiscard]] std::size_t frame_count() const { return steps_.size(); }

  std::filesystem::path path_;
  std::vector<h5md::Element> elements_;
  std::vector<FrameColumn> columns_;  ///< without values
  std::string group_;
  std::vector<std::string> observables_;
  std::size_t rows_per_chunk_ = 0;
  int compression_ = 0;
  std::vector<std::string> boundary_;
  std::vector<std::uint64_t> steps_;
  std::vector<std::uint64_t> state_hashes_;
};

void H5mdWriter::Trajectory::create(H5mdSettings const& settings, FrameSource const& first) {
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

/// Throws if the file is damaged or cut off. The last frame has the last bytes of the file, so reading it suffices.
void H5mdWriter::Trajectory::require_whole() const {
  H5mdReader const reader(path_);
  if (reader.frame_count() > 0) static_cast<void>(reader.frame(reader.frame_count() - 1));
}

void H5mdWriter::Trajectory::append() {
  // The file is first only read, since HDF5 changes a file, even a damaged one, as soon as it is opened for writing.
  require_whole();
  look_into(hdf5::open_file(path_, Access::read));
  try {
    hdf5::open_file(path_, Access::append);
  } catch (hdf5::Failure const&) {
    // A killed writer left HDF5's mark of an open file, so that HDF5 refuses to append.
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
  if (rows_per_chunk_ == 0 || rows_per_chunk_ > h5md::max_rows_per_chunk) {
    throw hdf5::Failure("the ids are not stored as they should be");
  }
  unsigned level = 0;
  std::size_t parameters = 1;
  bool const is_deflated =
      H5Pget_filter_by_id2(list.id(), H5Z_FILTER_DEFLATE, nullptr, &parameters, &level, 0, nullptr, nullptr) >= 0;
  compression_ = is_deflated ? static_cast<int>(level) : 0;
  boundary_ = hdf5::read_texts(hdf5::open_group(file, group_ + "/box"), "boundary");
  for (h5md::Element const& element : elements_) {
    if (!hdf5::has(file, group_ + "/" + element.name)) throw hdf5::Failure("the file holds no " + element.name);
  }
  Handle const steps = hdf5::open_dataset(file, group_ + "/id/step");
  std::vector<hsize_t> const frames = hdf5::extent_of(steps);
  if (frames.size() != 1) throw hdf5::Failure("the steps are not stored as they should be");
  steps_ = hdf5::read<std::uint64_t>(steps, {{0}, frames});
  state_hashes_ = hdf5::read<std::uint64_t>(hdf5::open_dataset(file, "/parameters/frames/state_hash"), {{0}, frames});
}

void H5mdWriter::Trajectory::require_columns(FrameSource const& frame) const {
  if (frame.columns() != columns_ || h5md::boundary_of(frame.box()) != boundary_) {
    throw RunFailure(fmt::format("{}: a frame has other columns or edges than the first one", path_.string()));
  }
}

/// Returns the datasets in the order of the checksum: Ids first, then columns.
std::vector<Dataset> H5mdWriter::Trajectory::open_datasets(Handle const& file) const {
  std::vector<Dataset> datasets;
  auto const add = [&](std::string const& name, std::vector<std::size_t> const& columns, std::uint64_t fill) {
    std::string const path = group_ + "/" + name + "/value";
    datasets.push_back({path, hdf5::open_dataset(file, path), columns, fill});
  };
  add("id", {}, h5md::absent_id);
  for (h5md::Element const& element : elements_) add(element.name, element.columns, 0);
  return datasets;
}

/// Returns an upper bound of a frame's size in bytes. Deflate lengthens incompressible data by less than 1 %.
std::size_t H5mdWriter::Trajectory::max_bytes_of_frame(std::size_t agents) const {
  std::size_t const chunks = std::max<std::size_t>((agents + rows_per_chunk_ - 1) / rows_per_chunk_, 1);
  std::size_t width = sizeof(Id);
  for (FrameColumn const& column : columns_) width += h5md::width_of(column.values);
  std::size_t const bytes = chunks * rows_per_chunk_ * width;
  return bytes + bytes / 100 + room_for_indices;
}

/// Extends a dataset by one frame; returns for how many agents each frame has room.
std::size_t H5mdWriter::Trajectory::extend(Dataset const& dataset, std::size_t agents) const {
  std::vector<hsize_t> extent = hdf5::extent_of(dataset.handle);
  extent[0] = frame_count() + 1;
  extent[1] = std::max<hsize_t>(extent[1], agents);
  hdf5::require(H5Dset_extent(dataset.handle.id(), extent.data()), "extend " + dataset.path);
  return extent[1];
}

/// Writes the values of all agents, some chunks at a time; returns the checksum of the frame.
std::uint64_t H5mdWriter::Trajectory::put_agents(Handle const& file, FrameSource const& frame,
                                                 std::span<double const> observables, std::uint64_t state_hash) const {
  std::vector<Dataset> const datasets = open_datasets(file);
  // If the last frame of the file is incomplete, its values must be overwritten, also by chunks of only fill values.
  bool const was_cut_short = std::ranges::any_of(
      datasets, [&](Dataset const& dataset) { return hdf5::extent_of(dataset.handle)[0] > frame_count(); });
  std::size_t const max_chunks = std::max(min_chunks_in_memory, chunks_per_core * usable_cores());
  h5md::Checksum sum = h5md::begun_checksum(frame.box(), frame.clock(), frame.seed(), frame.size(), state_hash);
  std::vector<Chunk> chunks;
  for (Dataset const& dataset : datasets) {
    std::size_t const room = extend(dataset, frame.size());
    bool const is_of_ids = dataset.columns.empty();
    for (std::size_t c = 0; c < (is_of_ids ? 1 : dataset.columns.size()); ++c) {
      if (!is_of_ids) sum.add(std::span(frame.columns()[dataset.columns[c]].name));
      for_each_piece(was_cut_short ? room : frame.size(), rows_per_chunk_, [&](std::size_t start, std::size_t rows) {
        std::size_t const first = std::min(start, frame.size());
        std::size_t const count = std::min(rows, frame.size() - first);
        std::vector<hsize_t> offset{frame_count(), start};
        if (dataset.columns.size() == 2) offset.push_back(c);
        chunks.push_back(
            {&dataset, std::move(offset),
             is_of_ids ? FrameValues(frame.ids(first, count)) : frame.values(dataset.columns[c], first, count)});
        sum.add(h5md::bytes_of(chunks.back().values));
        if (chunks.size() == max_chunks) put_chunks(chunks, was_cut_short);
      });
    }
  }
  put_chunks(chunks, was_cut_short);
  h5md::add_fields(sum, frame.fields());
  h5md::add_networks(sum, frame.networks());
  sum.add(observables);
  return sum.digest();
}

void H5mdWriter::Trajectory::deflate(std::vector<Chunk>& chunks, bool keeps_fill) const {
  auto const deflate_one = [&](std::size_t k) {
    Chunk& chunk = chunks[k];
    ChunkSource const source{.bytes = h5md::bytes_of(chunk.values),
                             .width = h5md::width_of(chunk.values),
                             .capacity = rows_per_chunk_,
                             .fill = chunk.dataset->fill,
                             .keeps_fill = keeps_fill};
    chunk.bytes = deflated_chunk(source, compression_);
    chunk.values = {};
  };
  if (chunks.size() * rows_per_chunk_ < min_parallel_numbers) {
    for (std::size_t k = 0; k < chunks.size(); ++k) deflate_one(k);
  } else {
    on_all_cores([&] { tbb::parallel_for(std::size_t{0}, chunks.size(), deflate_one); });
  }
}

void H5mdWriter::Trajectory::put_chunks(std::vector<Chunk>& chunks, bool keeps_fill) const {
  deflate(chunks, keeps_fill);
  for (auto const& [dataset, offset, values, bytes] : chunks) {
    if (bytes.empty()) continue;
    hdf5::require(H5Dwrite_chunk(dataset->handle.id(), H5P_DEFAULT, 0, offset.data(), bytes.size(), bytes.data()),
                  "write " + dataset->path);
  }
  chunks.clear();
}

template <class Number>
void H5mdWriter::Trajectory::put(Handle const& file, std::string const& path, Number value) const {
  Handle const dataset = hdf5::open_dataset(file, path);
  hsize_t const extent = frame_count() + 1;
  hdf5::require(H5Dset_extent(dataset.id(), &extent), "extend " + path);
  hdf5::write(dataset, {{frame_count()}, {1}}, std::span<Number const>(&value, 1));
}

void H5mdWriter::Trajectory::put_box(Handle const& file, Box const& box) const {
  Handle const edges = hdf5::open_dataset(file, group_ + "/box/edges/value");
  constexpr hsize_t d = h5md::dimensions;
  std::array<hsize_t, 3> const extent{frame_count() + 1, d, d};
  hdf5::require(H5Dset_extent(edges.id(), extent.data()), "extend the box");
  double const numbers[] = {box.width(), 0, 0, box.shift(), box.height(), 0, 0, 0, 1};
  hdf5::write(edges, {{frame_count(), 0, 0}, {1, d, d}}, std::span<double const>(numbers));
}

void H5mdWriter::Trajectory::write(FrameSource const& frame, std::span<double const> observables,
                                   std::uint64_t state_hash) {
  require_columns(frame);
  assert(observables.size() == observables_.size());
  hdf5::reserve(path_, max_bytes_of_frame(frame.size()) + h5md::max_bytes_beside(frame));
  Handle file = hdf5::open_file(path_, Access::append);
  std::uint64_t const checksum = put_agents(file, frame, observables, state_hash);
  for (std::size_t k = 0; k < observables_.size(); ++k) {
    put(file, "/observables/" + observables_[k] + "/value", observables[k]);
  }
  put(file, "/parameters/frames/state_hash", state_hash);
  put(file, "/parameters/frames/checksum", checksum);
  put_box(file, frame.box());
  h5md::put_beside(file, frame, frame_count());
  put(file, group_ + "/id/time", frame.clock().time);
  // The step is written last, since a frame counts as complete as soon as its step exists.
  hdf5::flush(file);
  put(file, group_ + "/id/step", frame.clock().step);
  hdf5::flush(file);
  file.close("write to the file");
  steps_.push_back(frame.clock().step);
  state_hashes_.push_back(state_hash);
}

namespace {

/// Calls `work`, and turns errors of HDF5 and the file system into an Error or a RunFailure.
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

/// Removes the writer's mark after a full disk, if possible, so that every reader opens the file.
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

H5mdWriter H5mdWriter::create(std::filesystem::path const& path, H5mdSettings const& settings,
                              FrameSource const& first) {
  auto trajectory = std::make_unique<Trajectory>(path, first);
  guarded<RunFailure>(path, [&] { trajectory->create(settings, first); });
  return H5mdWriter(std::move(trajectory));
}

H5mdWriter H5mdWriter::append(std::filesystem::path const& path, FrameSource const& first) {
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

void H5mdWriter::write(FrameSource const& frame, std::span<double const> observables, std::uint64_t state_hash) {
  guarded<RunFailure>(trajectory_->path(), [&] {
    try {
      trajectory_->write(frame, observables, state_hash);
    } catch (hdf5::Failure const&) {
      leave_readable(trajectory_->path());
      throw;
    }
  });
}

}  // namespace gridlock
