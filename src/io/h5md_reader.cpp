#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "io/file_format.hpp"
#include "io/h5md_fields.hpp"
#include "io/h5md_layout.hpp"
#include "io/h5md_networks.hpp"
#include "io/h5md_source.hpp"
#include "io/hdf5.hpp"

namespace gridlock {

namespace {

using hdf5::Handle;

/// A trajectory that H5mdWriter wrote.
class OwnTrajectory final : public h5md::Source {
 public:
  explicit OwnTrajectory(std::filesystem::path path) : path_(std::move(path)) {
    h5md::guarded(path_, [&] {
      bytes_ = hdf5::size_of_file(path_);
      open();
    });
  }

  [[nodiscard]] H5mdSettings const& settings() const override { return settings_; }
  [[nodiscard]] std::vector<Clock> const& clocks() const override { return clocks_; }
  [[nodiscard]] std::vector<std::string> column_names() const override;

  [[nodiscard]] H5mdFrame frame(std::size_t k) const override {
    return h5md::guarded(path_, [&] { return read_frame(k); });
  }
  [[nodiscard]] std::vector<double> observable(std::size_t k) const override {
    return h5md::guarded(path_, [&] {
      return hdf5::read<double>(dataset("/observables/" + settings_.observables[k].name + "/value", 1),
                                {{0}, {clocks_.size()}});
    });
  }
  [[nodiscard]] std::optional<FrameContacts> contacts() const override {
    return h5md::guarded(path_, [&] { return read_contacts(); });
  }

 private:
  struct Element {
    std::string name;
    bool is_vector = false;
  };

  void open();
  void find_elements();
  void read_clocks();
  [[nodiscard]] H5mdFrame read_frame(std::size_t k) const;
  [[nodiscard]] std::optional<FrameContacts> read_contacts() const;
  [[nodiscard]] std::vector<Id> read_ids(std::size_t k) const;
  [[nodiscard]] Box read_box(std::size_t k) const;
  void read_columns(Element const& element, std::size_t k, Frame& frame) const;
  [[nodiscard]] Handle dataset(std::string const& path, std::size_t dimensions) const;
  template <class Number>
  [[nodiscard]] Number read_one(std::string const& path, std::size_t k) const;

  std::filesystem::path path_;
  std::uint64_t bytes_ = 0;
  Handle file_;
  H5mdSettings settings_;
  std::string group_;
  std::pair<Edge, Edge> edges_{};
  std::uint64_t seed_ = 0;
  std::vector<Element> elements_;
  std::vector<Clock> clocks_;
};

void OwnTrajectory::open() {
  file_ = hdf5::open_file(path_, hdf5::Access::read);
  std::vector<std::string> const groups = hdf5::names_in(hdf5::open_group(file_, "/particles"));
  if (groups.empty()) throw hdf5::Failure("there are no /particles");
  settings_.agents = groups[0];
  group_ = "/particles/" + groups[0];
  // The steps are read first. A writer adds the step of a frame last, so all data of the frames counted here already
  // exist.
  read_clocks();
  edges_ = h5md::edges_of(hdf5::read_texts(hdf5::open_group(file_, group_ + "/box"), "boundary"));
  settings_.configuration = hdf5::read_text(file_, "/parameters/configuration");
  settings_.version = hdf5::read_text(file_, "/parameters/version");
  settings_.author = hdf5::read_text_attribute(hdf5::open_group(file_, "/h5md/author"), "name");
  for (std::string& name : hdf5::names_in(hdf5::open_group(file_, "/observables"))) {
    Handle const value = hdf5::open_dataset(file_, "/observables/" + name + "/value");
    settings_.observables.push_back({std::move(name), hdf5::read_text_attribute(value, "reduced_unit")});
  }
  seed_ = hdf5::read<std::uint64_t>(hdf5::open_dataset(file_, "/parameters/seed"), {{0}, {1}})[0];
  find_elements();
}

void OwnTrajectory::find_elements() {
  for (std::string& name : hdf5::names_in(hdf5::open_group(file_, group_))) {
    if (name == "box" || name == "id") continue;
    std::size_t const dimensions = hdf5::extent_of(hdf5::open_dataset(file_, group_ + "/" + name + "/value")).size();
    if (dimensions != 2 && dimensions != 3) throw hdf5::Failure(name + " is not stored as it should be");
    Handle const group = hdf5::open_group(file_, group_ + "/" + name);
    if (hdf5::has_attribute(group, h5md::value_names)) {
      settings_.value_names[name] = hdf5::read_texts(group, h5md::value_names);
    }
    elements_.push_back({std::move(name), dimensions == 3});
  }
}

std::vector<std::string> OwnTrajectory::column_names() const {
  std::vector<std::string> names;
  for (Element const& element : elements_) {
    for (std::string& name : h5md::column_names(element.name, element.is_vector)) names.push_back(std::move(name));
  }
  return names;
}

void OwnTrajectory::read_clocks() {
  Handle const steps = dataset(group_ + "/id/step", 1);
  hsize_t const count = hdf5::extent_of(steps)[0];
  if (count / h5md::frames_per_chunk > bytes_) throw hdf5::Failure("the number of frames is damaged");
  auto const step = hdf5::read<std::uint64_t>(steps, {{0}, {count}});
  auto const time = hdf5::read<double>(dataset(group_ + "/id/time", 1), {{0}, {count}});
  for (std::size_t k = 0; k < count; ++k) clocks_.push_back({step[k], time[k]});
}

Handle OwnTrajectory::dataset(std::string const& path, std::size_t dimensions) const {
  Handle result = hdf5::open_dataset(file_, path);
  if (hdf5::extent_of(result).size() != dimensions) throw hdf5::Failure(path + " is not stored as it should be");
  return result;
}

template <class Number>
Number OwnTrajectory::read_one(std::string const& path, std::size_t k) const {
  return hdf5::read<Number>(dataset(path, 1), {{k}, {1}})[0];
}

Box OwnTrajectory::read_box(std::size_t k) const {
  constexpr hsize_t d = h5md::dimensions;
  auto const edges = hdf5::read<double>(dataset(group_ + "/box/edges/value", 3), {{k, 0, 0}, {1, d, d}});
  try {
    return h5md::box_of(edges[0], edges[d + 1], edges[d], edges_);
  } catch (Error const&) {
    throw hdf5::Failure(fmt::format("the box of frame {} is {} × {}", k, edges[0], edges[d + 1]));
  }
}

std::vector<Id> OwnTrajectory::read_ids(std::size_t k) const {
  Handle const values = dataset(group_ + "/id/value", 2);
  hsize_t const most = hdf5::extent_of(values)[1];
  if (most / h5md::max_deflation > bytes_) throw hdf5::Failure("the number of agents is damaged");
  auto ids = hdf5::read<std::uint64_t>(values, {{k, 0}, {1, most}});
  ids.erase(std::ranges::find(ids, h5md::absent_id), ids.end());
  return ids;
}

void OwnTrajectory::read_columns(Element const& element, std::size_t k, Frame& frame) const {
  Handle const values = dataset(group_ + "/" + element.name + "/value", element.is_vector ? 3 : 2);
  hsize_t component = 0;
  for (std::string& name : h5md::column_names(element.name, element.is_vector)) {
    hdf5::Part part{{k, 0}, {1, frame.size()}};
    if (element.is_vector) {
      part.start.push_back(component++);
      part.count.push_back(1);
    }
    FrameColumn column{.name = std::move(name), .values = {}};
    auto const read_as = [&](auto zero) {
      using Number = decltype(zero);
      if (hdf5::holds<Number>(values)) column.values = hdf5::read<Number>(values, part);
      return hdf5::holds<Number>(values);
    };
    bool const is_known =
        read_as(double{}) || read_as(std::int32_t{}) || read_as(std::uint32_t{}) || read_as(std::uint64_t{});
    if (!is_known) throw hdf5::Failure(element.name + " holds numbers of another type than it should");
    frame.columns.push_back(std::move(column));
  }
}

std::optional<FrameContacts> OwnTrajectory::read_contacts() const {
  if (!hdf5::has(file_, "/connectivity") || !hdf5::has(file_, "/connectivity/contacts")) return std::nullopt;
  std::string const path = "/connectivity/contacts/";
  Handle const ids = dataset(path + "value", 3);
  std::vector<hsize_t> const extent = hdf5::extent_of(ids);
  hsize_t const count = extent[1];
  if (extent[0] != 1 || extent[2] != 2) throw hdf5::Failure(path + "value is not stored as it should be");
  if (count / h5md::max_deflation > bytes_) throw hdf5::Failure("the number of contacts is damaged");
  FrameContacts contacts{.clock = {read_one<std::uint64_t>(path + "step", 0), read_one<double>(path + "time", 0)},
                         .ids = {},
                         .forces = {}};
  if (count > 0) {
    contacts.ids = hdf5::read<std::uint64_t>(ids, {{0, 0, 0}, {1, count, 2}});
    contacts.forces = hdf5::read<double>(dataset(path + "force", 2), {{0, 0}, {1, count}});
  }
  if (h5md::checksum(contacts) != read_one<std::uint64_t>("/parameters/checksum_of_contacts", 0)) {
    throw hdf5::Failure("the contacts are damaged: their checksum differs");
  }
  return contacts;
}

H5mdFrame OwnTrajectory::read_frame(std::size_t k) const {
  H5mdFrame result;
  Frame& frame = result.frame;
  frame.box = read_box(k);
  result.given_tilt = frame.box.tilt();
  frame.clock = clocks_[k];
  frame.seed = seed_;
  frame.ids = read_ids(k);
  for (Element const& element : elements_) read_columns(element, k, frame);
  frame.fields = h5md::read_fields(file_, k, bytes_);
  frame.networks = h5md::read_networks(file_, k, bytes_);
  for (H5mdObservable const& observable : settings_.observables) {
    result.observables.push_back(read_one<double>("/observables/" + observable.name + "/value", k));
  }
  result.state_hash = read_one<std::uint64_t>("/parameters/frames/state_hash", k);
  auto const expected = read_one<std::uint64_t>("/parameters/frames/checksum", k);
  if (h5md::checksum(frame, result.observables, result.state_hash) != expected) {
    throw hdf5::Failure(fmt::format("frame {} is damaged: its checksum differs", k));
  }
  return result;
}

/// Returns whether Gridlock wrote the file. Either of two marks suffices: a damaged byte in one mark must not make the
/// file count as another program's, whose frames have no checksums.
bool is_own(std::filesystem::path const& path) {
  return h5md::guarded(path, [&] {
    hdf5::size_of_file(path);
    Handle const file = hdf5::open_file(path, hdf5::Access::read);
    auto const creator = hdf5::find_group(file, "/h5md/creator");
    return (creator && hdf5::read_text_attribute(*creator, "name") == "gridlock") ||
           hdf5::find_dataset(file, "/parameters/frames/checksum").has_value();
  });
}

std::unique_ptr<h5md::Source> source_of(std::filesystem::path const& path) {
  auto format = recognize_format(path);
  if (!format) format = recognize_text(path);
  if (format && format->id != "hdf5") throw wrong_format(*format, path.string(), "a trajectory in H5MD");
  if (is_own(path)) return std::make_unique<OwnTrajectory>(path);
  return h5md::open_other(path);
}

}  // namespace

namespace h5md {

void refuse(std::filesystem::path const& path, std::string const& reason, char const* hint) {
  throw Error({.what = fmt::format("cannot read {}: {}", path.string(), reason), .hint = hint, .file = path.string()});
}

}  // namespace h5md

std::string note_on_left_out(std::filesystem::path const& path, H5mdSettings const& settings) {
  if (settings.left_out.empty()) return "";
  constexpr std::string_view groups = "/particles/";
  bool const is_another_group = std::ranges::any_of(settings.left_out, [&](std::string const& name) {
    return name.starts_with(groups) && name.find('/', groups.size()) == std::string::npos;
  });
  return fmt::format("not read of {}: {}{}", path.string(), fmt::join(settings.left_out, ", "),
                     is_another_group ? "; of several groups of agents the first is read, so copy another into a file "
                                        "of its own"
                                      : "");
}

H5mdReader::H5mdReader(std::filesystem::path path) : source_(source_of(path)) {}
H5mdReader::~H5mdReader() = default;
H5mdReader::H5mdReader(H5mdReader&&) noexcept = default;
H5mdReader& H5mdReader::operator=(H5mdReader&&) noexcept = default;

std::size_t H5mdReader::frame_count() const { return source_->clocks().size(); }
H5mdSettings const& H5mdReader::settings() const { return source_->settings(); }
std::span<Clock const> H5mdReader::clocks() const { return source_->clocks(); }
std::vector<std::string> H5mdReader::column_names() const { return source_->column_names(); }
std::vector<double> H5mdReader::observable(std::size_t k) const { return source_->observable(k); }
H5mdFrame H5mdReader::frame(std::size_t k) const { return source_->frame(k); }
std::optional<FrameContacts> H5mdReader::contacts() const { return source_->contacts(); }

}  // namespace gridlock
