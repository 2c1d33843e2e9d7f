#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "io/h5md_layout.hpp"
#include "io/h5md_quantity.hpp"
#include "io/h5md_source.hpp"
#include "io/xyz_header.hpp"

namespace gridlock::h5md {

namespace {

using hdf5::Handle;
using hdf5::NumberKind;

/// The range of the positions of one frame along one axis.
struct Span {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  void add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
};

/// The vectors (width, 0) and (shift, height) of a box.
struct Vectors {
  double width;
  double height;
  double shift = 0.0;
};

/// Moves positions into the periodic box and updates their images, so that each pair denotes the same point as before.
void fold_all(std::vector<double>& values, double side, std::vector<std::int32_t>* images) {
  for (std::size_t row = 0; row < values.size(); ++row) {
    double const before = values[row];
    double const image = xyz::fold(values[row], side) + (images != nullptr ? (*images)[row] : 0);
    if (!(std::abs(image) <= std::numeric_limits<std::int32_t>::max())) {
      throw hdf5::Failure(fmt::format("an agent is at {:.6g}, {:.3g} boxes outside", before, std::abs(image)));
    }
    if (images != nullptr) (*images)[row] = static_cast<std::int32_t>(image);
  }
}

void count_from_wall(std::vector<double>& values, double side, Span const* around) {
  bool const is_centred = around == nullptr && std::ranges::any_of(values, [](double value) { return value < 0.0; });
  double const wall = around != nullptr ? around->min : is_centred ? -0.5 * side : 0.0;
  for (double& value : values) {
    if (!(value >= wall && value <= wall + side)) {
      throw hdf5::Failure(
          fmt::format("an agent is at {:.6g}, outside the walls at {:.6g} and {:.6g}", value, wall, wall + side));
    }
    value = std::clamp(value - wall, 0.0, side);
  }
}

/// A trajectory of another program than Gridlock.
class OtherTrajectory final : public Source {
 public:
  explicit OtherTrajectory(std::filesystem::path path) : path_(std::move(path)) {
    guarded(path_, [&] {
      bytes_ = hdf5::size_of_file(path_);
      file_ = hdf5::open_file(path_, hdf5::Access::read);
      find_agents();
      find_positions();
      read_clocks();
      read_creator();
      read_boundary();
      find_quantities();
      find_observables();
      if (!has_edges()) surround();
    });
  }

  [[nodiscard]] H5mdSettings const& settings() const override { return settings_; }
  [[nodiscard]] std::vector<Clock> const& clocks() const override { return clocks_; }
  [[nodiscard]] std::vector<std::string> column_names() const override;
  [[nodiscard]] H5mdFrame frame(std::size_t k) const override {
    return guarded(path_, [&] { return read_frame(k); });
  }
  [[nodiscard]] std::vector<double> observable(std::size_t k) const override {
    return guarded(path_, [&] {
      auto const values = hdf5::open_dataset(file_, "/observables/" + settings_.observables[k].name + "/value");
      return hdf5::read_as<double>(values, {{0}, {clocks_.size()}});
    });
  }
  [[nodiscard]] std::optional<FrameContacts> contacts() const override { return std::nullopt; }

 private:
  void find_agents();
  void find_positions();
  void read_clocks();
  void read_creator();
  void read_boundary();
  void find_quantities();
  [[nodiscard]] std::optional<Quantity> quantity_of(std::string const& name) const;
  void find_observables();
  [[nodiscard]] bool has_edges() const;
  void surround();

  [[nodiscard]] H5mdFrame read_frame(std::size_t k) const;
  [[nodiscard]] std::vector<std::size_t> row_index(std::size_t k, std::vector<Id>& ids) const;
  [[nodiscard]] Vectors vectors_at(std::size_t k) const;
  [[nodiscard]] std::vector<double> component(Quantity const& quantity, std::size_t k, std::size_t c) const;
  [[nodiscard]] FrameValues values(Quantity const& quantity, std::size_t k, std::size_t c) const {
    return values_of(file_, quantity, {.frame = k, .component = c, .agents = agents_});
  }
  void require_plane(std::size_t k) const;
  void put_inside(Frame& frame, double shift) const;

  std::filesystem::path path_;
  std::uint64_t bytes_ = 0;
  Handle file_;
  H5mdSettings settings_;
  std::string group_;
  Quantity positions_{.name = "position", .path = "", .is_fixed = false, .is_vector = true};
  std::size_t dimensions_ = 2;
  std::size_t agents_ = 0;
  std::vector<Clock> clocks_;
  std::pair<Edge, Edge> edges_{};
  std::vector<Quantity> quantities_;
  std::optional<std::pair<Span, Span>> around_;  ///< range of all positions in x and y, for boxes without edges
};

void OtherTrajectory::find_agents() {
  auto const particles = hdf5::find_group(file_, "/particles");
  if (!particles) {
    bool const is_netcdf = H5Aexists(file_.id(), "_NCProperties") > 0 || H5Aexists(file_.id(), "Conventions") > 0;
    throw hdf5::Failure(
        fmt::format("it is {}, but no H5MD: it has no group /particles", is_netcdf ? "netCDF" : "HDF5"));
  }
  for (std::string& name : hdf5::names_in(*particles)) {
    std::string const group = "/particles/" + name;
    bool const has_positions = hdf5::find_dataset(file_, group + "/position/value").has_value() ||
                               hdf5::find_dataset(file_, group + "/position").has_value();
    if (!has_positions) continue;
    if (group_.empty()) {
      group_ = group;
      settings_.agents = std::move(name);
    } else {
      settings_.left_out.push_back(group);
    }
  }
  if (group_.empty()) throw hdf5::Failure("no group below /particles has positions");
}

void OtherTrajectory::find_positions() {
  positions_.is_fixed = !hdf5::find_dataset(file_, group_ + "/position/value");
  positions_.path = group_ + (positions_.is_fixed ? "/position" : "/position/value");
  std::vector<hsize_t> extent = hdf5::extent_of(hdf5::open_dataset(file_, positions_.path));
  if (positions_.is_fixed) extent.insert(extent.begin(), 1);
  if (extent.size() != 3 || extent[2] < 2 || extent[2] > 3) {
    throw hdf5::Failure(fmt::format("{} has the shape ({}), and is read as (frames, agents, 2 or 3)", positions_.path,
                                    fmt::join(extent, ", ")));
  }
  if (extent[0] / max_deflation > bytes_) throw hdf5::Failure("the number of frames is damaged");
  if (extent[1] / max_deflation > bytes_) throw hdf5::Failure("the number of agents is damaged");
  clocks_.resize(extent[0]);
  agents_ = extent[1];
  dimensions_ = extent[2];
}

void OtherTrajectory::read_clocks() {
  if (positions_.is_fixed) return;
  std::vector<double> steps = clock_of(file_, group_ + "/position", "step", clocks_.size());
  std::vector<double> times = clock_of(file_, group_ + "/position", "time", clocks_.size());
  if (steps.empty()) {
    steps.resize(clocks_.size());
    std::iota(steps.begin(), steps.end(), 0.0);
  }
  // A file without times gets its steps as times.
  if (times.empty()) times = steps;
  // In a file that is still being written, the positions of a frame come before its step.
  clocks_.resize(std::min({clocks_.size(), steps.size(), times.size()}));
  constexpr double max_step = 9007199254740992.0;  // up to 2⁵³ every whole number is a double
  for (std::size_t k = 0; k < clocks_.size(); ++k) {
    if (!(steps[k] >= 0.0 && steps[k] <= max_step))
      throw hdf5::Failure(fmt::format("frame {} is of step {}", k, steps[k]));
    clocks_[k] = {static_cast<std::uint64_t>(steps[k]), times[k]};
  }
}

void OtherTrajectory::read_creator() {
  settings_.creator.clear();
  if (auto const creator = hdf5::find_group(file_, "/h5md/creator")) {
    settings_.creator = hdf5::read_text_attribute(*creator, "name");
    settings_.version = hdf5::read_text_attribute(*creator, "version");
  }
  if (auto const author = hdf5::find_group(file_, "/h5md/author"))
    settings_.author = hdf5::read_text_attribute(*author, "name");
}

void OtherTrajectory::read_boundary() {
  auto const box = hdf5::find_group(file_, group_ + "/box");
  if (!box || H5Aexists(box->id(), "boundary") <= 0) return;
  edges_ = edges_of(hdf5::read_texts(*box, "boundary"));
}

std::optional<Quantity> OtherTrajectory::quantity_of(std::string const& name) const {
  std::string const path = group_ + "/" + name;
  bool const is_fixed = !hdf5::find_dataset(file_, path + "/value");
  std::string const values = is_fixed ? path : path + "/value";
  auto const dataset = hdf5::find_dataset(file_, values);
  if (!dataset || hdf5::kind_of_numbers(*dataset) == NumberKind::other) return std::nullopt;
  std::vector<hsize_t> extent = hdf5::extent_of(*dataset);
  if (!is_fixed) {
    // A quantity that is measured less often than positions is left out.
    if (extent.empty() || extent[0] < clocks_.size()) return std::nullopt;
    std::vector<double> const steps = clock_of(file_, path, "step", clocks_.size());
    for (std::size_t k = 0; k < steps.size() && k < clocks_.size(); ++k) {
      if (steps[k] != static_cast<double>(clocks_[k].step)) return std::nullopt;
    }
    extent.erase(extent.begin());
  }
  bool const is_vector = extent.size() == 2 && extent[1] == dimensions_;
  if (extent.empty() || extent[0] != agents_ || (extent.size() != 1 && !is_vector)) return std::nullopt;
  return Quantity{.name = name, .path = values, .is_fixed = is_fixed, .is_vector = is_vector};
}

void OtherTrajectory::find_quantities() {
  for (std::string const& name : hdf5::names_in(hdf5::open_group(file_, group_))) {
    if (name == "box" || name == "position" || name == "id") continue;
    // Diameters are left out if the file has radii too.
    bool const is_twice = name == "diameter" && quantity_of("radius");
    if (auto const quantity = quantity_of(name); quantity && !is_twice) {
      quantities_.push_back(*quantity);
    } else {
      settings_.left_out.push_back(group_ + "/" + name);
    }
  }
}

void OtherTrajectory::find_observables() {
  auto const group = hdf5::find_group(file_, "/observables");
  if (!group) return;
  for (std::string& name : hdf5::names_in(*group)) {
    auto const values = hdf5::find_dataset(file_, "/observables/" + name + "/value");
    bool const is_series = values && hdf5::kind_of_numbers(*values) != NumberKind::other &&
                           hdf5::extent_of(*values).size() == 1 && hdf5::extent_of(*values)[0] == clocks_.size();
    if (!is_series) {
      settings_.left_out.push_back("/observables/" + name);
      continue;
    }
    std::string unit = hdf5::read_text_attribute(*values, "unit");
    settings_.observables.push_back({std::move(name), std::move(unit)});
  }
}

bool OtherTrajectory::has_edges() const {
  auto const box = hdf5::find_group(file_, group_ + "/box");
  return box && (H5Aexists(box->id(), "edges") > 0 || hdf5::find_dataset(file_, group_ + "/box/edges") ||
                 hdf5::find_dataset(file_, group_ + "/box/edges/value"));
}

/// Sets the box to the rectangle around all positions of all frames, for files without edges of the box.
void OtherTrajectory::surround() {
  if (edges_.first == Edge::periodic || edges_.second == Edge::periodic)
    throw hdf5::Failure("its box is periodic and has no edges");
  auto& [x, y] = around_.emplace();
  for (std::size_t k = 0; k < clocks_.size(); ++k) {
    for (double const value : component(positions_, k, 0)) x.add(value);
    for (double const value : component(positions_, k, 1)) y.add(value);
  }
}

/// Returns the vectors of the box in frame k. Edges are lengths or a matrix, fixed or with steps of their own.
Vectors OtherTrajectory::vectors_at(std::size_t k) const {
  if (around_) return {around_->first.max - around_->first.min, around_->second.max - around_->second.min};
  std::string const path = group_ + "/box/edges";
  std::vector<double> edges;
  if (auto const each = hdf5::find_dataset(file_, path + "/value")) {
    std::vector<hsize_t> count = hdf5::extent_of(*each);
    if (count.empty() || count[0] == 0 || count.size() > 3)
      throw hdf5::Failure(path + " is not stored as it should be");
    std::vector<double> const steps = clock_of(file_, path, "step", count[0]);
    auto const later = std::ranges::upper_bound(steps, static_cast<double>(clocks_[k].step));
    std::size_t const entry = steps.empty() || count[0] == clocks_.size()
                                  ? k
                                  : static_cast<std::size_t>(std::max<std::ptrdiff_t>(later - steps.begin(), 1) - 1);
    std::vector<hsize_t> start(count.size(), 0);
    start[0] = std::min<hsize_t>(entry, count[0] - 1);
    count[0] = 1;
    if (std::accumulate(count.begin(), count.end(), hsize_t{1}, std::multiplies<>()) <= 9)
      edges = hdf5::read_as<double>(*each, {start, count});
  } else if (auto const fixed = hdf5::find_dataset(file_, path)) {
    std::vector<hsize_t> const count = hdf5::extent_of(*fixed);
    if (std::accumulate(count.begin(), count.end(), hsize_t{1}, std::multiplies<>()) <= 9)
      edges = hdf5::read_as<double>(*fixed, {std::vector<hsize_t>(count.size(), 0), count});
  } else {
    edges = hdf5::read_numbers(hdf5::open_group(file_, group_ + "/box"), "edges");
  }
  std::size_t const d = dimensions_;
  if (edges.size() == 1) return {edges[0], edges[0]};
  if (edges.size() == d) return {edges[0], edges[1]};
  if (edges.size() != d * d)
    throw hdf5::Failure(fmt::format("{} has {} numbers in {} dimensions", path, edges.size(), d));
  if (edges[1] != 0.0) {
    throw hdf5::Failure(
        fmt::format("the first edge of its box is ({:.6g}, {:.6g}), and here it must lie along x", edges[0], edges[1]));
  }
  return {edges[0], edges[d + 1], edges[d]};
}

std::vector<double> OtherTrajectory::component(Quantity const& quantity, std::size_t k, std::size_t c) const {
  return std::get<std::vector<double>>(values(quantity, k, c));
}

std::vector<std::string> OtherTrajectory::column_names() const {
  std::vector<std::string> names{X::name, Y::name};
  for (Quantity const& quantity : quantities_) {
    std::string const element = quantity.name == "diameter" ? Radius::name : quantity.name;
    for (std::string& name : h5md::column_names(element, quantity.is_vector)) names.push_back(std::move(name));
  }
  return names;
}

/// Returns the rows of a frame in ascending order of Ids. Without Ids in the file, row numbers are Ids. A negative Id
/// or the largest possible Id marks an absent agent.
std::vector<std::size_t> OtherTrajectory::row_index(std::size_t k, std::vector<Id>& ids) const {
  std::vector<std::size_t> rows(agents_);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  auto const quantity = quantity_of("id");
  if (!quantity || quantity->is_vector) {
    ids.assign(rows.begin(), rows.end());
    return rows;
  }
  Handle const dataset = hdf5::open_dataset(file_, quantity->path);
  hdf5::Part const part = quantity->is_fixed ? hdf5::Part{{0}, {agents_}} : hdf5::Part{{k, 0}, {1, agents_}};
  std::vector<Id> all;
  if (hdf5::kind_of_numbers(dataset) == NumberKind::positive_whole) {
    all = hdf5::read_as<std::uint64_t>(dataset, part);
  } else {
    for (std::int64_t const id : hdf5::read_as<std::int64_t>(dataset, part))
      all.push_back(id < 0 ? absent_id : static_cast<Id>(id));
  }
  std::erase_if(rows, [&](std::size_t row) { return all[row] == absent_id; });
  std::ranges::stable_sort(rows, {}, [&](std::size_t row) { return all[row]; });
  for (std::size_t const row : rows) {
    if (!ids.empty() && ids.back() == all[row])
      throw hdf5::Failure(fmt::format("two agents of frame {} have the id {}", k, all[row]));
    ids.push_back(all[row]);
  }
  return rows;
}

/// Throws if the positions in three dimensions do not lie in one plane, since Gridlock's box is a plane.
void OtherTrajectory::require_plane(std::size_t k) const {
  if (dimensions_ == 2) return;
  Span z;
  for (double const value : component(positions_, k, 2)) z.add(value);
  if (z.max > z.min) {
    throw hdf5::Failure(fmt::format(
        "its agents lie in space, z from {:.6g} to {:.6g} in frame {}, and here they lie in a plane", z.min, z.max, k));
  }
}

/// Moves positions into the box, with its lower left corner as origin. Along periodic axes the file's origin does not
/// matter, since positions are folded and images updated. Between walls a negative position shows that the origin is
/// the middle of the box.
void OtherTrajectory::put_inside(Frame& frame, double shift) const {
  auto const images_of = [&](char const* image) {
    auto const found = std::ranges::find(frame.columns, image, &FrameColumn::name);
    return found == frame.columns.end() ? nullptr : std::get_if<std::vector<std::int32_t>>(&found->values);
  };
  auto& x = std::get<std::vector<double>>(frame.columns[0].values);
  auto& y = std::get<std::vector<double>>(frame.columns[1].values);
  auto* const images_x = images_of(ImageX::name);
  auto* const images_y = images_of(ImageY::name);
  if (frame.box.is_oblique()) lean(frame.box, shift, x, y, images_x, images_y);
  auto const put = [&](std::vector<double>& values, double side, bool is_periodic, std::vector<std::int32_t>* images,
                       Span const* around) {
    if (is_periodic) {
      fold_all(values, side, images);
    } else {
      count_from_wall(values, side, around);
    }
  };
  put(x, frame.box.width(), frame.box.is_periodic_x(), images_x, around_ ? &around_->first : nullptr);
  put(y, frame.box.height(), frame.box.is_periodic_y(), images_y, around_ ? &around_->second : nullptr);
}

FrameValues in_order(FrameValues const& values, std::vector<std::size_t> const& rows) {
  return std::visit(
      [&](auto const& numbers) -> FrameValues {
        std::remove_cvref_t<decltype(numbers)> sorted;
        sorted.reserve(rows.size());
        for (std::size_t const row : rows) sorted.push_back(numbers[row]);
        return sorted;
      },
      values);
}

/// Converts diameters to radii.
void convert(Quantity const& quantity, FrameValues& values) {
  if (quantity.name == "diameter") {
    auto* const numbers = std::get_if<std::vector<double>>(&values);
    if (numbers == nullptr) throw hdf5::Failure(quantity.path + " holds numbers of another type than it should");
    for (double& number : *numbers) number *= 0.5;
  }
}

H5mdFrame OtherTrajectory::read_frame(std::size_t k) const {
  require_plane(k);
  H5mdFrame result;
  Frame& frame = result.frame;
  auto const [width, height, shift] = vectors_at(k);
  try {
    frame.box = box_of(width, height, shift, edges_);
    result.given_tilt = shift / height;
  } catch (Error const&) {
    throw hdf5::Failure(fmt::format("the box of frame {} is {} × {} with the shift {}", k, width, height, shift));
  }
  frame.clock = clocks_[k];
  std::vector<std::size_t> const rows = row_index(k, frame.ids);
  std::vector<std::string> const names = column_names();
  for (std::size_t c = 0; c < 2; ++c)
    frame.columns.push_back({.name = names[c], .values = in_order(values(positions_, k, c), rows)});
  for (Quantity const& quantity : quantities_) {
    for (std::size_t c = 0; c < (quantity.is_vector ? 2U : 1U); ++c) {
      FrameValues of_all = values(quantity, k, c);
      convert(quantity, of_all);
      frame.columns.push_back({.name = names[frame.columns.size()], .values = in_order(of_all, rows)});
    }
  }
  put_inside(frame, shift);
  for (H5mdObservable const& observable : settings_.observables) {
    Handle const values_of = hdf5::open_dataset(file_, "/observables/" + observable.name + "/value");
    result.observables.push_back(hdf5::read_as<double>(values_of, {{k}, {1}}).front());
  }
  return result;
}

}  // namespace

std::unique_ptr<Source> open_other(std::filesystem::path const& path) {
  return std::make_unique<OtherTrajectory>(path);
}

}  // namespace gridlock::h5md
