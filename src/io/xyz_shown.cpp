#include "io/xyz_shown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "io/text.hpp"
#include "io/xyz_columns.hpp"
#include "io/xyz_header.hpp"
#include "io/xyz_lines.hpp"
#include "io/xyz_names.hpp"
#include "io/xyz_reader.hpp"

namespace gridlock::xyz {

namespace {

std::vector<double> numbered(std::vector<std::string> const& words) {
  std::set<std::string> const names(words.begin(), words.end());
  std::map<std::string, double> places;
  for (std::string const& name : names) places.emplace(name, static_cast<double>(places.size()));
  std::vector<double> numbers;
  numbers.reserve(words.size());
  for (std::string const& word : words) numbers.push_back(places[word]);
  return numbers;
}

/// Returns the columns of plain XYZ: a word and two or three coordinates.
Columns plain_columns(Lines const& lines, std::size_t words) {
  return read_columns(lines,
                      {.key = "Properties", .value = words >= 4 ? "species:S:1:pos:R:3" : "species:S:1:pos:R:2"});
}

class ShownReader {
 public:
  explicit ShownReader(Lines& lines) : lines_(lines) {}

  ShownFrame read() {
    std::uint64_t const count = read_count(lines_);
    header_ = read_header(lines_);
    read_rows(count);
    ShownFrame frame = head();
    std::array<std::vector<double>, 2> place{take(Role::x), take(Role::y)};
    if (place[0].size() != count || place[1].size() != count) {
      lines_.refuse("the file has no positions: no pos among the Properties", "add pos:R:3 and the columns");
    }
    put_into_box(frame, place);
    frame.ids = ids(count);
    add_notes(frame);
    add_columns(frame, place);
    return frame;
  }

  ShownFrame read_head() {
    read_count(lines_);
    header_ = read_header(lines_);
    return head();
  }

 private:
  [[nodiscard]] ShownFrame head() const {
    ShownFrame frame;
    if (header_.step) frame.step = static_cast<double>(*header_.step);
    frame.time = header_.time;
    return frame;
  }

  void read_rows(std::uint64_t count) {
    std::vector<Word> words;
    for (std::uint64_t row = 0; row < count; ++row) {
      if (!lines_.next()) {
        lines_.refuse(fmt::format("the file ends after {} of {} agents", row, count), "is the file cut off?");
      }
      split(lines_.line(), words);
      if (row == 0) set_columns(words.size());
      read_row(words);
    }
    if (count == 0) set_columns(0);
  }

  void set_columns(std::size_t words) {
    columns_ = header_.columns ? *header_.columns : plain_columns(lines_, words);
    texts_.resize(columns_->roles.size());
    numbers_.resize(columns_->roles.size());
  }

  void read_row(std::vector<Word> const& words) {
    std::size_t const width = columns_->roles.size();
    // Lines of plain XYZ may have further columns.
    bool const is_right = header_.columns ? words.size() == width : words.size() >= width;
    if (!is_right) {
      lines_.refuse(fmt::format("the line has {} columns, but must have {}", words.size(), width),
                    "is the line cut off?", words.empty() ? 0 : words.back().column);
    }
    for (Property const& property : columns_->properties) {
      for (std::size_t c = property.first; c < property.first + property.width; ++c) {
        if (property.type == 'S') {
          texts_[c].emplace_back(words[c].text);
        } else if (property.is_used) {
          numbers_[c].push_back(finite_number(lines_, words[c], columns_->roles[c]));
        } else {
          numbers_[c].push_back(any_number(words[c].text));
        }
      }
    }
  }

  /// Returns the values of the column with a role; none if the file does not have it.
  [[nodiscard]] std::vector<double> take(Role role) const {
    if (!columns_) return {};
    auto const found = std::ranges::find(columns_->roles, role);
    if (found == columns_->roles.end()) return {};
    return numbers_[static_cast<std::size_t>(found - columns_->roles.begin())];
  }

  [[nodiscard]] std::vector<double> ids(std::uint64_t count) const {
    if (columns_->has(Role::id)) return take(Role::id);
    std::vector<double> ids(count);
    for (std::size_t row = 0; row < ids.size(); ++row) ids[row] = static_cast<double>(row);
    return ids;
  }

  void put_into_box(ShownFrame& frame, std::array<std::vector<double>, 2>& place) const {
    if (!header_.sides) return;
    frame.sides = {header_.sides->width, header_.sides->height};
    frame.is_periodic = header_.is_periodic;
    if (frame.is_periodic[0] && frame.is_periodic[1]) frame.shift = header_.sides->shift;
    auto& [x, y] = place;
    for (std::size_t row = 0; row < x.size(); ++row) {
      x[row] -= header_.origin.x;
      y[row] -= header_.origin.y;
      if (header_.is_periodic[1]) x[row] -= frame.shift * fold(y[row], header_.sides->height);
      if (header_.is_periodic[0]) fold(x[row], header_.sides->width);
    }
  }

  void add_columns(ShownFrame& frame, std::array<std::vector<double>, 2>& place) {
    std::vector<double> const mass = take(Role::mass);
    for (Property const& property : columns_->properties) {
      for (std::size_t c = property.first; c < property.first + property.width; ++c) {
        Role const role = columns_->roles[c];
        std::vector<double> values = property.type == 'S' ? numbered(texts_[c]) : std::move(numbers_[c]);
        if (role == Role::x) values = std::move(place[0]);
        if (role == Role::y) values = std::move(place[1]);
        bool const is_momentum = role == Role::momentum_x || role == Role::momentum_y;
        for (std::size_t row = 0; row < values.size(); ++row) {
          if (is_momentum && !mass.empty()) values[row] /= mass[row];
          if (role == Role::diameter) values[row] *= 0.5;
        }
        std::string name = name_in_frame(property, c);
        if (!name.empty()) frame.columns.push_back({std::move(name), std::move(values)});
      }
    }
  }

  /// Returns the name of a column in the frame; empty for columns that are not shown: Id, z, and third components.
  [[nodiscard]] std::string name_in_frame(Property const& property, std::size_t column) const {
    if (property.is_used) return std::string(column_of(columns_->roles[column]));
    if (property.width == 1) return column_name(property.name);
    std::size_t const component = column - property.first;
    constexpr std::array<char const*, 2> axes{"_x", "_y"};
    return component < axes.size() ? property.name + axes[component] : "";
  }

  static std::string_view column_of(Role role) {
    switch (role) {
      case Role::x:
        return "x";
      case Role::y:
        return "y";
      case Role::velocity_x:
      case Role::momentum_x:
        return "velocity_x";
      case Role::velocity_y:
      case Role::momentum_y:
        return "velocity_y";
      case Role::radius:
      case Role::diameter:
        return "radius";
      case Role::mass:
        return "mass";
      case Role::image_x:
        return "image_x";
      case Role::image_y:
        return "image_y";
      default:
        return "";
    }
  }

  void add_notes(ShownFrame& frame) const {
    auto const note = [&](std::string text) { frame.notes.push_back(std::move(text)); };
    if (!header_.sides && header_.columns)
      note("The file gives no Lattice: the box is the rectangle around the agents.");
    std::vector<double> const heights = take(Role::z);
    double const longest = header_.sides ? std::max(header_.sides->width, header_.sides->height) : 0.0;
    if (std::ranges::any_of(heights, [&](double z) { return std::abs(z) > 1e-12 * longest; })) {
      note("The file is one of space: it is shown from above, without z.");
    }
    if (columns_->has_momenta && !columns_->has(Role::mass)) {
      note("The file has momenta and no masses: velocities are those of masses of 1.");
    }
  }

  Lines& lines_;
  Header header_;
  std::optional<Columns> columns_;
  std::vector<std::vector<std::string>> texts_;  ///< values of columns of words, by column
  std::vector<std::vector<double>> numbers_;     ///< values of columns of numbers, by column
};

}  // namespace

ShownFrame read_shown(TextReader text, int first_line) {
  Lines lines(std::move(text), first_line);
  return ShownReader(lines).read();
}

ShownFrame read_shown_head(TextReader text, int first_line) {
  Lines lines(std::move(text), first_line);
  return ShownReader(lines).read_head();
}

}  // namespace gridlock::xyz
