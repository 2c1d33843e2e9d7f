#include "io/h5md_layout.hpp"

#include <string_view>

#include "io/xyz_header.hpp"

namespace gridlock::h5md {

namespace {

/// Returns the name of the vector with these two columns as components; empty if they form no vector.
std::string vector_name(FrameColumn const& first, FrameColumn const& second) {
  if (first.values.index() != second.values.index()) return "";
  if (first.name == "x" && second.name == "y") return "position";
  if (!first.name.ends_with("_x") || !second.name.ends_with("_y")) return "";
  std::string const name = first.name.substr(0, first.name.size() - 2);
  return second.name.substr(0, second.name.size() - 2) == name ? name : "";
}

/// Returns the reduced unit of a column that every population may have; empty for other columns.
std::string unit_of(std::string_view element) {
  if (element == "position" || element == "radius") return "length";
  if (element == "velocity") return "length/time";
  return element == "mass" ? "mass" : "";
}

}  // namespace

std::vector<Element> elements_of(std::vector<FrameColumn> const& columns) {
  std::vector<Element> elements;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    std::string vector;
    if (c + 1 < columns.size()) vector = vector_name(columns[c], columns[c + 1]);
    if (vector.empty()) {
      elements.push_back({columns[c].name, {c}, unit_of(columns[c].name)});
    } else {
      elements.push_back({vector, {c, c + 1}, unit_of(vector)});
      ++c;
    }
  }
  return elements;
}

std::vector<std::string> boundary_of(Box const& box) {
  auto const text = [](bool is_periodic) { return is_periodic ? "periodic" : "none"; };
  return {text(box.is_periodic_x()), text(box.is_periodic_y()), "none"};
}

std::pair<Edge, Edge> edges_of(std::vector<std::string> const& boundary) {
  auto const edge = [&](std::size_t axis) {
    return boundary[std::min(axis, boundary.size() - 1)] == "periodic" ? Edge::periodic : Edge::wall;
  };
  return {edge(0), edge(1)};
}

Box box_of(double width, double height, double shift, std::pair<Edge, Edge> const& edges) {
  return Box(width, height, edges.first, edges.second).shifted(shift);
}

void lean(Box const& box, double shift, std::vector<double>& x, std::vector<double> const& y,
          std::vector<std::int32_t>* images_x, std::vector<std::int32_t> const* images_y) {
  for (std::size_t row = 0; row < x.size(); ++row) {
    double place = y[row];
    x[row] -= xyz::fold(place, box.height()) * box.shift();
    if (images_x != nullptr && images_y != nullptr)
      (*images_x)[row] += static_cast<std::int32_t>(box.widths_in(shift) * (*images_y)[row]);
  }
}

std::vector<std::string> column_names(std::string const& element, bool is_vector) {
  if (!is_vector) return {element};
  if (element == "position") return {"x", "y"};
  return {element + "_x", element + "_y"};
}

std::span<std::byte const> bytes_of(FrameValues const& values) {
  return std::visit([](auto const& numbers) { return std::as_bytes(std::span(numbers)); }, values);
}

std::size_t width_of(FrameValues const& values) {
  return std::visit([](auto const& numbers) { return sizeof(numbers[0]); }, values);
}

Checksum begun_checksum(Box const& box, Clock const& clock, std::uint64_t seed, std::size_t agents,
                        std::uint64_t state_hash) {
  Checksum sum;
  double const reals[] = {box.width(), box.height(), clock.time};
  std::uint64_t const wholes[] = {number_of_edges(box), clock.step, seed, agents, state_hash};
  sum.add(std::span(reals));
  sum.add(std::span(wholes));
  double const shift[] = {box.shift()};
  if (box.is_oblique()) sum.add(std::span(shift));
  return sum;
}

void add_fields(Checksum& sum, std::span<Field const> fields) {
  for (Field const& field : fields) {
    std::uint64_t const shape[] = {field.rows(), field.columns()};
    sum.add(std::span(field.name()));
    sum.add(std::span(shape));
    sum.add(field.values());
  }
}

void add_networks(Checksum& sum, std::span<Network const> networks) {
  for (Network const& network : networks) {
    std::uint64_t const shape[] = {network.is_directed() ? 1U : 0U, network.size()};
    sum.add(std::span(network.name()));
    sum.add(std::span(shape));
    sum.add(network.edges());
  }
}

std::uint64_t checksum(Frame const& frame, std::span<double const> observables, std::uint64_t state_hash) {
  Checksum sum = begun_checksum(frame.box, frame.clock, frame.seed, frame.size(), state_hash);
  sum.add(std::span(frame.ids));
  for (FrameColumn const& column : frame.columns) {
    sum.add(std::span(column.name));
    sum.add(bytes_of(column.values));
  }
  add_fields(sum, frame.fields);
  add_networks(sum, frame.networks);
  sum.add(observables);
  return sum.digest();
}

std::uint64_t checksum(FrameContacts const& contacts) {
  Checksum sum;
  sum.add(std::span(&contacts.clock.step, 1));
  sum.add(std::span(&contacts.clock.time, 1));
  sum.add(std::span(contacts.ids));
  sum.add(std::span(contacts.forces));
  return sum.digest();
}

}  // namespace gridlock::h5md
