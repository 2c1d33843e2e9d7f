#pragma once

#include <cairo.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "drawing/colour.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// A rectangle of a picture, in pixels; y grows downwards from the upper left corner.
struct PixelRectangle {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};

/// A line around or along something.
struct Stroke {
  Colour colour;
  double width = 1.0;
  double opacity = 1.0;
  bool is_dashed = false;
};

enum class TextAnchor { start, middle, end };

/// A line of text.
struct Lettering {
  double size = 12.0;
  TextAnchor anchor = TextAnchor::start;
  bool is_bold = false;
  bool is_upright = false;  ///< turned by 90°, to be read from below
  Colour colour;
};

/// A surface a picture is drawn on, so that SVG and PNG come out of one drawing.
class Canvas {
 public:
  Canvas() = default;
  Canvas(Canvas const&) = delete;
  Canvas& operator=(Canvas const&) = delete;
  virtual ~Canvas() = default;

 protected:
  Canvas(Canvas&&) = default;

 public:
  virtual void fill(PixelRectangle const& rectangle, Colour colour) = 0;
  virtual void outline(PixelRectangle const& rectangle, Stroke const& stroke) = 0;
  virtual void line(Vector from, Vector to, Stroke const& stroke) = 0;
  virtual void text(Vector at, std::string_view text, Lettering const& lettering) = 0;
  virtual void triangle(Vector a, Vector b, Vector c, Colour colour) = 0;

  /// Until end_clip() nothing shows outside the rectangle.
  virtual void begin_clip(PixelRectangle const& rectangle) = 0;
  virtual void end_clip() = 0;

  /// Until end_circles() only circle() is called; a stroke of width 0 draws none.
  virtual void begin_circles(Stroke const& stroke) = 0;
  virtual void circle(Vector centre, double radius, Colour colour) = 0;
  virtual void end_circles() = 0;
};

/// Writes SVG text: one element for each thing drawn, with numbers of six digits and no style sheet, so that the
/// document may stand inside another.
class SvgCanvas final : public Canvas {
 public:
  SvgCanvas(double width, double height);

  /// The finished document.
  [[nodiscard]] std::string document() const;

  void fill(PixelRectangle const& rectangle, Colour colour) override;
  void outline(PixelRectangle const& rectangle, Stroke const& stroke) override;
  void line(Vector from, Vector to, Stroke const& stroke) override;
  void text(Vector at, std::string_view text, Lettering const& lettering) override;
  void triangle(Vector a, Vector b, Vector c, Colour colour) override;
  void begin_clip(PixelRectangle const& rectangle) override;
  void end_clip() override;
  void begin_circles(Stroke const& stroke) override;
  void circle(Vector centre, double radius, Colour colour) override;
  void end_circles() override;

  /// A PNG stretched over the rectangle, kept inside the document.
  void image(PixelRectangle const& rectangle, std::string_view png);

 private:
  std::string svg_;
  int clips_ = 0;
};

/// Draws with Cairo. Errors: RunFailure where Cairo fails, as it does for lack of memory.
class CairoCanvas : public Canvas {
 public:
  [[nodiscard]] cairo_surface_t* surface() const { return surface_.get(); }

  void fill(PixelRectangle const& rectangle, Colour colour) override;
  void outline(PixelRectangle const& rectangle, Stroke const& stroke) override;
  void line(Vector from, Vector to, Stroke const& stroke) override;
  void text(Vector at, std::string_view text, Lettering const& lettering) override;
  void triangle(Vector a, Vector b, Vector c, Colour colour) override;
  void begin_clip(PixelRectangle const& rectangle) override;
  void end_clip() override;
  void begin_circles(Stroke const& stroke) override;
  void circle(Vector centre, double radius, Colour colour) override;
  void end_circles() override;

 protected:
  /// Takes the surface over, on which the part of the picture that begins at `corner` shows, magnified by `scale`.
  CairoCanvas(cairo_surface_t* surface, Vector corner, double scale);
  CairoCanvas(CairoCanvas&&) = default;

  [[nodiscard]] cairo_t* context() const { return context_.get(); }

 private:
  struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };

  void use(Colour colour, double opacity = 1.0) const;
  void apply(Stroke const& stroke) const;

  std::unique_ptr<cairo_surface_t, Destroy> surface_;
  std::unique_ptr<cairo_t, Destroy> context_;
  Stroke circle_stroke_;
};

/// A picture of pixels.
class PixelCanvas final : public CairoCanvas {
 public:
  /// A canvas that shows the part `view` of the picture, magnified by `scale`.
  PixelCanvas(PixelRectangle const& view, double scale);

  [[nodiscard]] std::uint32_t width() const;
  [[nodiscard]] std::uint32_t height() const;
  /// The picture so far as a PNG file.
  [[nodiscard]] std::string png() const;
  /// The picture so far, row by row from the top, each pixel a 32-bit number 0x00RRGGBB.
  [[nodiscard]] std::string pixels() const;
};

/// A page of vectors, for papers.
class PdfCanvas final : public CairoCanvas {
 public:
  /// One point for each pixel of the picture.
  PdfCanvas(double width, double height);
  ~PdfCanvas() override;

  /// Ends the page; nothing may be drawn after it.
  [[nodiscard]] std::string document();

  /// Pixels stretched over the rectangle.
  void image(PixelRectangle const& rectangle, PixelCanvas const& pixels);

 private:
  PdfCanvas(double width, double height, std::unique_ptr<std::string> document);

  std::unique_ptr<std::string> document_;
};

}  // namespace gridlock
