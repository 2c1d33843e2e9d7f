#include "drawing/canvas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gridlock/core/error.hpp"
#include "io/utf8.hpp"

namespace gridlock {

namespace {

constexpr char const* cairo_font = "sans-serif";
constexpr double dash = 6.0;
constexpr double gap = 4.0;
constexpr double pi = 3.14159265358979323846;

void require(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw RunFailure(fmt::format("the picture could not be drawn: {}", cairo_status_to_string(status)));
  }
}

}  // namespace

PixelCanvas::PixelCanvas(double width, double height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, std::max(1, static_cast<int>(std::lround(width))),
                                          std::max(1, static_cast<int>(std::lround(height))))) {
  require(cairo_surface_status(surface_.get()));
  context_.reset(cairo_create(surface_.get()));
  require(cairo_status(context_.get()));
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_MITER);
}

void PixelCanvas::use(Colour colour, double opacity) const {
  cairo_set_source_rgba(context_.get(), colour.red, colour.green, colour.blue, opacity);
}

void PixelCanvas::apply(Stroke const& stroke) const {
  use(stroke.colour, stroke.opacity);
  cairo_set_line_width(context_.get(), stroke.width);
  double const dashes[] = {dash * stroke.width, gap * stroke.width};
  cairo_set_dash(context_.get(), dashes, stroke.is_dashed ? 2 : 0, 0.0);
}

void PixelCanvas::fill(PixelRectangle const& r, Colour colour) {
  use(colour);
  cairo_rectangle(context_.get(), r.x, r.y, r.width, r.height);
  cairo_fill(context_.get());
}

void PixelCanvas::outline(PixelRectangle const& r, Stroke const& stroke) {
  apply(stroke);
  cairo_rectangle(context_.get(), r.x, r.y, r.width, r.height);
  cairo_stroke(context_.get());
}

void PixelCanvas::line(Vector from, Vector to, Stroke const& stroke) {
  apply(stroke);
  cairo_move_to(context_.get(), from.x, from.y);
  cairo_line_to(context_.get(), to.x, to.y);
  cairo_stroke(context_.get());
}

void PixelCanvas::text(Vector at, std::string_view text, Lettering const& lettering) {
  cairo_t* const context = context_.get();
  std::string const line = one_line(text);
  cairo_save(context);
  cairo_select_font_face(context, cairo_font, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, lettering.size);
  cairo_text_extents_t extents;
  cairo_text_extents(context, line.c_str(), &extents);
  double const shift = lettering.anchor == TextAnchor::start    ? 0.0
                       : lettering.anchor == TextAnchor::middle ? 0.5 * extents.x_advance
                                                                : extents.x_advance;
  cairo_translate(context, at.x, at.y);
  if (lettering.is_upright) cairo_rotate(context, -0.5 * pi);
  use(lettering.colour);
  cairo_move_to(context, -shift, 0.0);
  cairo_show_text(context, line.c_str());
  cairo_restore(context);
}

void PixelCanvas::begin_clip(PixelRectangle const& r) {
  cairo_save(context_.get());
  cairo_rectangle(context_.get(), r.x, r.y, r.width, r.height);
  cairo_clip(context_.get());
}

void PixelCanvas::end_clip() { cairo_restore(context_.get()); }

void PixelCanvas::circle(Vector centre, double radius, Colour colour) {
  cairo_new_sub_path(context_.get());
  cairo_arc(context_.get(), centre.x, centre.y, radius, 0.0, 2.0 * pi);
  use(colour);
  cairo_fill(context_.get());
}

std::uint32_t PixelCanvas::width() const {
  return static_cast<std::uint32_t>(cairo_image_surface_get_width(surface_.get()));
}

std::uint32_t PixelCanvas::height() const {
  return static_cast<std::uint32_t>(cairo_image_surface_get_height(surface_.get()));
}

std::string PixelCanvas::pixels() const {
  require(cairo_status(context_.get()));
  cairo_surface_flush(surface_.get());
  unsigned char const* const rows = cairo_image_surface_get_data(surface_.get());
  auto const stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_.get()));
  std::string bytes;
  bytes.reserve(std::size_t{4} * width() * height());
  for (std::uint32_t row = 0; row < height(); ++row) {
    bytes.append(reinterpret_cast<char const*>(rows + row * stride), std::size_t{4} * width());
  }
  return bytes;
}

}  // namespace gridlock
