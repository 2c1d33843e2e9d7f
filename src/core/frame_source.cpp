#include "gridlock/core/frame_source.hpp"

#include <cassert>
#include <cstdint>
#include <span>
#include <type_traits>
#include <variant>

#include "gridlock/core/detail/rows_in_order.hpp"

namespace gridlock {

namespace {

/// A source of the rows of a view, in the order of their Ids.
class AgentsSource final : public FrameSource {
 public:
  AgentsSource(Frame head, AgentsView const& agents, std::span<Field const> fields, std::span<Network const> networks)
      : FrameSource(std::move(head), agents.size(), fields, networks), agents_(agents) {
    if (!std::ranges::is_sorted(agents.ids())) rows_ = rows_in_order(agents.ids());
  }

  [[nodiscard]] std::vector<Id> ids(std::size_t first, std::size_t count) const override {
    return piece_of(agents_.ids(), first, count);
  }
  [[nodiscard]] FrameValues values(std::size_t column, std::size_t first, std::size_t count) const override {
    return std::visit([&](auto all) { return FrameValues(piece_of(all, first, count)); },
                      agents_.columns()[column].second);
  }

 private:
  template <class Value>
  [[nodiscard]] std::vector<Value> piece_of(std::span<Value const> all, std::size_t first, std::size_t count) const {
    assert(first <= all.size() && count <= all.size() - first);
    if (rows_.empty()) {
      auto const piece = all.subspan(first, count);
      return {piece.begin(), piece.end()};
    }
    std::vector<Value> piece(count);
    for (std::size_t k = 0; k < count; ++k) piece[k] = all[rows_[first + k]];
    return piece;
  }

  AgentsView agents_;
  std::vector<std::uint32_t> rows_;  ///< rows in the order of their Ids; empty where they are in this order
};

class SomeColumns final : public FrameSource {
 public:
  SomeColumns(Frame head, FrameSource const& all, std::vector<std::size_t> places)
      : FrameSource(std::move(head), all.size(), all.fields(), all.networks()), all_(all), places_(std::move(places)) {}

  [[nodiscard]] std::vector<Id> ids(std::size_t first, std::size_t count) const override {
    return all_.ids(first, count);
  }
  [[nodiscard]] FrameValues values(std::size_t column, std::size_t first, std::size_t count) const override {
    return all_.values(places_[column], first, count);
  }

 private:
  FrameSource const& all_;
  std::vector<std::size_t> places_;
};

Frame head_of(FrameSource const& frame) {
  return {.box = frame.box(), .clock = frame.clock(), .seed = frame.seed(), .ids = {}, .columns = {}};
}

}  // namespace

std::optional<std::size_t> FrameSource::find(std::string_view name) const {
  auto const found = std::ranges::find(columns(), name, &FrameColumn::name);
  if (found == columns().end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns().begin());
}

Frame FrameSource::piece(std::size_t first, std::size_t count) const {
  Frame piece = head_of(*this);
  piece.ids = ids(first, count);
  for (std::size_t c = 0; c < columns().size(); ++c) {
    piece.columns.push_back({columns()[c].name, values(c, first, count)});
  }
  return piece;
}

Frame FrameSource::whole() const {
  Frame whole = piece(0, size());
  whole.fields.assign(fields().begin(), fields().end());
  whole.networks.assign(networks().begin(), networks().end());
  return whole;
}

std::unique_ptr<FrameSource> frame_source_of(Box const& box, Clock const& clock, std::uint64_t seed,
                                             AgentsView const& agents, std::span<Field const> fields,
                                             std::span<Network const> networks) {
  Frame head{.box = box, .clock = clock, .seed = seed, .ids = {}, .columns = {}};
  for (auto const& [name, values] : agents.columns()) {
    std::visit(
        [&head, name = name](auto all) {
          head.columns.push_back({std::string(name), std::vector<std::remove_cvref_t<decltype(all[0])>>()});
        },
        values);
  }
  return std::make_unique<AgentsSource>(std::move(head), agents, fields, networks);
}

std::unique_ptr<FrameSource> frame_source_of(Frame const& frame) {
  std::vector<std::pair<std::string_view, AgentsView::Values>> columns;
  for (FrameColumn const& column : frame.columns) {
    std::visit([&](auto const& values) { columns.emplace_back(column.name, std::span(values)); }, column.values);
  }
  return frame_source_of(frame.box, frame.clock, frame.seed, AgentsView(frame.ids, std::move(columns)), frame.fields,
                         frame.networks);
}

std::unique_ptr<FrameSource> with_columns(FrameSource const& frame, std::vector<std::size_t> columns) {
  Frame head = head_of(frame);
  for (std::size_t const place : columns) head.columns.push_back(frame.columns()[place]);
  return std::make_unique<SomeColumns>(std::move(head), frame, std::move(columns));
}

Frame frame_of(Box const& box, Clock const& clock, std::uint64_t seed, AgentsView const& agents) {
  return frame_source_of(box, clock, seed, agents)->whole();
}

}  // namespace gridlock
