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

/// The style of a line.
struct Stroke {
  Colour colour;
  double width = 1.0;
  double opacity = 1.0;
  bool is_dashed = false;
};

enum class TextAnchor { start, middle, end };

/// The style of a line of text.
struct Lettering {
  double size = 12.0;
  TextAnchor anchor = TextAnchor::start;
  bool is_upright = false;  ///< rotated by 90°, to be read upwards
  Colour colour;
};

/// A surface on which pictures are drawn.
class Canvas {
 public:
  virtual ~Canvas() = default;

  virtual void fill(PixelRectangle const& rectangle, Colour colour) = 0;
  virtual void outline(PixelRectangle const& rectangle, Stroke const& stroke) = 0;
  virtual void line(Vector from, Vector to, Stroke const& stroke) = 0;
  virtual void text(Vector at, std::string_view text, Lettering const& lettering) = 0;

  /// Restricts drawing to a rectangle until end_clip().
  virtual void begin_clip(PixelRectangle const& rectangle) = 0;
  virtual void end_clip() = 0;

  virtual void circle(Vector centre, double radius, Colour colour) = 0;

 protected:
  Canvas() = default;
  Canvas(Canvas const&) = default;
  Canvas(Canvas&&) = default;
  Canvas& operator=(Canvas const&) = default;
  Canvas& operator=(Canvas&&) = default;
};

/// A picture of pixels, drawn by Cairo. Errors: RunFailure if Cairo fails, for example for lack of memory.
class PixelCanvas final : public Canvas {
 public:
  PixelCanvas(double width, double height);

  void fill(PixelRectangle const& rectangle, Colour colour) override;
  void outline(PixelRectangle const& rectangle, Stroke const& stroke) override;
  void line(Vector from, Vector to, Stroke const& stroke) override;
  void text(Vector at, std::string_view text, Lettering const& lettering) override;
  void begin_clip(PixelRectangle const& rectangle) override;
  void end_clip() override;
  void circle(Vector centre, double radius, Colour colour) override;

  [[nodiscard]] std::uint32_t width() const;
  [[nodiscard]] std::uint32_t height() const;
  /// Returns the pixels by rows from the top, each as a 32-bit number 0x00RRGGBB.
  [[nodiscard]] std::string pixels() const;

 private:
  struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };

  void use(Colour colour, double opacity = 1.0) const;
  void apply(Stroke const& stroke) const;

  std::unique_ptr<cairo_surface_t, Destroy> surface_;
  std::unique_ptr<cairo_t, Destroy> context_;
};

}  // namespace gridlock
