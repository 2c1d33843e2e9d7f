#include "gridlock/grid/detail/oblique_points.hpp"

namespace gridlock {

ObliquePoints::ObliquePoints(Box const& box, double distance, double const* x, double const* y, std::size_t count,
                             std::size_t stride, Images images)
    : box_(box),
      distance_(distance),
      frame_(box.width(), box.height() + 2.0 * distance, Edge::periodic, Edge::wall),
      own_(count) {
  for (std::size_t i = 0; i < count; ++i) {
    Vector const p = place({x[i * stride], y[i * stride]});
    x_.push_back(p.x);
    y_.push_back(p.y);
  }
  auto const add_image = [&](std::size_t i, double edges) {
    x_.push_back(image_inside(x_[i] + edges * box.shift(), box.width()));
    y_.push_back(y_[i] + edges * box.height());
    point_of_image_.push_back(static_cast<std::uint32_t>(i));
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (y_[i] <= 2.0 * distance) add_image(i, 1.0);
  }
  end_of_images_above_ = x_.size();
  if (images == Images::above) return;
  for (std::size_t i = 0; i < count; ++i) {
    if (y_[i] >= box.height()) add_image(i, -1.0);
  }
}

Vector ObliquePoints::place(Vector p) const {
  Vector const inside = box_.inside(p);
  return {inside.x, inside.y + distance_};
}

}  // namespace gridlock
