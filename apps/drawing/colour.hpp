#pragma once

#include <span>

namespace gridlock {

/// A colour of sRGB space, each part in [0, 1].
struct Colour {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
};

/// The colour at the fraction `share` between `from` and `to`.
Colour mixed(Colour from, Colour to, double share);

/// Eight colours that people with any common colour blindness tell apart, in the order curves take them; the yellow,
/// too pale for a line on white, comes last.
/// Source: M. Okabe & K. Ito, Color Universal Design (2008), https://jfly.uni-koeln.de/color/.
std::span<Colour const> categorical_colours();

/// The perceptually uniform map from dark blue (t = 0) over green to yellow (t = 1); t outside [0, 1] is clamped.
///
/// Every fifteenth colour of the original table with straight lines between, which stay within 0.02 of the others.
/// Source: S. van der Walt & N. Smith, A better default colormap for Matplotlib, SciPy 2015; why uniform maps:
/// J. R. Nuñez et al. 2018, doi:10.1371/journal.pone.0199239.
Colour viridis(double t);

/// A colour for a direction: hues around a circle, once for t from 0 to 1, with the same colour at both ends. One side
/// is brighter than the other, so that opposite directions differ for people with colour blindness too.
/// Source: B. Ottosson, A perceptual color space for image processing (2020), https://bottosson.github.io/posts/oklab/.
Colour colour_circle(double t);

}  // namespace gridlock
