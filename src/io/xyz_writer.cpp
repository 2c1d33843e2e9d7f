#include "io/xyz_writer.hpp"

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
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

/// The numbers of a column; none where it is missing or holds whole numbers.
std::span<double const> reals_of(Frame const& frame, std::string_view name) {
  FrameColumn const* const column = frame.find(name);
  if (column == nullptr || !is_real(*column)) return {};
  return std::get<std::vector<double>>(column->values);
}

/// The names of the kinds of agents: A, B, C … by species, or else by radius and mass, the smallest first.
class Kinds {
 public:
  explicit Kinds(Frame const& frame)
      : radii_(reals_of(frame, Radius::name)), masses_(reals_of(frame, Mass::name)), species_(frame.find("species")) {
    if (species_ != nullptr && is_real(*species_)) species_ = nullptr;
    if (species_ != nullptr) return;
    for (std::size_t i = 0; i < radii_.size() && kinds_.size() <= most; ++i) {
      if (!std::isnan(radii_[i])) kinds_.insert(kind_at(i));
    }
  }

  [[nodiscard]] char name_at(std::size_t i) const {
    if (species_ != nullptr) return name_of(species_at(i));
    if (radii_.empty()) return name_of(0);
    if (kinds_.size() > most) return too_many;
    auto const found = kinds_.find(kind_at(i));
    return found == kinds_.end() ? too_many : name_of(static_cast<std::uint64_t>(std::distance(kinds_.begin(), found)));
  }

 private:
  static constexpr std::size_t most = 20;
  static constexpr char too_many = 'X';
  static char name_of(std::uint64_t kind) { return kind < most ? static_cast<char>('A' + kind) : too_many; }

  [[nodiscard]] std::pair<double, double> kind_at(std::size_t i) const {
    return {radii_[i], masses_.empty() ? 0.0 : masses_[i]};
  }
  [[nodiscard]] std::uint64_t species_at(std::size_t i) const {
    return std::visit([i](auto const& numbers) { return static_cast<std::uint64_t>(numbers[i]); }, species_->values);
  }

  std::span<double const> radii_;
  std::span<double const> masses_;
  FrameColumn const* species_;
  std::set<std::pair<double, double>> kinds_;
};

/// A property of the format and the columns of the frame it holds.
struct PropertyColumns {
  std::string name;
  std::vector<FrameColumn const*> columns;
  bool pads = false;
};

/// Everything but type, position and id, in the order it is written.
std::vector<PropertyColumns> properties_of(Frame const& frame) {
  std::set<std::string_view> written{X::name, Y::name};
  std::vector<PropertyColumns> properties;
  for (xyz::PropertyName const& known : xyz::known_names()) {
    PropertyColumns property{known.name, {}, known.pads};
    for (std::string const& name : known.columns) {
      if (FrameColumn const* column = frame.find(name)) property.columns.push_back(column);
    }
    if (property.columns.size() != known.columns.size()) continue;
    written.insert(known.columns.begin(), known.columns.end());
    properties.push_back(std::move(property));
  }
  for (FrameColumn const& column : frame.columns) {
    if (!written.contains(column.name)) properties.push_back({column.name, {&column}, false});
  }
  return properties;
}

std::string header(Frame const& frame, std::vector<PropertyColumns> const& properties) {
  std::string names = "type:S:1:pos:R:3:id:I:1";
  for (PropertyColumns const& property : properties) {
    names += fmt::format(":{}:{}:{}", property.name, is_real(*property.columns.front()) ? 'R' : 'I',
                         property.columns.size() + (property.pads ? 1 : 0));
  }
  std::string_view const pbc = frame.box.is_periodic() ? "T T F" : "F F F";
  return fmt::format("{}\nLattice=\"{} 0 0 0 {} 0 0 0 1\" pbc=\"{}\" Properties={} Time={} step={} seed={}\n",
                     frame.size(), double_text(frame.box.width()), double_text(frame.box.height()), pbc, names,
                     double_text(frame.clock.time), frame.clock.step, frame.seed);
}

/// The rows of a frame as text.
class Rows {
 public:
  explicit Rows(Frame const& frame)
      : frame_(frame),
        x_(reals_of(frame, X::name)),
        y_(reals_of(frame, Y::name)),
        kinds_(frame),
        properties_(properties_of(frame)) {}

  [[nodiscard]] std::size_t size() const { return frame_.size(); }
  [[nodiscard]] std::string header() const { return gridlock::header(frame_, properties_); }

  [[nodiscard]] std::string text(std::size_t first, std::size_t end) const {
    std::string text;
    auto const out = std::back_inserter(text);
    for (std::size_t i = first; i < end; ++i) {
      fmt::format_to(out, "{} {} {} 0 {}", kinds_.name_at(i), x_[i], y_[i], frame_.ids[i]);
      for (PropertyColumns const& property : properties_) {
        for (FrameColumn const* column : property.columns) {
          std::visit([&](auto const& values) { fmt::format_to(out, " {}", values[i]); }, column->values);
        }
        if (property.pads) text += " 0";
      }
      text += '\n';
    }
    return text;
  }

 private:
  Frame const& frame_;
  std::span<double const> x_;
  std::span<double const> y_;
  Kinds kinds_;
  std::vector<PropertyColumns> properties_;
};

/// About 1 MB of text: long enough to be worth another thread.
constexpr std::size_t rows_per_block = 8192;

/// Formats the blocks on all cores and appends them in their order, so that the bytes are those of one thread.
void append_blocks(Rows const& rows, AtomicFile& file) {
  constexpr std::size_t blocks_in_memory = 16;
  std::size_t next = 0;
  auto const take_next = [&](tbb::flow_control& control) {
    std::size_t const first = next;
    if (first >= rows.size()) control.stop();
    next += rows_per_block;
    return first;
  };
  auto const format = [&](std::size_t first) {
    return rows.text(first, std::min(first + rows_per_block, rows.size()));
  };
  on_all_cores([&] {
    tbb::parallel_pipeline(
        blocks_in_memory, tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, take_next) &
                              tbb::make_filter<std::size_t, std::string>(tbb::filter_mode::parallel, format) &
                              tbb::make_filter<std::string, void>(tbb::filter_mode::serial_in_order,
                                                                  [&](std::string const& text) { file.append(text); }));
  });
}

}  // namespace

void append_xyz(Frame const& frame, AtomicFile& file) {
  Rows const rows(frame);
  file.append(rows.header());
  if (rows.size() <= rows_per_block) {
    file.append(rows.text(0, rows.size()));
  } else {
    append_blocks(rows, file);
  }
}

void write_xyz(Frame const& frame, std::filesystem::path const& path) {
  AtomicFile file(path);
  append_xyz(frame, file);
  file.commit();
}

void write_xyz(State const& state, std::filesystem::path const& path) { write_xyz(frame_of(state), path); }

}  // namespace gridlock
