#pragma once

#include <span>

namespace gridlock {

/// A colour of sRGB space, each part in [0, 1].
struct Colour {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
};

/// Returns the colour at the fraction `share` of the way between `from` and `to`.
Colour mixed(Colour from, Colour to, double share);

/// Returns eight colours that people with any common colour blindness can distinguish, in the order of curves. Yellow
/// is last, since it is too pale for a line on white.
/// Source: M. Okabe & K. Ito, Color Universal Design (2008), https://jfly.uni-koeln.de/color/.
std::span<Colour const> categorical_colours();

/// Returns a colour of the perceptually uniform map from dark blue (t = 0) over green to yellow (t = 1); t is clamped.
///
/// Interpolates between every fifteenth colour of the original table, which deviates by at most 0.02. Source: S. van
/// der Walt & N. Smith, A better default colormap for Matplotlib, SciPy 2015; why uniform maps: J. R. Nuñez et al.
/// 2018, doi:10.1371/journal.pone.0199239.
Colour viridis(double t);

/// Returns a colour for a direction: hues around a circle for t from 0 to 1, with equal colours at both ends. One half
/// is brighter, so that opposite directions differ for people with colour blindness too. Source: B. Ottosson, A
/// perceptual color space for image processing (2020), https://bottosson.github.io/posts/oklab/.
Colour colour_circle(double t);

}  // namespace gridlock
