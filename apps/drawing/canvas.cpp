#include "drawing/canvas.hpp"

#include <cairo-pdf.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/markup.hpp"

namespace gridlock {

namespace {

// Every browser and editor has one of these; Cairo asks the system for the last.
constexpr std::string_view svg_fonts = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";
constexpr char const* cairo_font = "sans-serif";
constexpr double dash = 6.0;
constexpr double gap = 4.0;
constexpr double pi = 3.14159265358979323846;

std::string_view to_svg(TextAnchor anchor) {
  switch (anchor) {
    case TextAnchor::start:
      return "start";
    case TextAnchor::middle:
      return "middle";
    case TextAnchor::end:
      break;
  }
  return "end";
}

std::string to_svg(Stroke const& stroke) {
  std::string text = fmt::format("stroke=\"{}\" stroke-width=\"{:.6g}\"", to_hex(stroke.colour), stroke.width);
  if (stroke.opacity < 1.0) text += fmt::format(" stroke-opacity=\"{:.6g}\"", stroke.opacity);
  if (stroke.is_dashed) {
    text += fmt::format(" stroke-dasharray=\"{:.6g} {:.6g}\"", dash * stroke.width, gap * stroke.width);
  }
  return text;
}

std::string to_svg(PixelRectangle const& r) {
  return fmt::format("x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\"", r.x, r.y, r.width, r.height);
}

void require(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw RunFailure(fmt::format("the picture could not be drawn: {}", cairo_status_to_string(status)));
  }
}

cairo_status_t append_bytes(void* closure, unsigned char const* data, unsigned int length) noexcept {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<char const*>(data), length);
  } catch (...) {
    return CAIRO_STATUS_NO_MEMORY;  // an exception must not pass through Cairo, which is C
  }
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height)
    : svg_(fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                       "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
                       "width=\"{0:.6g}\" height=\"{1:.6g}\" viewBox=\"0 0 {0:.6g} {1:.6g}\">\n",
                       width, height)) {}

std::string SvgCanvas::document() const { return svg_ + "</svg>\n"; }

void SvgCanvas::fill(PixelRectangle const& rectangle, Colour colour) {
  fmt::format_to(std::back_inserter(svg_), "<rect {} fill=\"{}\"/>\n", to_svg(rectangle), to_hex(colour));
}

void SvgCanvas::outline(PixelRectangle const& rectangle, Stroke const& stroke) {
  fmt::format_to(std::back_inserter(svg_), "<rect {} fill=\"none\" {}/>\n", to_svg(rectangle), to_svg(stroke));
}

void SvgCanvas::line(Vector from, Vector to, Stroke const& stroke) {
  fmt::format_to(std::back_inserter(svg_), "<line x1=\"{:.6g}\" y1=\"{:.6g}\" x2=\"{:.6g}\" y2=\"{:.6g}\" {}/>\n",
                 from.x, from.y, to.x, to.y, to_svg(stroke));
}

void SvgCanvas::text(Vector at, std::string_view text, Lettering const& lettering) {
  std::string const turn =
      lettering.is_upright ? fmt::format(" transform=\"rotate(-90 {:.6g} {:.6g})\"", at.x, at.y) : std::string();
  fmt::format_to(std::back_inserter(svg_),
                 "<text x=\"{:.6g}\" y=\"{:.6g}\" font-family=\"{}\" font-size=\"{:.6g}\"{} text-anchor=\"{}\" "
                 "fill=\"{}\"{}>{}</text>\n",
                 at.x, at.y, svg_fonts, lettering.size, lettering.is_bold ? " font-weight=\"bold\"" : "",
                 to_svg(lettering.anchor), to_hex(lettering.colour), turn, escape_markup(one_line(text)));
}

void SvgCanvas::triangle(Vector a, Vector b, Vector c, Colour colour) {
  fmt::format_to(std::back_inserter(svg_), "<path d=\"M{:.6g} {:.6g}L{:.6g} {:.6g}L{:.6g} {:.6g}Z\" fill=\"{}\"/>\n",
                 a.x, a.y, b.x, b.y, c.x, c.y, to_hex(colour));
}

void SvgCanvas::begin_clip(PixelRectangle const& rectangle) {
  ++clips_;
  fmt::format_to(std::back_inserter(svg_),
                 "<clipPath id=\"clip-{0}\"><rect {1}/></clipPath>\n<g clip-path=\"url(#clip-{0})\">\n", clips_,
                 to_svg(rectangle));
}

void SvgCanvas::end_clip() { svg_ += "</g>\n"; }

void SvgCanvas::begin_circles(Stroke const& stroke) {
  svg_ += stroke.width > 0.0 ? "<g " + to_svg(stroke) + ">\n" : "<g>\n";
}

void SvgCanvas::circle(Vector centre, double radius, Colour colour) {
  fmt::format_to(std::back_inserter(svg_), "<circle cx=\"{:.6g}\" cy=\"{:.6g}\" r=\"{:.4g}\" fill=\"{}\"/>\n", centre.x,
                 centre.y, radius, to_hex(colour));
}

void SvgCanvas::end_circles() { svg_ += "</g>\n"; }

void SvgCanvas::image(PixelRectangle const& rectangle, std::string_view png) {
  fmt::format_to(std::back_inserter(svg_),
                 "<image {} preserveAspectRatio=\"none\" xlink:href=\"data:image/png;base64,{}\"/>\n",
                 to_svg(rectangle), to_base64(png));
}

CairoCanvas::CairoCanvas(cairo_surface_t* surface, Vector corner, double scale) : surface_(surface) {
  require(cairo_surface_status(surface_.get()));
  context_.reset(cairo_create(surface_.get()));
  require(cairo_status(context_.get()));
  cairo_scale(context_.get(), scale, scale);
  cairo_translate(context_.get(), -corner.x, -corner.y);
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_MITER);
}

void CairoCanvas::use(Colour colour, double opacity) const {
  cairo_set_source_rgba(context_.get(), colour.red, colour.green, colour.blue, opacity);
}

void CairoCanvas::apply(Stroke const& stroke) const {
  use(stroke.colour, stroke.opacity);
  cairo_set_line_width(context_.get(), stroke.width);
  double const dashes[] = {dash * stroke.width, gap * stroke.width};
  cairo_set_dash(context_.get(), dashes, stroke.is_dashed ? 2 : 0, 0.0);
}

void CairoCanvas::fill(PixelRectangle const& r, Colour colour) {
  use(colour);
  cairo_rectangle(context_.get(), r.x, r.y, r.width, r.height);
  cairo_fill(context_.get());
}

void CairoCanvas::outline(PixelRectangle const& r, Stroke const& stroke) {
  apply(stroke);
  cairo_rectangle(context_.get(), r.x, r.y, r.width, r.height);
  cairo_stroke(context_.get());
}

void CairoCanvas::line(Vector from, Vector to, Stroke const& stroke) {
  apply(stroke);
  cairo_move_to(context_.get(), from.x, from.y);
  cairo_line_to(context_.get(), to.x, to.y);
  cairo_stroke(context_.get());
}

void CairoCanvas::text(Vector at, std::string_view text, Lettering const& lettering) {
  cairo_t* const context = context_.get();
  std::string const line = one_line(text);
  cairo_save(context);
  cairo_select_font_face(context, cairo_font, CAIRO_FONT_SLANT_NORMAL,
                         lettering.is_bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
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

void CairoCanvas::triangle(Vector a, Vector b, Vector c, Colour colour) {
  use(colour);
  cairo_move_to(context_.get(), a.x, a.y);
  cairo_line_to(context_.get(), b.x, b.y);
  cairo_line_to(context_.get(), c.x, c.y);
  cairo_close_path(context_.get());
  cairo_fill(context_.get());
}

void CairoCanvas::begin_clip(PixelRectangle const& r) {
  cairo_save(context_.get());
  cairo_rectangle(context_.get(), r.x, r.y, r.width, r.height);
  cairo_clip(context_.get());
}

void CairoCanvas::end_clip() { cairo_restore(context_.get()); }

void CairoCanvas::begin_circles(Stroke const& stroke) { circle_stroke_ = stroke; }

void CairoCanvas::circle(Vector centre, double radius, Colour colour) {
  cairo_new_sub_path(context_.get());
  cairo_arc(context_.get(), centre.x, centre.y, radius, 0.0, 2.0 * pi);
  use(colour);
  if (circle_stroke_.width > 0.0) {
    cairo_fill_preserve(context_.get());
    apply(circle_stroke_);
    cairo_stroke(context_.get());
  } else {
    cairo_fill(context_.get());
  }
}

void CairoCanvas::end_circles() {}

PixelCanvas::PixelCanvas(PixelRectangle const& view, double scale)
    : CairoCanvas(
          cairo_image_surface_create(CAIRO_FORMAT_RGB24, std::max(1, static_cast<int>(std::lround(view.width * scale))),
                                     std::max(1, static_cast<int>(std::lround(view.height * scale)))),
          {view.x, view.y}, scale) {}

std::string PixelCanvas::png() const {
  require(cairo_status(context()));
  cairo_surface_flush(surface());
  std::string bytes;
  require(cairo_surface_write_to_png_stream(surface(), append_bytes, &bytes));
  return bytes;
}

std::uint32_t PixelCanvas::width() const {
  return static_cast<std::uint32_t>(cairo_image_surface_get_width(surface()));
}

std::uint32_t PixelCanvas::height() const {
  return static_cast<std::uint32_t>(cairo_image_surface_get_height(surface()));
}

std::string PixelCanvas::pixels() const {
  require(cairo_status(context()));
  cairo_surface_flush(surface());
  unsigned char const* const rows = cairo_image_surface_get_data(surface());
  auto const stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface()));
  std::string bytes;
  bytes.reserve(std::size_t{4} * width() * height());
  for (std::uint32_t row = 0; row < height(); ++row) {
    bytes.append(reinterpret_cast<char const*>(rows + row * stride), std::size_t{4} * width());
  }
  return bytes;
}

PdfCanvas::PdfCanvas(double width, double height) : PdfCanvas(width, height, std::make_unique<std::string>()) {}

PdfCanvas::PdfCanvas(double width, double height, std::unique_ptr<std::string> document)
    : CairoCanvas(cairo_pdf_surface_create_for_stream(append_bytes, document.get(), width, height), {0.0, 0.0}, 1.0),
      document_(std::move(document)) {}

// Cairo writes the end of the document, so that has to be there still.
PdfCanvas::~PdfCanvas() { cairo_surface_finish(surface()); }

std::string PdfCanvas::document() {
  require(cairo_status(context()));
  cairo_surface_finish(surface());
  require(cairo_surface_status(surface()));
  return *document_;
}

void PdfCanvas::image(PixelRectangle const& r, PixelCanvas const& pixels) {
  cairo_save(context());
  cairo_translate(context(), r.x, r.y);
  cairo_scale(context(), r.width / pixels.width(), r.height / pixels.height());
  cairo_set_source_surface(context(), pixels.surface(), 0.0, 0.0);
  cairo_paint(context());
  cairo_restore(context());
}

}  // namespace gridlock
