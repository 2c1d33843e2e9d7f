#include "drawing/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "drawing/canvas.hpp"
#include "drawing/colour.hpp"
#include "drawing/field_picture.hpp"
#include "drawing/neighbourhood_colour.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

constexpr double reference_width = 720.0;  // width in pixels for which the sizes below are chosen
constexpr std::uint32_t min_pixels = 16;
constexpr std::uint32_t max_pixels = 16'384;
constexpr double narrowest_cell = 4.0;  // in pixels; lines of a finer grid would hide the disks
constexpr std::size_t max_species_colours = 6;
constexpr double tallest_picture = 2.0;  // maximum height over width, for tall boxes

constexpr Colour white{1.0, 1.0, 1.0};
constexpr Colour ink{0.13, 0.14, 0.16};
constexpr Colour unknown_value{0.75, 0.75, 0.75};

/// The range of numbers that a colour bar shows.
struct Scale {
  double min = 0.0;
  double max = 1.0;

  /// Returns the position on the scale, 0 at min, 1 at max. Halves avoid an overflow of the differences.
  [[nodiscard]] double place_of(double value) const { return (0.5 * value - 0.5 * min) / (0.5 * max - 0.5 * min); }
};

/// The positions of the parts of a picture, in pixels.
struct Arrangement {
  double unit = 1.0;    ///< pixels per pixel of a picture with reference_width
  double pixels = 1.0;  ///< pixels per unit of length of the box
  double width = 0.0;
  double height = 0.0;
  PixelRectangle box;
  PixelRectangle bar;
};

bool has_bar(Colouring colouring) { return colouring == Colouring::values || colouring == Colouring::directions; }

bool has_values(Colouring colouring) { return has_bar(colouring) || colouring == Colouring::kinds; }

/// An entry of the legend.
struct ColourName {
  Colour colour;
  std::string name;
};

constexpr double list_line = 22.0;  // distance between names of a list, in units

/// Returns the width of a list of names at the right of the picture, in units.
double list_width(std::vector<ColourName> const& names, std::string const& title) {
  constexpr double letter = 7.6;
  auto const letters = [](std::string const& text) {
    return static_cast<double>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
  };
  double most = letters(title) - 3.0;  // titles have no coloured square before them
  for (ColourName const& name : names) most = std::max(most, letters(name.name));
  return std::min(52.0 + letter * most, 0.4 * reference_width);
}

void check(State const& state, PictureSettings const& settings) {
  if (settings.width < min_pixels || settings.width > max_pixels) {
    throw Error({.what = fmt::format("a picture width of {} pixels cannot be drawn", settings.width),
                 .hint = fmt::format("use {} to {} pixels", min_pixels, max_pixels),
                 .key = "width"});
  }
  if (has_values(settings.colouring) && settings.values.size() != state.agents.size()) {
    throw Error({.what = fmt::format("{} values to colour {} disks by", settings.values.size(), state.agents.size()),
                 .hint = "give one value for each disk"});
  }
}

Arrangement arrange(Box const& box, PictureSettings const& settings, std::vector<ColourName> const& names) {
  Arrangement a;
  a.width = settings.width;
  a.unit = a.width / reference_width;
  double const margin = 14.0 * a.unit;
  double const top = settings.title.empty() ? margin : 46.0 * a.unit;
  double const beside = names.empty() ? 100.0 : list_width(names, settings.bar_label);
  bool const has_side = has_bar(settings.colouring) || !names.empty();
  double const right = has_side ? beside * a.unit : margin;
  double const room = a.width - margin - right;
  double const max_height = tallest_picture * a.width - top - margin;
  a.pixels = std::min(room / box.width(), std::max(1.0, max_height) / box.height());
  a.box = {.width = a.pixels * box.width(), .height = a.pixels * box.height()};
  double const min_height = has_side ? 160.0 * a.unit : 0.0;
  double const content = std::max(a.box.height, min_height);
  a.height = std::max(1.0, std::round(top + content + margin));
  a.box.x = margin + 0.5 * (room - a.box.width);
  a.box.y = top + 0.5 * (a.height - top - margin - a.box.height);
  a.bar = {.x = a.box.x + a.box.width + 18.0 * a.unit,
           .y = top + 4.0 * a.unit,
           .width = 16.0 * a.unit,
           .height = std::max(1.0, a.height - top - margin - 8.0 * a.unit)};
  return a;
}

/// Determines the colour of each disk.
class DiskColours {
 public:
  DiskColours(State const& state, PictureSettings const& settings) : state_(state), settings_(settings) {
    if (has_values(settings.colouring)) {
      values_.assign(settings.values.begin(), settings.values.end());
    } else if (settings.colouring == Colouring::radius) {
      find_radii();
    }
    if (has_bar(settings.colouring)) find_scale();
  }

  [[nodiscard]] Scale const& scale() const { return scale_; }
  /// Returns the colour at a position on the bar, from 0 to 1.
  [[nodiscard]] Colour on_bar(double place) const {
    return settings_.colouring == Colouring::directions ? colour_circle(place) : viridis(place);
  }

  /// Returns the entries of the legend: distinct radii, or kinds; none for other colourings.
  [[nodiscard]] std::vector<ColourName> names() const {
    std::vector<ColourName> names;
    if (settings_.colouring == Colouring::radius && radii_.size() > 1 && radii_.size() <= max_species_colours) {
      for (double const radius : radii_) names.push_back({of_radius(radius), fmt::format("R = {:.4g}", radius)});
    }
    if (settings_.colouring != Colouring::kinds) return names;
    double last = settings_.max.value_or(0.0);
    for (double const value : values_) last = std::max(last, value);
    std::size_t const count = std::max(settings_.kind_names.size(), static_cast<std::size_t>(last) + 1);
    for (std::size_t kind = 0; kind < std::min(count, max_kinds); ++kind) {
      bool const is_named = kind < settings_.kind_names.size();
      names.push_back(
          {of_kind(static_cast<double>(kind)), is_named ? settings_.kind_names[kind] : std::to_string(kind)});
    }
    return names;
  }

  [[nodiscard]] Colour of(std::size_t i) const {
    switch (settings_.colouring) {
      case Colouring::radius:
        return of_radius(state_.agents.column<Radius>()[i]);
      case Colouring::neighbourhood:
        return of_cell(position(state_.agents, i));
      case Colouring::kinds:
        return of_kind(values_[i]);
      case Colouring::values:
      case Colouring::directions:
        break;
    }
    return std::isfinite(values_[i]) ? on_bar(scale_.place_of(values_[i])) : unknown_value;
  }

 private:
  void find_radii() {
    auto const radii = state_.agents.column<Radius>();
    radii_.assign(radii.begin(), radii.end());
    std::erase_if(radii_, [](double r) { return !std::isfinite(r); });
    std::ranges::sort(radii_);
    radii_.erase(std::unique(radii_.begin(), radii_.end()), radii_.end());
    if (!radii_.empty()) scale_ = widened({radii_.front(), radii_.back()});
  }

  void find_scale() {
    Scale range{.min = 0.0, .max = -HUGE_VAL};
    for (double const value : values_) {
      if (!std::isfinite(value)) continue;
      range.min = std::min(range.min, value);
      range.max = std::max(range.max, value);
    }
    if (!(range.max >= range.min)) range = {};
    if (settings_.colouring == Colouring::directions) range = {.min = -std::numbers::pi, .max = std::numbers::pi};
    scale_ = widened({settings_.min.value_or(range.min), settings_.max.value_or(range.max)});
  }

  /// Returns a scale whose max is above min, also if all values are equal.
  static Scale widened(Scale scale) {
    double const size = std::max(std::abs(scale.min), std::abs(scale.max));
    if (!(scale.max - scale.min > 1e-6 * size)) scale.max = scale.min + std::max(1.0, std::abs(scale.min));
    return scale;
  }

  [[nodiscard]] Colour of_radius(double radius) const {
    if (!std::isfinite(radius)) return unknown_value;
    if (radii_.size() > max_species_colours) return viridis(scale_.place_of(radius));
    auto const kind = std::ranges::lower_bound(radii_, radius) - radii_.begin();
    return mixed(categorical_colours()[static_cast<std::size_t>(kind)], white, 0.35);
  }

  [[nodiscard]] static Colour of_kind(double kind) {
    if (!(kind >= 0.0) || kind >= static_cast<double>(max_kinds)) return unknown_value;
    return mixed(categorical_colours()[static_cast<std::size_t>(kind)], white, 0.15);
  }

  [[nodiscard]] Colour of_cell(Vector p) const {
    static std::array<Colour, neighbourhood_colours> const colours = neighbourhood_palette();
    auto const count = [](std::uint64_t cells) {
      return static_cast<int>(std::clamp<std::uint64_t>(cells, 1, std::numeric_limits<int>::max()));
    };
    int const columns = count(settings_.columns);
    int const rows = count(settings_.rows);
    auto const index = [](double x, double side, int cells) {
      return static_cast<int>(std::clamp(x * (cells / side), 0.0, cells - 1.0));
    };
    Box const& box = state_.box;
    int const colour = neighbourhood_colour(index(p.x, box.width(), columns), index(p.y, box.height(), rows), columns,
                                            rows, box.is_periodic_x(), box.is_periodic_y());
    return colours[static_cast<std::size_t>(colour)];
  }

  /// The first four colours, those of a grid with even numbers of cells, are the easiest to distinguish.
  static std::array<Colour, neighbourhood_colours> neighbourhood_palette() {
    auto const c = categorical_colours();
    Colour const blue = mixed(c[0], white, 0.25), orange = mixed(c[4], white, 0.15), green = mixed(c[2], white, 0.2);
    Colour const purple = mixed(c[3], white, 0.1), vermilion = mixed(c[1], white, 0.1), sky = mixed(c[5], white, 0.2);
    Colour const grey{0.55, 0.55, 0.55}, yellow = c[7], brown{0.45, 0.26, 0.18};
    return {blue, orange, vermilion, green, purple, sky, yellow, grey, brown};
  }

  State const& state_;
  PictureSettings const& settings_;
  std::vector<double> values_;
  std::vector<double> radii_;
  Scale scale_;
};

class Picture {
 public:
  Picture(State const& state, PictureSettings const& settings)
      : state_(state),
        settings_(settings),
        colours_(state, settings),
        names_(colours_.names()),
        at_(arrange(state.box, settings, names_)) {}

  [[nodiscard]] Arrangement const& arrangement() const { return at_; }

  void draw_background(Canvas& canvas) const {
    canvas.fill({.width = at_.width, .height = at_.height}, white);
    if (settings_.field != nullptr)
      draw_field(*settings_.field, settings_.field_min, settings_.field_max, at_.box, canvas);
    if (settings_.title.empty()) return;
    canvas.text({at_.box.x + 0.5 * at_.box.width, 30.0 * at_.unit}, settings_.title,
                {.size = 18.0 * at_.unit, .anchor = TextAnchor::middle, .colour = ink});
  }

  void draw_disks(Canvas& canvas) const {
    for (std::size_t i = 0; i < state_.agents.size(); ++i) {
      double const radius = state_.agents.column<Radius>()[i] * at_.pixels;
      for_each_image(i, [&](Vector centre) {
        canvas.circle(to_pixels(centre), radius, colours_.of(i));
        if (settings_.headings.empty()) return;
        Vector const dot = 0.6 * state_.agents.column<Radius>()[i] * settings_.headings[i];
        canvas.circle(to_pixels(centre + dot), 0.25 * radius, ink);
      });
    }
  }

  void draw_frame(Canvas& canvas) const {
    draw_grid(canvas);
    draw_inner_walls(canvas);
    // The line lies outside the box, so that a disk at a wall visibly touches the line without an overlap.
    if (state_.box.edge_x() == state_.box.edge_y()) {
      Stroke const stroke = stroke_of(state_.box.is_periodic());
      PixelRectangle const around{at_.box.x - 0.5 * stroke.width, at_.box.y - 0.5 * stroke.width,
                                  at_.box.width + stroke.width, at_.box.height + stroke.width};
      canvas.outline(around, stroke);
    } else {
      draw_borders_of_axes(canvas);
    }
    if (has_bar(settings_.colouring)) draw_bar(canvas);
    draw_names(canvas);
  }

 private:
  [[nodiscard]] Vector to_pixels(Vector p) const {
    return {at_.box.x + p.x * at_.pixels, at_.box.y + at_.box.height - p.y * at_.pixels};
  }

  /// Calls visit(centre) for every periodic image of disk i that overlaps the box.
  template <class Visit>
  void for_each_image(std::size_t i, Visit visit) const {
    Vector const p = position(state_.agents, i);
    double const r = state_.agents.column<Radius>()[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !(r > 0.0) || !std::isfinite(r)) return;
    if (!state_.box.has_images()) return visit(p);
    auto const reaches = [r](double x, double side) { return x + r > 0.0 && x - r < side; };
    for (int const row : {-1, 0, 1}) {
      if (row != 0 && !state_.box.is_periodic_y()) continue;
      for (int const column : {-1, 0, 1}) {
        if (column != 0 && !state_.box.is_periodic_x()) continue;
        Vector const image = p + state_.box.offset_of_image(column, row);
        bool const is_original = row == 0 && column == 0;
        if (is_original || (reaches(image.x, state_.box.width()) && reaches(image.y, state_.box.height())))
          visit(image);
      }
    }
  }

  [[nodiscard]] Stroke stroke_of(bool is_periodic) const {
    return {.colour = ink, .width = (is_periodic ? 1.2 : 4.0) * at_.unit, .is_dashed = is_periodic};
  }

  /// Draws the walls of one axis, whose ends cover the corners, and the dashed edges of the other.
  void draw_borders_of_axes(Canvas& canvas) const {
    PixelRectangle const& b = at_.box;
    Stroke const beside = stroke_of(state_.box.is_periodic_x());
    Stroke const above = stroke_of(state_.box.is_periodic_y());
    double const out_x = 0.5 * beside.width;
    double const out_y = 0.5 * above.width;
    for (double const x : {b.x - out_x, b.x + b.width + out_x}) canvas.line({x, b.y}, {x, b.y + b.height}, beside);
    for (double const y : {b.y - out_y, b.y + b.height + out_y}) canvas.line({b.x, y}, {b.x + b.width, y}, above);
  }

  void draw_grid(Canvas& canvas) const {
    auto const columns = static_cast<double>(settings_.columns);
    auto const rows = static_cast<double>(settings_.rows);
    if (columns == 0.0 || rows == 0.0) return;
    if (at_.box.width / columns < narrowest_cell || at_.box.height / rows < narrowest_cell) return;
    Stroke const stroke{.colour = ink, .width = 1.1 * at_.unit, .opacity = 0.7};
    PixelRectangle const& b = at_.box;
    for (std::uint64_t c = 1; c < settings_.columns; ++c) {
      double const x = b.x + b.width * static_cast<double>(c) / columns;
      canvas.line({x, b.y}, {x, b.y + b.height}, stroke);
    }
    for (std::uint64_t r = 1; r < settings_.rows; ++r) {
      double const y = b.y + b.height * static_cast<double>(r) / rows;
      canvas.line({b.x, y}, {b.x + b.width, y}, stroke);
    }
  }

  /// Draws walls that disks meet on both sides, thinner than those of the box, so that a disk visibly touches them.
  void draw_inner_walls(Canvas& canvas) const {
    Stroke const stroke{.colour = ink, .width = 2.4 * at_.unit};
    for (LineSegment const& wall : settings_.walls) {
      canvas.line(to_pixels(wall.from), to_pixels(wall.to), stroke);
    }
  }

  void draw_bar(Canvas& canvas) const {
    constexpr int bands = 128;
    PixelRectangle const& bar = at_.bar;
    for (int i = 0; i < bands; ++i) {
      // Each band extends to the bottom of the bar under the next bands, so that no seams are visible.
      double const below = bar.height * i / bands;
      canvas.fill({bar.x, bar.y, bar.width, bar.height - below}, colours_.on_bar((i + 0.5) / bands));
    }
    Stroke const thin{.colour = ink, .width = 1.0 * at_.unit};
    canvas.outline(bar, thin);
    Scale const& scale = colours_.scale();
    auto const draw_tick = [&](double place, std::string const& text) {
      double const y = bar.y + bar.height * (1.0 - place);
      canvas.line({bar.x + bar.width, y}, {bar.x + bar.width + 4.0 * at_.unit, y}, thin);
      canvas.text({bar.x + bar.width + 7.0 * at_.unit, y + 4.5 * at_.unit}, text,
                  {.size = 13.0 * at_.unit, .colour = ink});
    };
    if (settings_.colouring == Colouring::directions) {
      double place = 0.0;
      for (char const* const angle : {"−π", "−π/2", "0", "π/2", "π"})
        draw_tick(std::exchange(place, place + 0.25), angle);
    } else {
      double const step = tick_step(scale);
      double const first = std::ceil(scale.min / step - 1e-9);
      for (double n = first; n * step <= scale.max + 1e-9 * step; ++n) {
        draw_tick(scale.place_of(n * step), fmt::format("{:.6g}", n * step + 0.0));  // + 0.0 turns −0 into 0
      }
    }
    canvas.text({bar.x + 74.0 * at_.unit, bar.y + 0.5 * bar.height}, settings_.bar_label,
                {.size = 15.0 * at_.unit, .anchor = TextAnchor::middle, .is_upright = true, .colour = ink});
  }

  /// Draws the legend.
  void draw_names(Canvas& canvas) const {
    double const square = 13.0 * at_.unit;
    double const x = at_.box.x + at_.box.width + 16.0 * at_.unit;
    double y = at_.bar.y + 6.0 * at_.unit;
    Lettering const letters{.size = 13.0 * at_.unit, .colour = ink};
    if (!names_.empty() && !settings_.bar_label.empty()) {
      canvas.text({x, y + 0.85 * square}, settings_.bar_label, letters);
      y += list_line * at_.unit;
    }
    for (ColourName const& name : names_) {
      canvas.fill({x, y, square, square}, name.colour);
      canvas.text({x + square + 7.0 * at_.unit, y + 0.85 * square}, name.name, letters);
      y += list_line * at_.unit;
    }
  }

  /// Returns the distance of ticks, 1, 2 or 5 times a power of ten, for about five ticks.
  static double tick_step(Scale const& scale) {
    double const rough = scale.max / 5.0 - scale.min / 5.0;
    double const power = std::pow(10.0, std::floor(std::log10(rough)));
    double const share = rough / power;
    return power * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
  }

  State const& state_;
  PictureSettings const& settings_;
  DiskColours colours_;
  std::vector<ColourName> names_;
  Arrangement at_;
};

void draw(Picture const& picture, Canvas& canvas) {
  picture.draw_background(canvas);
  canvas.begin_clip(picture.arrangement().box);
  picture.draw_disks(canvas);
  canvas.end_clip();
  picture.draw_frame(canvas);
}

}  // namespace

void draw_picture(State const& state, PictureSettings const& settings, Canvas& canvas) {
  check(state, settings);
  draw(Picture(state, settings), canvas);
}

PicturePixels picture_pixels(State const& state, PictureSettings const& settings) {
  check(state, settings);
  Picture const picture(state, settings);
  PixelCanvas canvas(picture.arrangement().width, picture.arrangement().height);
  draw(picture, canvas);
  return {.width = canvas.width(), .height = canvas.height(), .bytes = canvas.pixels()};
}

}  // namespace gridlock
