#include "session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "core/saturating.hpp"
#include "drawing/frame_values.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/error.hpp"
#include "io/checkpoint.hpp"

namespace gridlock::web {

namespace {

/// Longest allowed start in seconds, since a page that does not respond for longer seems broken.
constexpr double longest_start = 60.0;
/// Character in a saved session after its fingerprint, if it was saved within a step.
constexpr char within_step = '1';
constexpr char between_steps = '0';
/// Time between two readings of the clock in seconds, much less than a frame of the screen.
constexpr double seconds_between_looks = 0.002;

void refuse_files(SettingsFile const& file) {
  if (!file.is_given("disks.file")) return;
  throw file.locate(Error({.what = "the page reads no files: disks.file cannot be used here",
                           .hint = "run it with gridlock run, or start from a lattice or at random",
                           .key = "disks.file"}));
}

Setup set_up_for_page(SettingsFile const& file) {
  refuse_files(file);
  double expected = 0.0;
  Setup setup = set_up(file, {.on_slow_start =
                                  [&](double seconds) {
                                    expected = seconds;
                                    return seconds <= longest_start;
                                  },
                              .threads = 1});
  if (expected <= longest_start) return setup;
  throw file.locate(
      Error({.what = fmt::format("the random start would take about {:.0f} s, too long for a page", expected),
             .hint = "use a lower packing fraction or fewer disks, or run it with gridlock run",
             .key = "disks.start"}));
}

std::string fingerprint_of(std::string const& configuration) {
  return fmt::format("{:016x}", XXH3_64bits(configuration.data(), configuration.size()));
}

Json json_of(Event const& event) { return {{"severity", to_text(event.severity)}, {"text", to_text(event)}}; }

template <class Visit>
auto with_values(NamedColumn const& column, Visit visit) {
  return std::visit(visit, column.values);
}

char const* type_of(NamedColumn const& column) {
  constexpr std::array names{"float64", "int32", "uint32", "uint64"};
  return names[column.values.index()];
}

Json box_of(Box const& box) {
  // One answer where x and y are alike, else one for each.
  Json const periodic =
      box.edge_x() == box.edge_y() ? Json(box.is_periodic()) : Json::array({box.is_periodic_x(), box.is_periodic_y()});
  return {{"width", box.width()}, {"height", box.height()}, {"periodic", periodic}, {"shift", box.shift()}};
}

/// Returns the 3 × 3 block of cells around a point. Beyond the lower and the upper edge of an oblique box the cells are
/// those of the shifted image.
std::vector<int> cells_around(Box const& box, CellLayout const& cells, Vector place) {
  std::vector<int> block;
  if (!box.is_oblique()) {
    cells.for_each_cell_in_block(cells.cell_of(place), 1, 1, [&](int cell) { block.push_back(cell); });
    return block;
  }
  for (int row = -1; row <= 1; ++row) {
    for (int column = -1; column <= 1; ++column) {
      Vector const to{column * cells.cell_width(), row * cells.cell_height()};
      int const cell = cells.cell_of(box.inside(place + to));
      if (std::ranges::find(block, cell) == block.end()) block.push_back(cell);
    }
  }
  return block;
}

Json drawn(std::string_view name, std::string_view unit, std::string_view documentation,
           std::vector<std::string> const& names = {}) {
  return {{"name", name}, {"unit", unit}, {"documentation", documentation}, {"valueNames", names}};
}

}  // namespace

Session::Session(SettingsFile const& file) : setup_(set_up_for_page(file)), plan_(plan_of(setup_)) {
  plan_.seconds_per_look = seconds_between_looks;
  fingerprint_ = fingerprint_of(configuration());
  start_run(plan_);
  // The samples at the start are due before the first step.
  if (simulation().is_prepared()) advance(0, 0.0);
  take_first_frame();
  mark_ = mark_for(first_);
}

void Session::start_run(RunPlan const& plan) {
  run_.emplace(simulation(), plan);
  if (left_out_until_) run_->leave_out_until(*left_out_until_);
}

void Session::take_first_frame() { first_ = simulation().frame(); }

std::string Session::configuration() { return to_toml(describing(setup_.configuration)); }

Json Session::description() {
  ModelKind const& model = setup_.configuration.kind();
  Json columns = Json::array();
  for (NamedColumn const& column : simulation().columns_of_agents()) {
    columns.push_back(
        {{"name", column.name}, {"type", type_of(column)}, {"valueNames", model.value_names(column.name)}});
  }
  std::vector<ColumnInfo> all = clock_columns();
  std::ranges::move(simulation().columns(), std::back_inserter(all));
  Json series = Json::array();
  for (ColumnInfo const& column : all) {
    series.push_back({{"name", column.name}, {"unit", column.unit}, {"documentation", column.documentation}});
  }
  CellLayout const cells = layout();
  return {{"title", model.title(setup_.configuration)},
          {"agentsName", model.agents_name()},
          {"columns", columns},
          {"drawnColumns", drawn_columns()},
          {"seriesColumns", series},
          {"grid",
           {{"columns", cells.columns()},
            {"rows", cells.rows()},
            {"cellWidth", cells.cell_width()},
            {"cellHeight", cells.cell_height()}}}};
}

Json Session::notes() const {
  Json all = Json::array();
  for (Event const& event : setup_.notes) all.push_back(json_of(event));
  if (!simulation().is_prepared()) return all;
  for (Event const& event : simulation().notes()) all.push_back(json_of(event));
  return all;
}

Json Session::status() const {
  Preparation const preparation = simulation().preparation();
  std::uint64_t const end = plan_.stop_condition.step;
  return {{"box", box_of(simulation().box())},
          {"count", simulation().agents()},
          {"step", simulation().clock().step},
          {"time", simulation().clock().time},
          {"timeStep", simulation().time_step()},
          {"endStep", end == never_reached ? Json() : Json(end)},
          {"fraction", run_->fraction_done()},
          {"isFinished", run_->has_reached_end()},
          {"isPrepared", simulation().is_prepared()},
          {"isWithinStep", is_within_step_},
          {"seriesLength", run_->series().row_count()},
          {"preparation",
           {{"fraction", preparation.fraction},
            {"what", preparation.what},
            {"stages", preparation.stages},
            {"finished", preparation.finished}}}};
}

std::uint64_t Session::advance(std::uint64_t steps, double milliseconds) {
  using Clock = std::chrono::steady_clock;
  auto const end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double, std::milli>(std::min(milliseconds, 1e9)));
  bool const was_prepared = simulation().is_prepared();
  std::uint64_t const before = simulation().clock().step;
  std::uint64_t const target = saturating_sum(before, steps);
  bool is_out_of_time = false;
  RunStatus const status = run_->advance_to(target, [&](Progress const&) {
    is_out_of_time = Clock::now() >= end;
    return !is_out_of_time;
  });
  is_within_step_ = is_out_of_time && simulation().is_prepared() && simulation().clock().step != target &&
                    !run_->has_reached_end() && setup_.configuration.kind().ends_within_steps(setup_.configuration);
  are_rows_known_ = false;
  if (!was_prepared && simulation().is_prepared()) take_first_frame();
  if (status == RunStatus::failed) throw RunFailure(run_->record().failure);
  return simulation().clock().step - before;
}

void Session::lengthen() {
  if (plan_.stop_condition.step == never_reached && !std::isfinite(plan_.stop_condition.time)) return;
  std::string const saved = to_checkpoint([&](Archive& archive) { run_->serialize(archive); });
  // Samples that the equilibration has left out so far stay left out when the run has no end.
  double const steps = static_cast<double>(simulation().clock().step);
  double const share = std::max(run_->fraction_done(), 1e-9);
  left_out_until_ = static_cast<std::uint64_t>(plan_.equilibration * std::min(steps / share, 9e15));
  plan_.stop_condition = {};
  start_run(plan_);
  from_checkpoint(saved, "the run", [&](Archive& archive) { run_->serialize(archive); });
}

std::vector<std::uint32_t> const& Session::rows() {
  if (!are_rows_known_) rows_ = rows_in_order(simulation().view().ids());
  are_rows_known_ = true;
  return rows_;
}

std::vector<double> Session::ids() {
  auto const ids = simulation().view().ids();
  std::vector<double> result;
  result.reserve(ids.size());
  for (std::uint32_t const row : rows()) result.push_back(static_cast<double>(ids[row]));
  return result;
}

NamedColumn Session::find_column(std::string_view name) const {
  std::vector<NamedColumn> const all = simulation().columns_of_agents();
  auto const found = std::ranges::find(all, name, &NamedColumn::name);
  if (found != all.end()) return *found;
  std::vector<std::string_view> names;
  for (NamedColumn const& column : all) names.push_back(column.name);
  throw Error(Problem{.what = fmt::format("the agents have no column \"{}\"", name),
                      .hint = fmt::format("the columns are {}", fmt::join(names, ", "))});
}

FrameValues Session::column(std::string const& name) {
  return with_values(find_column(name), [&](auto const& values) -> FrameValues {
    std::vector<std::remove_cvref_t<decltype(values[0])>> ordered;
    ordered.reserve(values.size());
    for (std::uint32_t const row : rows()) ordered.push_back(values[row]);
    return ordered;
  });
}

std::vector<double> Session::numbers_of(std::string_view name) {
  return with_values(find_column(name), [&](auto const& values) {
    std::vector<double> ordered;
    ordered.reserve(values.size());
    for (std::uint32_t const row : rows()) ordered.push_back(static_cast<double>(values[row]));
    return ordered;
  });
}

std::vector<float> Session::positions() {
  AgentsView const view = simulation().view();
  auto const x = view.column<X>(), y = view.column<Y>();
  std::vector<float> result;
  result.reserve(2 * view.size());
  for (std::uint32_t const row : rows()) {
    result.push_back(static_cast<float>(x[row]));
    result.push_back(static_cast<float>(y[row]));
  }
  return result;
}

std::vector<float> Session::radii() {
  AgentsView const view = simulation().view();
  if (!view.has<Radius>()) return std::vector<float>(view.size(), static_cast<float>(mark_));
  auto const radius = view.column<Radius>();
  std::vector<float> result;
  result.reserve(view.size());
  for (std::uint32_t const row : rows()) result.push_back(static_cast<float>(radius[row]));
  return result;
}

std::vector<Json> Session::drawn_columns() const {
  std::vector<Json> all;
  ModelKind const& model = setup_.configuration.kind();
  for (std::string const& name : colours_of(first_)) {
    if (name == "neighbourhood") continue;  // the page colours cells itself
    if (name == "displacement") {
      all.push_back(drawn(name, "length", "How far each agent has come from where it started."));
    } else if (name == "psi6") {
      all.push_back(drawn(name, "", "|ψ6|: 1 where the neighbours of an agent form a regular hexagon."));
    } else if (name == "speed") {
      all.push_back(drawn(name, "length / time", "How fast each agent is."));
    } else if (name == "direction") {
      all.push_back(drawn(name, "radian", "Where each agent goes, from −π to π; 0 is to the right."));
    } else if (first_.find(name) != nullptr) {
      all.push_back(drawn(name, "", "", model.value_names(name)));
    }
  }
  return all;
}

std::vector<float> Session::drawn_column(std::string const& name) {
  auto const as_floats = [](auto const& values) {
    std::vector<float> result;
    result.reserve(values.size());
    for (double const value : values) result.push_back(static_cast<float>(value));
    return result;
  };
  // A plain column can be read without a copy of the other columns.
  std::vector<std::string> const colours = colours_of(first_);
  if (simulation().view().has(name) || std::ranges::find(colours, name) == colours.end())
    return as_floats(numbers_of(name));
  if (name == "neighbourhood" || name == "radius") return radii();
  return as_floats(colour_values(first_, simulation().frame(), name));
}

std::vector<double> Session::series(std::size_t from_row) const {
  Table const& table = run_->series();
  std::vector<std::vector<double>> columns;
  for (std::string const& name : table.names()) columns.push_back(table.numbers(name));
  std::vector<double> result;
  for (std::size_t row = from_row; row < table.row_count(); ++row) {
    for (auto const& column : columns) result.push_back(column[row]);
  }
  return result;
}

Json Session::results() const {
  Json all = Json::array();
  for (NamedEstimate const& result : simulation().results()) {
    auto const& [value, error] = std::pair(result.estimate.value, result.estimate.error);
    all.push_back({{"name", result.name},
                   {"mean", value},
                   {"standardError", error ? Json(*error) : Json()},
                   {"unit", result.unit}});
  }
  return all;
}

Json Session::protocol_tables() const {
  // NaN, which JSON lacks, becomes null.
  auto const cells = [](std::vector<double> const& values) {
    Json all = Json::array();
    for (double const value : values) all.push_back(std::isfinite(value) ? Json(value) : Json());
    return all;
  };
  Json tables = Json::object();
  for (Distribution const& table : simulation().distributions()) {
    if (table.name != "stages" && table.name != "levels" && table.name != "shear") continue;
    Json columns = Json::object();
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      columns[table.columns[c].name] = cells(table.columns_of_values[c]);
    tables[table.name] = {{"names", table.names}, {"columns", columns}};
  }
  return tables;
}

std::string Session::state_hash() const { return fmt::format("{:016x}", simulation().state_hash()); }

double Session::cutoff() {
  AgentsView const view = simulation().view();
  if (view.has<Radius>()) {
    auto const radii = view.column<Radius>();
    return radii.empty() ? 0.0 : 2.0 * *std::ranges::max_element(radii);
  }
  // Models declare the range of interaction as their setting "radius"; without it, three marks are used.
  Json const values = values_of(setup_.configuration);
  auto const radius = values.find(setup_.configuration.model.kind + ".radius");
  return radius == values.end() || !radius->is_number() ? 3.0 * mark_ : radius->get<double>();
}

CellLayout Session::layout() {
  // Cells are no smaller than the cutoff, as in the paper's lists, and no finer than a screen can show.
  static constexpr double max_cells = 4096.0;
  Box const& box = simulation().box();
  auto const cells = [](double length, double side) {
    return static_cast<std::uint64_t>(std::clamp(std::floor(length / side), 1.0, max_cells));
  };
  if (auto const asked = setup_.configuration.engine.cells; asked && setup_.configuration.model.kind == "disks") {
    std::uint64_t const k = std::clamp<std::uint64_t>(*asked, 1, static_cast<std::uint64_t>(max_cells));
    return {box, k, k};
  }
  double const side = cutoff();
  if (!(side > 0.0)) return {box, 1, 1};
  return {box, cells(box.width(), side), cells(box.height(), side)};
}

Json Session::neighbourhood(double id) {
  AgentsView const view = simulation().view();
  auto const x = view.column<X>(), y = view.column<Y>();
  auto const ids = view.ids();
  std::vector<std::uint32_t> const& order = rows();
  auto const found =
      std::ranges::find_if(order, [&](std::uint32_t row) { return static_cast<double>(ids[row]) == id; });
  if (found == order.end()) throw Error(Problem{.what = fmt::format("there is no agent {:.0f}", id)});
  CellLayout const cells = layout();
  Vector const place{x[*found], y[*found]};
  int const own = cells.cell_of(place);
  std::vector<int> const block = cells_around(simulation().box(), cells, place);
  double const near_squared = cutoff() * cutoff();
  std::vector<std::uint64_t> inside, near;
  for (std::uint32_t const row : order) {
    Vector const other{x[row], y[row]};
    if (row == *found || std::ranges::find(block, cells.cell_of(other)) == block.end()) continue;
    inside.push_back(ids[row]);
    if (squared_length(simulation().box().displacement(place, other)) <= near_squared) near.push_back(ids[row]);
  }
  return {{"cell", own}, {"cells", block}, {"ids", inside}, {"near", near}};
}

std::vector<double> Session::contact_ids() const {
  auto const contacts = simulation().contacts();
  if (!contacts) return {};
  return {contacts->ids.begin(), contacts->ids.end()};
}

std::vector<double> Session::contact_forces() const {
  auto const contacts = simulation().contacts();
  return contacts ? contacts->forces : std::vector<double>();
}

std::string Session::save() {
  return fingerprint_ + (is_within_step_ ? within_step : between_steps) +
         to_checkpoint([&](Archive& archive) { run_->serialize(archive); });
}

void Session::restore(std::string const& bytes) {
  std::string_view const content(bytes);
  if (!content.starts_with(fingerprint_) || content.size() == fingerprint_.size()) {
    throw Error(Problem{.what = "these bytes are of no session with these settings",
                        .hint = "restore what save() gave in a session of the same settings"});
  }
  auto const take = [&](std::string_view saved) {
    start_run(plan_);
    from_checkpoint(saved.substr(1), "the saved session", [&](Archive& archive) { run_->serialize(archive); });
    is_within_step_ = saved.front() == within_step;
    are_rows_known_ = false;
  };
  std::string const before = save();
  try {
    take(content.substr(fingerprint_.size()));
  } catch (...) {
    take(std::string_view(before).substr(fingerprint_.size()));
    throw;
  }
}

}  // namespace gridlock::web
