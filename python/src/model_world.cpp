#include "model_world.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>

#include "gridlock/core/random.hpp"
#include "gridlock/core/spread.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/grid/neighbour_search.hpp"
#include "gridlock/model/detail/checks.hpp"

namespace gridlock::python {

namespace {

PointsInMemory points_of(AgentTable const& agents, RowSpan rows) {
  return {.x = agents.x().data() + rows.first, .y = agents.y().data() + rows.first, .count = rows.count()};
}

/// Returns the neighbours of the agents in some rows among those in other rows.
NeighbourLists find_among(World<TableModel> const& world, SearchOfRows const& rows) {
  PointsInMemory const among = points_of(world.agents, rows.among);
  NeighbourSearch const search(world.box, rows.cutoff, {among.x, among.count}, {among.y, among.count});
  NeighbourLists lists{.begin = {0}, .neighbours = {}};
  for (std::size_t row = rows.seeking.first; row < rows.seeking.end; ++row) {
    search.for_each_neighbour(Vector{world.agents.x()[row], world.agents.y()[row]}, [&](std::size_t other, Vector) {
      if (rows.among.first + other != row) lists.neighbours.push_back(static_cast<std::uint32_t>(other));
    });
    lists.begin.push_back(lists.neighbours.size());
  }
  return lists;
}

/// Returns an array that Python cannot write, since later searches may return it again.
template <class Array>
nb::object read_only(Array&& array) {
  nb::object object = nb::cast(std::forward<Array>(array));
  object.attr("setflags")(nb::arg("write") = false);
  return object;
}

/// Returns the values of a Python array as a column of this type.
template <class Values>
Values values_of(nb::handle array) {
  using Value = typename Values::value_type;
  auto const numbers = nb::cast<nb::ndarray<Value const, nb::ndim<1>, nb::c_contig, nb::device::cpu>>(array);
  return Values(numbers.data(), numbers.data() + numbers.shape(0));
}

}  // namespace

void ModelWorld::require_open() const {
  if (is_closed_) throw std::runtime_error("the step of this world is over; keep nothing of it between two steps");
}

BoxValues ModelWorld::box() const {
  require_open();
  return box_values(world_.box);
}
std::pair<std::uint64_t, double> ModelWorld::clock() const {
  require_open();
  return {world_.clock.step, world_.clock.time};
}
std::uint64_t ModelWorld::seed() const {
  require_open();
  return world_.seed;
}
std::size_t ModelWorld::size() const {
  require_open();
  return world_.agents.size();
}

std::vector<std::size_t> ModelWorld::counts() const {
  require_open();
  return world_.agents.counts();
}

nb::object ModelWorld::column(std::string const& name) {
  require_open();
  bool const is_kind = world_.agents.kinds() > 1 && name == AgentTable::kind_column;
  if (phase_ == Phase::observation || is_kind) return lender_.column_to_read(world_.agents.columns(), name);
  keep_before(name);
  return lender_.column(world_.agents.columns(), name);
}
nb::object ModelWorld::positions() {
  require_open();
  if (phase_ != Phase::observation) {
    keep_before(X::name);
    keep_before(Y::name);
    return lender_.columns(world_.agents.columns(), X::name, Y::name);
  }
  // Positions are copied, since columns must not move while a sample is taken.
  AgentTable const& agents = world_.agents;
  UninitializedArray<double> positions(2 * agents.size());
  for (std::size_t row = 0; row < agents.size(); ++row) {
    positions[2 * row] = agents.x()[row];
    positions[2 * row + 1] = agents.y()[row];
  }
  return nb::cast(owned_array(std::move(positions), {agents.size(), 2}));
}
nb::object ModelWorld::ids() {
  require_open();
  return lender_.ids(world_.agents.ids());
}

template <class Search, class ToPython>
nb::object ModelWorld::find(SearchOfRows const& rows, Search search, ToPython to_python) const {
  struct Counted {
    std::atomic<int>& count;
    explicit Counted(std::atomic<int>& searches) : count(searches) { ++count; }
    ~Counted() {
      --count;
      count.notify_all();
    }
    Counted(Counted const&) = delete;
    Counted& operator=(Counted const&) = delete;
  };
  if (nb::object known = kept_.find(rows, world_.agents, phase_ != Phase::step || has_changed_positions()))
    return known;
  std::uint64_t const version = kept_.version();
  auto found = [&] {
    Counted const counted(searches_);
    nb::gil_scoped_release const released;
    return search();
  }();
  nb::object result = to_python(std::move(found));
  kept_.keep(rows, result, version);
  return result;
}

nb::object ModelWorld::neighbor_lists(double cutoff, RowsFromTo seeking, RowsFromTo among) const {
  require_rows(seeking);
  require_rows(among);
  SearchOfRows const rows{
      .cutoff = cutoff, .seeking = {seeking.first, seeking.second}, .among = {among.first, among.second}};
  return find(
      rows,
      [&] {
        return seeking == among
                   ? find_neighbour_lists(world_.box, cutoff, points_of(world_.agents, rows.among), threads_)
                   : find_among(world_, rows);
      },
      [](NeighbourLists&& lists) {
        return nb::make_tuple(read_only(owned_array(std::move(lists.begin))),
                              read_only(owned_array(std::move(lists.neighbours))));
      });
}

nb::object ModelWorld::pairs(double cutoff, RowsFromTo among) const {
  require_rows(among);
  SearchOfRows const rows{.is_for_pairs = true, .cutoff = cutoff, .seeking = {}, .among = {among.first, among.second}};
  return find(
      rows, [&] { return find_pairs(world_.box, cutoff, points_of(world_.agents, rows.among), threads_); },
      [](PointPairs&& pairs) { return read_only(array_of_pairs(std::move(pairs))); });
}

void ModelWorld::require_rows(RowsFromTo rows) const {
  require_open();
  if (rows.first <= rows.second && rows.second <= size()) return;
  throw Error({.what = "there is no agent in row " + std::to_string(rows.second - 1) + " among " +
                       std::to_string(world_.agents.size()),
               .hint = "rows are those of the arrays in this step"});
}

void ModelWorld::add(std::size_t kind, nb::typed<nb::list, nb::object> const& columns) {
  require_open();
  NewAgents born{.kind = kind,
                 .x = values_of<std::vector<double>>(columns[0]),
                 .y = values_of<std::vector<double>>(columns[1]),
                 .others = {}};
  for (std::size_t k = 0; k < definition_.columns.size(); ++k) {
    std::visit(
        [&](auto const& empty) {
          born.others.emplace_back(values_of<std::remove_cvref_t<decltype(empty)>>(columns[2 + k]));
        },
        definition_.columns[k].values);
  }
  if (phase_ == Phase::start) {
    kept_.expect_changes();
    world_.agents.add(kind, born.x, born.y, born.others);
  } else {
    births_.push_back(std::move(born));
  }
}

void ModelWorld::remove(RowNumbers const& rows) {
  require_open();
  for (std::size_t k = 0; k < rows.shape(0); ++k) {
    require_rows({rows(k), rows(k) + 1});
    dead_rows_.push_back(rows(k));
  }
}

void ModelWorld::count(std::size_t event, std::uint64_t times) {
  require_open();
  events_.at(event) += times;
}

void ModelWorld::close() {
  if (is_closed_) return;
  is_closed_ = true;
  if (searches_ != 0) {
    nb::gil_scoped_release const released;
    for (int searches = searches_; searches != 0; searches = searches_) searches_.wait(searches);
  }
  lender_.take_back([&] {
    std::vector<LargeArray<double>> values;
    for (Field& field : world_.fields) values.push_back(field.release());
    return std::make_shared<std::pair<std::shared_ptr<void>, std::vector<LargeArray<double>>>>(world_.agents.release(),
                                                                                               std::move(values));
  });
}

std::vector<Id> ModelWorld::deaths() const {
  std::vector<Id> ids;
  ids.reserve(dead_rows_.size());
  for (std::uint64_t const row : dead_rows_) ids.push_back(world_.agents.ids()[row]);
  std::ranges::sort(ids);
  auto const again = std::ranges::unique(ids);
  ids.erase(again.begin(), again.end());
  return ids;
}

Field& ModelWorld::find_field(std::string const& name) const {
  require_open();
  auto const found = std::ranges::find(world_.fields, name, &Field::name);
  if (found != world_.fields.end()) return *found;
  std::string names;
  for (Field const& field : world_.fields) names += (names.empty() ? "" : ", ") + field.name();
  throw Error({.what = "the model has no field " + name, .hint = "it has " + (names.empty() ? "none" : names)});
}

Field& ModelWorld::field_to_change(std::string const& name) {
  Field& field = find_field(name);
  if (before_ != nullptr) before_->fields.keep(world_.fields, static_cast<std::size_t>(&field - world_.fields.data()));
  return field;
}

void ModelWorld::keep_before(std::string_view column) {
  if (before_ == nullptr || std::ranges::find(columns_changed_, column) != columns_changed_.end()) return;
  for (NamedColumn const& present : world_.agents.columns()) {
    if (present.name != column) continue;
    columns_changed_.emplace_back(column);
    auto before = std::ranges::find(before_->columns, column, &TableColumn::name);
    if (before == before_->columns.end()) {
      before = before_->columns.insert(before, TableColumn{std::string(column), ColumnValues(), {}});
    }
    std::visit(
        [&](auto values) {
          using Values = LargeArray<typename decltype(values)::value_type>;
          if (!std::holds_alternative<Values>(before->values)) before->values = Values();
          std::get<Values>(before->values).assign(values.begin(), values.end());
        },
        present.values);
  }
}

bool ModelWorld::has_changed_positions() const {
  return std::ranges::any_of(columns_changed_,
                             [](std::string const& name) { return name == X::name || name == Y::name; });
}

void ModelWorld::restore() {
  for (NamedColumn const& present : world_.agents.columns()) {
    if (std::ranges::find(columns_changed_, present.name) == columns_changed_.end()) continue;
    auto const before = std::ranges::find(before_->columns, present.name, &TableColumn::name);
    std::visit(
        [&](auto values) {
          std::ranges::copy(std::get<LargeArray<typename decltype(values)::value_type>>(before->values),
                            values.begin());
        },
        present.values);
  }
  before_->fields.restore(world_.fields);
  for (Network const& before : networks_before_) {
    *std::ranges::find(world_.networks, before.name(), &Network::name) = before;
  }
}

Vector ModelWorld::place_of(std::size_t row) const { return {world_.agents.x()[row], world_.agents.y()[row]}; }

void ModelWorld::require_one_for_each_agent(Amounts const& amounts) const {
  if (amounts.shape(0) == size()) return;
  throw Error(
      {.what = "there are " + std::to_string(amounts.shape(0)) + " amounts for " + std::to_string(size()) + " agents",
       .hint = "give a number, or an array of shape (N,)"});
}

nb::object ModelWorld::field(std::string const& name) {
  if (phase_ == Phase::observation) {
    Field const& field = find_field(name);
    return lender_.rows_of(field.values().data(), field.rows(), field.columns());
  }
  Field& field = field_to_change(name);
  return lender_.rows_of(field.values().data(), field.rows(), field.columns());
}

nb::object ModelWorld::cells(std::string const& name, std::optional<Positions> const& points) const {
  Field const& field = find_field(name);
  std::size_t const count = points ? points->shape(0) : size();
  UninitializedArray<std::int64_t> cells(count);
  for (std::size_t k = 0; k < count; ++k) {
    Vector const point = points ? Vector{(*points)(k, 0), (*points)(k, 1)} : place_of(k);
    Vector const place = points && is_finite(point) ? world_.box.inside(point) : point;
    if (!is_inside(world_.box, place)) {
      throw Error({.what = "point " + std::to_string(k) + " is at (" + in_words(place.x) + ", " + in_words(place.y) +
                           "), outside the box of " + in_words(world_.box.width()) + " × " +
                           in_words(world_.box.height()),
                   .hint = "a field has values in the box only"});
    }
    cells[k] = static_cast<std::int64_t>(field.cell_of(world_.box, place));
  }
  return nb::cast(owned_array(std::move(cells)));
}

void ModelWorld::deposit(std::string const& name, Amounts const& amounts) {
  Field& field = field_to_change(name);
  require_one_for_each_agent(amounts);
  for (std::size_t row = 0; row < size(); ++row) {
    field.values()[field.cell_of(world_.box, place_of(row))] += amounts(row);
  }
}

nb::object ModelWorld::take(std::string const& name, Amounts const& amounts) {
  Field& field = field_to_change(name);
  require_one_for_each_agent(amounts);
  std::vector<std::size_t> cells(size());
  std::vector<double> demand(field.size());
  for (std::size_t row = 0; row < size(); ++row) {
    if (!(amounts(row) >= 0.0)) {
      throw Error({.what = "the agent of row " + std::to_string(row) + " is to take " + in_words(amounts(row)),
                   .hint = "amounts are numbers from 0 on; deposit() gives"});
    }
    cells[row] = field.cell_of(world_.box, place_of(row));
    demand[cells[row]] += amounts(row);
  }
  UninitializedArray<double> taken(size());
  std::vector<std::tuple<std::size_t, double, Id, std::size_t>> rivals;
  for (std::size_t row = 0; row < size(); ++row) {
    taken[row] = amounts(row);
    if (demand[cells[row]] <= field.values()[cells[row]]) continue;
    Id const id = world_.agents.ids()[row];
    RandomStream stream(world_.seed, world_.clock.step, id, Purpose::model_take);
    rivals.emplace_back(cells[row], stream.uniform(), id, row);
  }
  std::ranges::sort(rivals);
  for (auto const& [cell, chance, id, row] : rivals) {
    double& left = field.values()[cell];
    taken[row] = std::clamp(left, 0.0, amounts(row));
    left -= taken[row];
    demand[cell] = 0.0;
  }
  for (std::size_t row = 0; row < size(); ++row) {
    if (demand[cells[row]] > 0.0) field.values()[cells[row]] -= taken[row];
  }
  return nb::cast(owned_array(std::move(taken)));
}

void ModelWorld::spread(std::string const& name, double diffusion, double decay, double time) {
  Field& field = field_to_change(name);
  nb::gil_scoped_release const released;
  ThreadPool threads(threads_);
  gridlock::spread(field, world_.box, {.diffusion = diffusion * time, .decay = decay * time}, threads);
}

void bind_model_world(nb::module_& module) {
  nb::class_<ModelWorld>(module, "ModelWorld")
      .def("network_edges", &ModelWorld::network_edges, nb::arg("name"))
      .def("network_lists", &ModelWorld::network_lists, nb::arg("name"), nb::arg("incoming"))
      .def("connect", &ModelWorld::connect, nb::arg("name"), nb::arg("rows"), nb::arg("weights"))
      .def("disconnect", &ModelWorld::disconnect, nb::arg("name"), nb::arg("rows"))
      .def("set_weights", &ModelWorld::set_weights, nb::arg("name"), nb::arg("weights"))
      .def("has_edges", &ModelWorld::has_edges, nb::arg("name"), nb::arg("rows"))
      .def("random_pairs", &ModelWorld::random_pairs, nb::arg("name"), nb::arg("kind"), nb::arg("first"),
           nb::arg("second"), nb::arg("purpose"))
      .def("rows_with_newborn", &ModelWorld::rows_with_newborn)
      .def("box", &ModelWorld::box)
      .def("clock", &ModelWorld::clock)
      .def("seed", &ModelWorld::seed)
      .def("size", &ModelWorld::size)
      .def("counts", &ModelWorld::counts)
      .def("column", &ModelWorld::column, nb::arg("name"))
      .def("positions", &ModelWorld::positions)
      .def("ids", &ModelWorld::ids)
      .def("field", &ModelWorld::field, nb::arg("name"))
      .def("cells", &ModelWorld::cells, nb::arg("name"), nb::arg("points").none())
      .def("deposit", &ModelWorld::deposit, nb::arg("name"), nb::arg("amounts"))
      .def("take", &ModelWorld::take, nb::arg("name"), nb::arg("amounts"))
      .def("spread", &ModelWorld::spread, nb::arg("name"), nb::arg("diffusion"), nb::arg("decay"), nb::arg("time"))
      .def("numbers", &ModelWorld::numbers, nb::arg("rows"), nb::arg("each"), nb::arg("purpose"), nb::arg("is_normal"))
      .def("numbers_from", &ModelWorld::numbers_from, nb::arg("rows"), nb::arg("each"), nb::arg("purpose"),
           nb::arg("is_normal"))
      .def("random_order", &ModelWorld::random_order, nb::arg("rows"), nb::arg("purpose"))
      .def("numbers_of_step", &ModelWorld::numbers_of_step, nb::arg("count"))
      .def("neighbor_lists", &ModelWorld::neighbor_lists, nb::arg("cutoff"), nb::arg("seeking"), nb::arg("among"))
      .def("pairs", &ModelWorld::pairs, nb::arg("cutoff"), nb::arg("among"))
      .def("move", &ModelWorld::move, nb::arg("displacements"), nb::arg("first"))
      .def("move_apart", &ModelWorld::move_apart, nb::arg("displacements"), nb::arg("first"), nb::arg("radii"),
           nb::arg("parts"), nb::arg("is_shuffled"))
      .def("add", &ModelWorld::add, nb::arg("kind"), nb::arg("columns"))
      .def("remove", &ModelWorld::remove, nb::arg("rows"))
      .def("count", &ModelWorld::count, nb::arg("event"), nb::arg("times"));
}

}  // namespace gridlock::python
