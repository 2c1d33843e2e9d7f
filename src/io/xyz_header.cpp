#include "io/xyz_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/text.hpp"

namespace gridlock::xyz {

namespace {

[[noreturn]] void refuse_entry(Lines const& lines, Entry const& entry, std::string_view expected) {
  lines.refuse(fmt::format("{} is {}, but must be {}", entry.key, in_quotes(entry.value), expected), "", entry.column);
}

/// Returns the numbers of a vector or matrix; none if an element is not a finite number.
std::vector<double> numbers_of(std::string_view value) {
  std::vector<double> numbers;
  for (std::string const& element : elements_of(value).value_or(std::vector<std::string>())) {
    auto const number = real_number(element);
    if (!number || !std::isfinite(*number)) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

/// Returns a whole number, also if it is written as 100.0 or 1e3.
std::optional<std::uint64_t> whole_number(std::string_view word) {
  if (auto const number = parse_number<std::uint64_t>(word)) return number;
  auto const real = real_number(word);
  constexpr double end_of_exact = 9007199254740992.0;
  if (!real || !(*real >= 0.0 && *real <= end_of_exact) || *real != std::floor(*real)) return std::nullopt;
  return static_cast<std::uint64_t>(*real);
}

/// Returns whether a value is a rounding error of 0, which programs that rotate boxes leave.
bool is_rounding(double value, double side) { return std::abs(value) <= 1e-12 * side; }

/// Throws an Error about a box whose first side does not lie along x.
[[noreturn]] void refuse_sides(Lines const& lines, Entry const& entry, std::vector<double> const& lattice) {
  lines.refuse(fmt::format("the side ({}, {}) of the Lattice does not lie along x", lattice[0], lattice[1]),
               "the box must be a rectangle, width 0 0 0 height 0 0 0 1, or a sheared one, width 0 0 xy height 0 0 0 1",
               entry.column);
}

Sides read_sides(Lines const& lines, Entry const& entry) {
  std::size_t const count = elements_of(entry.value).value_or(std::vector<std::string>()).size();
  if (count != 9 && count != 3) refuse_entry(lines, entry, "nine numbers");
  std::vector<double> lattice = numbers_of(entry.value);
  if (lattice.size() == 3) lattice = {lattice[0], 0, 0, 0, lattice[1], 0, 0, 0, lattice[2]};
  if (lattice.size() != 9) refuse_entry(lines, entry, "nine finite numbers");
  double const longest = std::max(std::hypot(lattice[0], lattice[1]), std::hypot(lattice[3], lattice[4]));
  if (!is_rounding(lattice[1], longest)) refuse_sides(lines, entry, lattice);
  Sides sides{.width = lattice[0], .height = lattice[4]};
  if (!(sides.width > 0.0 && sides.height > 0.0)) {
    lines.refuse(fmt::format("the box of {} × {} has no area", sides.width, sides.height), "both sides must be above 0",
                 entry.column);
  }
  if (!is_rounding(lattice[3], longest)) sides.shift = lattice[3];
  for (std::size_t const i : {2, 5, 6, 7}) {
    if (!is_rounding(lattice[i], std::max(longest, std::abs(lattice[8])))) sides.leans = true;
  }
  return sides;
}

std::array<bool, 2> read_periodic(Lines const& lines, Entry const& entry) {
  std::vector<bool> periodic;
  auto const words = elements_of(entry.value).value_or(std::vector<std::string>());
  for (std::string const& word : words) {
    if (auto const is_periodic = truth(word)) periodic.push_back(*is_periodic);
  }
  if (words.empty() || words.size() > 3 || periodic.size() != words.size()) {
    refuse_entry(lines, entry, "\"T T F\", \"F F F\" or \"T F F\"");
  }
  return {periodic[0], periodic.size() > 1 ? periodic[1] : periodic[0]};
}

/// Reads the entries of the second line into a Header.
class HeaderReader {
 public:
  explicit HeaderReader(Lines const& lines) : lines_(lines) {}

  Header read() {
    header_.entries = entries_of_any();
    if (auto const* lattice = header_.entry("Lattice")) header_.sides = read_sides(lines_, *lattice);
    if (auto const* properties = header_.entry("Properties")) header_.columns = read_columns(lines_, *properties);
    header_.is_periodic.fill(header_.sides.has_value());
    // In plain XYZ these names may have other meanings, so they are ignored.
    if (header_.sides || header_.columns) {
      if (auto const* pbc = header_.entry("pbc")) header_.is_periodic = read_periodic(lines_, *pbc);
      if (auto const* origin = header_.entry("Origin")) read_origin(*origin);
    }
    read_clock();
    return std::move(header_);
  }

 private:
  /// Returns the entries; none for a malformed comment line of plain XYZ, whose content is free.
  [[nodiscard]] std::vector<Entry> entries_of_any() const {
    try {
      return entries_of(lines_);
    } catch (Error const&) {
      bool const is_extended = lines_.line().find("Lattice") != std::string_view::npos ||
                               lines_.line().find("Properties") != std::string_view::npos;
      if (is_extended) throw;
      return {};
    }
  }

  void read_origin(Entry const& entry) {
    std::vector<double> const origin = numbers_of(entry.value);
    if (origin.size() != 2 && origin.size() != 3) refuse_entry(lines_, entry, "three finite numbers");
    header_.origin = {origin[0], origin[1]};
  }

  /// Reads time, step and seed. Another program's value, such as a date, is left unused if it is unsuitable.
  void read_clock() {
    if (auto const* time = any_case("time")) {
      header_.time = real_number(time->value);
      if (header_.time && !std::isfinite(*header_.time)) header_.time.reset();
      if (!header_.time) leave_out(*time);
    }
    if (auto const* step = any_case("step")) {
      header_.step = whole_number(step->value);
      if (!header_.step) leave_out(*step);
    }
    if (auto const* seed = any_case("seed")) {
      header_.seed = whole_number(seed->value);
      if (!header_.seed) leave_out(*seed);
    }
  }

  void leave_out(Entry const& entry) {
    header_.unused_entries.push_back(fmt::format("{}={}", entry.key, cut(entry.value, 60)));
  }

  /// Returns the entry with a key in Gridlock's spelling, or else in any mixture of lower and upper case.
  [[nodiscard]] Entry const* any_case(std::string_view key) const {
    std::string ours(key);
    if (key == "time") ours = "Time";
    if (auto const* entry = header_.entry(ours)) return entry;
    auto const is_same = [&](Entry const& entry) {
      return std::ranges::equal(entry.key, key, {}, [](char c) { return std::tolower(static_cast<unsigned char>(c)); });
    };
    auto const found = std::ranges::find_if(header_.entries, is_same);
    return found == header_.entries.end() ? nullptr : &*found;
  }

  Lines const& lines_;
  Header header_;
};

/// Returns a hint about a missing key. If the file has the key in other case, the hint shows the correct spelling.
std::string hint_of_missing(Header const& header, std::string_view key, std::string hint) {
  for (Entry const& entry : header.entries) {
    bool const is_alike = std::ranges::equal(entry.key, key, [](char a, char b) {
      return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    });
    if (is_alike) return fmt::format("it gives {}; write {}", entry.key, key);
  }
  return hint;
}

}  // namespace

double fold(double& place, double side) {
  if (place >= 0.0 && place < side) return 0.0;
  double turns = std::floor(place / side);
  double inside = place - turns * side;
  if (inside < 0.0) {
    inside += side;
    turns -= 1.0;
  }
  // The sum of a tiny negative position and the side may round to the side, which is outside the box.
  if (inside >= side) {
    inside = 0.0;
    turns += 1.0;
  }
  place = inside;
  return turns;
}

Entry const* Header::entry(std::string_view key) const {
  auto const found = std::find_if(entries.rbegin(), entries.rend(), [&](Entry const& one) { return one.key == key; });
  return found == entries.rend() ? nullptr : &*found;
}

Header read_header(Lines& lines) {
  if (!lines.next()) {
    lines.go_behind_the_last();
    lines.refuse("the file ends before the line of the box and the columns",
                 "the second line needs Lattice=\"…\" and Properties=…");
  }
  return HeaderReader(lines).read();
}

Box box_of_disks(Lines const& lines, Header const& header) {
  if (!header.sides) {
    lines.refuse("the second line gives no Lattice",
                 hint_of_missing(header, "Lattice", "add Lattice=\"width 0 0 0 height 0 0 0 1\""));
  }
  int const lattice = header.entry("Lattice")->column;
  if (header.sides->leans) {
    lines.refuse(fmt::format("the Lattice {} leans out of the plane", in_quotes(header.entry("Lattice")->value)),
                 "only boxes in the plane can be simulated: width 0 0 0 height 0 0 0 1", lattice);
  }
  if (!header.columns) {
    lines.refuse("the second line gives no Properties",
                 hint_of_missing(header, "Properties", "add Properties=species:S:1:pos:R:3:radius:R:1"));
  }
  if (!header.columns->has(Role::x)) {
    lines.refuse("the file has no positions: no pos among the Properties", "add pos:R:3 and the columns",
                 header.entry("Properties")->column);
  }
  auto const edge = [](bool is_periodic) { return is_periodic ? Edge::periodic : Edge::wall; };
  Box const rectangle(header.sides->width, header.sides->height, edge(header.is_periodic[0]),
                      edge(header.is_periodic[1]));
  if (header.sides->shift != 0.0 && !rectangle.is_periodic()) {
    lines.refuse(fmt::format("the box has the shift {:.6g} and walls", header.sides->shift),
                 "only a box that is periodic along x and y can be oblique: pbc=\"T T F\"", lattice);
  }
  try {
    return rectangle.shifted(header.sides->shift);
  } catch (Error const& error) {
    lines.refuse(error.problems().front().what,
                 "its images are those of a box with a shift below half of the width: give that", lattice);
  }
}

}  // namespace gridlock::xyz
