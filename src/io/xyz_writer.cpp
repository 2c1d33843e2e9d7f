#include "io/xyz_writer.hpp"

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/all_cores.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/io/xyz.hpp"
#include "io/text.hpp"
#include "io/xyz_names.hpp"

namespace gridlock {

namespace {

bool is_real(FrameColumn const& column) { return std::holds_alternative<std::vector<double>>(column.values); }

/// Returns the index of a column of real numbers; nothing if it is missing or has whole numbers.
std::optional<std::size_t> place_of_reals(FrameSource const& frame, std::string_view name) {
  std::optional<std::size_t> const place = frame.find(name);
  return place && is_real(frame.columns()[*place]) ? place : std::nullopt;
}

std::span<double const> reals(FrameValues const& values) { return std::get<std::vector<double>>(values); }

/// Rows that one thread formats at a time, about 1 MB of text.
constexpr std::size_t rows_per_block = 8192;

/// Names the kinds of agents A, B, C … by species, or else by radius and mass in ascending order.
class Kinds {
 public:
  explicit Kinds(FrameSource const& frame)
      : radius_(place_of_reals(frame, Radius::name)),
        mass_(place_of_reals(frame, Mass::name)),
        species_(frame.find("species")) {
    if (species_ && is_real(frame.columns()[*species_])) species_.reset();
    if (!species_ && radius_) find_kinds(frame);
  }

  [[nodiscard]] char name_at(Frame const& rows, std::size_t i) const {
    if (species_) return name_of(number_at(rows.columns[*species_].values, i));
    if (!radius_) return name_of(0);
    if (kinds_.size() > most) return too_many;
    double const mass = mass_ ? reals(rows.columns[*mass_].values)[i] : 0.0;
    auto const found = kinds_.find({reals(rows.columns[*radius_].values)[i], mass});
    return found == kinds_.end() ? too_many : name_of(static_cast<std::uint64_t>(std::distance(kinds_.begin(), found)));
  }

 private:
  static constexpr std::size_t most = 20;
  static constexpr char too_many = 'X';
  static char name_of(std::uint64_t kind) { return kind < most ? static_cast<char>('A' + kind) : too_many; }
  static std::uint64_t number_at(FrameValues const& values, std::size_t i) {
    return std::visit([i](auto const& numbers) { return static_cast<std::uint64_t>(numbers[i]); }, values);
  }

  void find_kinds(FrameSource const& frame) {
    for_each_piece(frame.size(), rows_per_block, [&](std::size_t first, std::size_t count) {
      if (kinds_.size() > most) return;
      FrameValues const radii = frame.values(*radius_, first, count);
      FrameValues const masses = mass_ ? frame.values(*mass_, first, count) : std::vector<double>(count);
      for (std::size_t i = 0; i < count && kinds_.size() <= most; ++i) {
        if (!std::isnan(reals(radii)[i])) kinds_.insert({reals(radii)[i], reals(masses)[i]});
      }
    });
  }

  std::optional<std::size_t> radius_;  ///< radius_, mass_ and species_ are indices of columns
  std::optional<std::size_t> mass_;
  std::optional<std::size_t> species_;
  std::set<std::pair<double, double>> kinds_;
};

/// A property of extended XYZ and the indices of its columns.
struct PropertyColumns {
  std::string name;
  std::vector<std::size_t> columns;
  bool pads = false;
};

/// Returns all properties but type, position and id, in the order of writing.
std::vector<PropertyColumns> properties_of(FrameSource const& frame) {
  std::set<std::string_view> written{X::name, Y::name};
  std::vector<PropertyColumns> properties;
  for (xyz::PropertyName const& known : xyz::known_names()) {
    PropertyColumns property{known.name, {}, known.pads};
    for (std::string const& name : known.columns) {
      if (auto const place = frame.find(name)) property.columns.push_back(*place);
    }
    if (property.columns.size() != known.columns.size()) continue;
    written.insert(known.columns.begin(), known.columns.end());
    properties.push_back(std::move(property));
  }
  for (std::size_t place = 0; place < frame.columns().size(); ++place) {
    std::string const& name = frame.columns()[place].name;
    if (!written.contains(name)) properties.push_back({name, {place}, false});
  }
  return properties;
}

std::string header(FrameSource const& frame, std::vector<PropertyColumns> const& properties) {
  std::string names = "type:S:1:pos:R:3:id:I:1";
  for (PropertyColumns const& property : properties) {
    names += fmt::format(":{}:{}:{}", property.name, is_real(frame.columns()[property.columns.front()]) ? 'R' : 'I',
                         property.columns.size() + (property.pads ? 1 : 0));
  }
  std::string const pbc =
      fmt::format("{} {} F", frame.box().is_periodic_x() ? 'T' : 'F', frame.box().is_periodic_y() ? 'T' : 'F');
  return fmt::format("{}\nLattice=\"{} 0 0 {} {} 0 0 0 1\" pbc=\"{}\" Properties={} Time={} step={} seed={}\n",
                     frame.size(), double_text(frame.box().width()), double_text(frame.box().shift()),
                     double_text(frame.box().height()), pbc, names, double_text(frame.clock().time), frame.clock().step,
                     frame.seed());
}

/// Formats the rows of a frame as text.
class Rows {
 public:
  explicit Rows(FrameSource const& frame)
      : frame_(frame),
        x_(place_of_reals(frame, X::name).value()),
        y_(place_of_reals(frame, Y::name).value()),
        kinds_(frame),
        properties_(properties_of(frame)) {}

  [[nodiscard]] std::size_t size() const { return frame_.size(); }
  [[nodiscard]] std::string header() const { return gridlock::header(frame_, properties_); }

  /// Returns the rows from `first` on, at most rows_per_block.
  [[nodiscard]] Frame block(std::size_t first) const {
    return frame_.piece(first, std::min(rows_per_block, frame_.size() - first));
  }

  [[nodiscard]] std::string text(Frame const& rows) const {
    std::span<double const> const x = reals(rows.columns[x_].values);
    std::span<double const> const y = reals(rows.columns[y_].values);
    std::string text;
    auto const out = std::back_inserter(text);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      fmt::format_to(out, "{} {} {} 0 {}", kinds_.name_at(rows, i), x[i], y[i], rows.ids[i]);
      for (PropertyColumns const& property : properties_) {
        for (std::size_t const column : property.columns) {
          std::visit([&](auto const& values) { fmt::format_to(out, " {}", values[i]); }, rows.columns[column].values);
        }
        if (property.pads) text += " 0";
      }
      text += '\n';
    }
    return text;
  }

 private:
  FrameSource const& frame_;
  std::size_t x_;
  std::size_t y_;
  Kinds kinds_;
  std::vector<PropertyColumns> properties_;
};

/// Formats blocks on all cores and appends them in order, so that the bytes do not depend on the number of threads.
void append_blocks(Rows const& rows, AtomicFile& file) {
  constexpr std::size_t blocks_in_memory = 16;
  std::size_t next = 0;
  // An exception inside the pipeline would lose blocks in progress, so it is stored and thrown after the pipeline ends.
  std::exception_ptr failure;
  std::atomic<bool> has_failed = false;
  auto const append = [&](std::string const& text) {
    if (has_failed) return;
    try {
      file.append(text);
    } catch (...) {
      failure = std::current_exception();
      has_failed = true;
    }
  };
  auto const take_next = [&](tbb::flow_control& control) {
    std::size_t const first = std::min(next, rows.size());
    if (first == rows.size() || has_failed) control.stop();
    next += rows_per_block;
    return rows.block(first);
  };
  on_all_cores([&] {
    tbb::parallel_pipeline(blocks_in_memory,
                           tbb::make_filter<void, Frame>(tbb::filter_mode::serial_in_order, take_next) &
                               tbb::make_filter<Frame, std::string>(
                                   tbb::filter_mode::parallel, [&](Frame const& block) { return rows.text(block); }) &
                               tbb::make_filter<std::string, void>(tbb::filter_mode::serial_in_order, append));
  });
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

void append_xyz(FrameSource const& frame, AtomicFile& file) {
  Rows const rows(frame);
  file.append(rows.header());
  if (rows.size() <= rows_per_block) {
    file.append(rows.text(rows.block(0)));
  } else {
    append_blocks(rows, file);
  }
}

std::string xyz_text(FrameSource const& frame) {
  Rows const rows(frame);
  std::string text = rows.header();
  for (std::size_t first = 0; first < rows.size(); first += rows_per_block) text += rows.text(rows.block(first));
  return text;
}

void write_xyz(FrameSource const& frame, std::filesystem::path const& path) {
  AtomicFile file(path);
  append_xyz(frame, file);
  file.commit();
}

void write_xyz(State const& state, std::filesystem::path const& path) { write_xyz(*frame_source_of(state), path); }

}  // namespace gridlock
