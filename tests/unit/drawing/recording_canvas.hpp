#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "drawing/canvas.hpp"

namespace gridlock {

/// Remembers what is drawn on it.
class RecordingCanvas final : public Canvas {
 public:
  struct Circle {
    Vector centre;
    double radius = 0.0;
    std::string colour;
  };
  struct Rectangle {
    PixelRectangle place;
    std::string colour;
  };

  struct Line {
    Vector from;
    Vector to;
  };

  /// "#rrggbb".
  static std::string hex(Colour colour) {
    constexpr char const* digits = "0123456789abcdef";
    std::string text = "#";
    for (double const part : {colour.red, colour.green, colour.blue}) {
      auto const byte = static_cast<unsigned>(std::lround(255.0 * part));
      text += {digits[byte / 16], digits[byte % 16]};
    }
    return text;
  }

  void fill(PixelRectangle const& rectangle, Colour colour) override { filled.push_back({rectangle, hex(colour)}); }
  void outline(PixelRectangle const& /*rectangle*/, Stroke const& /*stroke*/) override {}
  void line(Vector from, Vector to, Stroke const& /*stroke*/) override { lines.push_back({from, to}); }
  void text(Vector /*at*/, std::string_view text, Lettering const& /*lettering*/) override { texts.emplace_back(text); }
  void begin_clip(PixelRectangle const& /*rectangle*/) override {}
  void end_clip() override {}
  void circle(Vector centre, double radius, Colour colour) override {
    circles.push_back({centre, radius, hex(colour)});
  }

  [[nodiscard]] std::vector<std::string> colours_of_circles() const {
    std::vector<std::string> colours;
    for (Circle const& circle : circles) colours.push_back(circle.colour);
    return colours;
  }

  std::vector<Circle> circles;
  std::vector<Rectangle> filled;
  std::vector<std::string> texts;
  std::vector<Line> lines;
};

}  // namespace gridlock
