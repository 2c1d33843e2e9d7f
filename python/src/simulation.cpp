#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "column_lender.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "listener.hpp"
#include "settings.hpp"

namespace gridlock::python {

namespace {

/// Calls a Python function every n steps. An exception of the function ends the run and reaches the caller.
class PythonWriter final : public Writer {
 public:
  PythonWriter(nb::object function, std::uint64_t every) : function_(std::move(function)), every_(every) {}
  ~PythonWriter() override {
    nb::gil_scoped_acquire const acquired;
    function_.reset();
  }

  [[nodiscard]] bool is_due(std::uint64_t steps) const override { return steps % every_ == 0; }
  [[nodiscard]] std::uint64_t next_after(std::uint64_t steps) const override { return (steps / every_ + 1) * every_; }
  void write(Simulation const& /*simulation*/, std::span<double const> /*sample*/) override {
    nb::gil_scoped_acquire const acquired;
    function_();
  }
  void serialize(Archive& /*archive*/) override {}

 private:
  nb::object function_;
  std::uint64_t every_;
};

/// Observes the values of a Python function, which returns a number for each column.
class PythonObservable final : public AveragingObservable {
 public:
  PythonObservable(nb::object function, std::vector<ColumnInfo> columns)
      : function_(std::move(function)), columns_of_function_(std::move(columns)) {}
  ~PythonObservable() override {
    nb::gil_scoped_acquire const acquired;
    function_.reset();
  }

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {}; }
  void begin(Snapshot const& /*start*/) override { reset(columns_of_function_); }
  void sample(Snapshot const& /*now*/, std::span<double> row, bool counts_for_average) override {
    nb::gil_scoped_acquire const acquired;
    auto const values = nb::cast<std::vector<double>>(function_());
    if (values.size() != row.size()) {
      throw Error({.what = "the observable " + columns_of_function_.front().name + " returned " +
                           std::to_string(values.size()) + " numbers for " + std::to_string(row.size()) + " columns",
                   .hint = "return one number for each name"});
    }
    for (std::size_t k = 0; k < row.size(); ++k) {
      row[k] = values[k];
      if (counts_for_average && std::isfinite(values[k])) average(k, values[k]);
    }
  }

 private:
  nb::object function_;
  std::vector<ColumnInfo> columns_of_function_;
};

/// A simulation in the memory of Python, with its run.
class PythonSimulation {
 public:
  PythonSimulation(std::optional<std::string> const& file, Assignments const& assignments,
                   std::optional<std::uint64_t> threads)
      : process_(getpid()) {
    nb::gil_scoped_release const released;
    settings_ = settings_of(file, assignments);
    setup_ = set_up(settings_, {.threads = threads});
    bool const has_length = settings_.is_given("run.steps") || settings_.is_given("run.time") ||
                            settings_.is_given("run.collisions_per_disk");
    ends_with_protocol_ = !has_length && !setup_.configuration.protocol.empty();
    has_end_ = has_length || ends_with_protocol_;
    for (char const* table : {"trajectory", "checkpoint"}) {
      if (settings_.is_given(table)) unused_tables_.emplace_back(table);
    }
    if (file) inputs_.push_back(*file);
    inputs_.push_back(setup_.start_file.string());
    plan_ = plan_of(setup_);
    if (!has_end_) {
      plan_.stop_condition = {};
      plan_.equilibration = 0.0;
    }
  }
  ~PythonSimulation() { release_arrays(); }
  PythonSimulation(PythonSimulation const&) = delete;
  PythonSimulation& operator=(PythonSimulation const&) = delete;

  /// Runs to the end of the plan, or for `steps` more steps; returns the status.
  std::string run(std::optional<std::uint64_t> steps, nb::object on_progress) {
    Use const use(*this, "run");
    if (!has_end_ && !steps) {
      throw Error(Problem{.what = "the settings give this simulation no end",
                          .hint = "say how far: run(steps=1000), or give run.steps, run.time or "
                                  "run.collisions_per_disk in the settings"});
    }
    if (ends_with_protocol_ && steps) {
      throw Error(
          Problem{.what = "this simulation ends with its protocol and takes no steps after it",
                  .hint = "give run.steps, run.time or run.collisions_per_disk in the settings, or leave steps out"});
    }
    release_arrays();
    check_changes();
    if (!run_) start();
    std::uint64_t const now = simulation().clock().step;
    std::uint64_t constexpr never = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t const pause = !steps || *steps > never - now ? never : now + *steps;
    Listener listener(std::move(on_progress));
    RunStatus status{};
    {
      nb::gil_scoped_release const released;
      status = run_->advance_to(
          pause, [&](Progress const& progress) { return listener(progress.clock.step - now, progress.fraction); });
    }
    listener.raise();
    if (status == RunStatus::failed) throw RunFailure(run_->record().failure);
    return to_text(status);
  }

  /// Ends the loan of arrays to a callback, and checks the values that it has written.
  void end_callback() {
    Use const use(*this);
    release_arrays();
    check_changes();
  }

  void leave_out_until(std::uint64_t step) {
    Use const use(*this, "equilibrate");
    if (!run_) start();
    run_->leave_out_until(step);
  }

  void add_callback(nb::object function, std::uint64_t every) {
    Use const use(*this, "add a callback");
    require_not_started("callbacks");
    writers_.push_back(std::make_unique<PythonWriter>(std::move(function), every));
  }
  void add_observable(nb::object function,
                      std::vector<std::tuple<std::string, std::string, std::string>> const& names) {
    Use const use(*this, "add an observable");
    require_not_started("observables");
    std::vector<ColumnInfo> columns;
    for (auto const& [name, unit, documentation] : names) columns.push_back({name, unit, documentation});
    simulation().observe(std::make_unique<PythonObservable>(std::move(function), std::move(columns)));
  }

  /// Prepares for lending arrays without a copy. Must not be called during a step or a sample.
  void prepare_arrays() {
    Use const use(*this);
    if (lender_.is_held() || has_vectors_side_by_side(simulation().columns_of_agents())) return;
    static_cast<void>(simulation().release_columns());
  }
  /// Lends a column; see ColumnLender for this and the next two functions.
  nb::object column(std::string const& name) {
    Use const use(*this);
    return lender_.column(simulation().columns_of_agents(), name);
  }
  nb::object columns(std::string const& first, std::string const& second) {
    Use const use(*this);
    return lender_.columns(simulation().columns_of_agents(), first, second);
  }
  nb::object ids() {
    Use const use(*this);
    return lender_.ids(simulation().view().ids());
  }
  [[nodiscard]] std::vector<std::string> column_names() {
    Use const use(*this);
    std::vector<std::string> names;
    for (std::string_view const name : simulation().view().names()) names.emplace_back(name);
    return names;
  }

  [[nodiscard]] std::pair<std::uint64_t, double> clock() {
    Use const use(*this);
    return {simulation().clock().step, simulation().clock().time};
  }
  [[nodiscard]] BoxValues box() {
    Use const use(*this);
    return box_values(simulation().box());
  }
  [[nodiscard]] double time_step() {
    Use const use(*this);
    return simulation().time_step();
  }
  [[nodiscard]] std::size_t agents() {
    Use const use(*this);
    return simulation().agents();
  }
  [[nodiscard]] std::uint64_t state_hash() {
    Use const use(*this);
    check_changes();
    return simulation().state_hash();
  }
  [[nodiscard]] bool has_end() const { return has_end_; }
  [[nodiscard]] std::string model() const { return setup_.configuration.model.kind; }
  /// Returns the meanings of the values 0, 1, 2 … of a column; none if they have no names.
  [[nodiscard]] std::vector<std::string> value_names(std::string const& column) const {
    return setup_.configuration.kind().value_names(column);
  }
  [[nodiscard]] std::string configuration() const { return resolved_configuration(setup_); }
  /// Throws Error if no run is possible with these settings over those of this simulation.
  void require_possible(Assignments const& changes) {
    Use const use(*this);
    nb::gil_scoped_release const released;
    SettingsFile changed = settings_;
    for (auto const& [key, value] : changes) changed.set(key, value, {.file = "", .line = 0, .column = 0});
    Configuration const configuration = read_configuration(changed);
    configuration.kind().check(configuration);
  }
  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::string> texts;
    for (Event const& event : setup_.notes) texts.push_back(to_text(event));
    for (std::string const& table : unused_tables_) {
      texts.push_back("[" + table + "] has no effect on a simulation in memory; gridlock.run() writes files");
    }
    return texts;
  }

  NamedValues series() {
    Use const use(*this);
    NamedValues columns;
    if (!run_) return columns;
    Table const& table = run_->series();
    for (std::string const& name : table.names()) columns[name.c_str()] = array_of_cells(table.column(name));
    return columns;
  }
  std::vector<std::tuple<std::string, std::string, std::string>> series_columns() {
    Use const use(*this);
    std::vector<ColumnInfo> all = clock_columns();
    std::ranges::move(simulation().columns(), std::back_inserter(all));
    std::vector<std::tuple<std::string, std::string, std::string>> columns;
    for (ColumnInfo const& column : all) columns.emplace_back(column.name, column.unit, column.documentation);
    return columns;
  }
  std::vector<std::tuple<std::string, double, std::optional<double>, std::string>> results() {
    Use const use(*this);
    std::vector<std::tuple<std::string, double, std::optional<double>, std::string>> results;
    for (NamedEstimate const& result : run_ ? run_->results() : simulation().results()) {
      results.emplace_back(result.name, result.estimate.value, result.estimate.error, result.unit);
    }
    return results;
  }
  NamedValues distributions() {
    Use const use(*this);
    NamedValues all;
    for (Distribution const& distribution : simulation().distributions()) {
      nb::dict columns;
      for (std::size_t k = 0; k < distribution.columns.size(); ++k) {
        std::vector<double> values = distribution.columns_of_values[k];
        columns[distribution.columns[k].name.c_str()] = owned_array(std::move(values));
      }
      all[distribution.name.c_str()] = columns;
    }
    return all;
  }
  nb::typed<nb::dict, nb::str, int> counts() {
    Use const use(*this);
    nb::typed<nb::dict, nb::str, int> counts;
    for (Count const& count : simulation().counts()) counts[count.name.c_str()] = count.value;
    return counts;
  }
  [[nodiscard]] std::vector<std::string> const& inputs() const { return inputs_; }
  FrameValuesOfPython frame() {
    Use const use(*this);
    check_changes();
    Frame frame;
    simulation().give_frame([&](FrameSource const& source) { frame = source.whole(); });
    return values_of_frame(std::move(frame));
  }
  void write_state(std::string const& path) {
    Use const use(*this);
    check_changes();
    simulation().give_frame([&](FrameSource const& frame) { write_xyz(frame, path); });
  }

 private:
  /// Refuses the use of a running simulation by other threads; the run's own callbacks may read it.
  class Use {
   public:
    /// `change` names the intended change in the words of the error; null for reading.
    explicit Use(PythonSimulation& simulation, char const* change = nullptr) : simulation_(simulation) {
      if (simulation.process_ != getpid()) {
        throw std::runtime_error("this simulation was made in another process; make a new one after the fork");
      }
      bool const is_running = simulation.user_ != std::thread::id{};
      bool const is_own = simulation.user_ == std::this_thread::get_id();
      if (is_running && !is_own) throw std::runtime_error("this simulation is running in another thread");
      if (is_running && change != nullptr) {
        throw std::runtime_error(std::string("a simulation that is running cannot ") + change);
      }
      if (!is_running) {
        simulation.user_ = std::this_thread::get_id();
        is_first_ = true;
      }
    }
    ~Use() {
      if (is_first_) simulation_.user_ = {};
    }
    Use(Use const&) = delete;
    Use& operator=(Use const&) = delete;

   private:
    PythonSimulation& simulation_;
    bool is_first_ = false;
  };

  [[nodiscard]] Simulation& simulation() { return *setup_.simulation; }

  void start() {
    run_.emplace(simulation(), plan_);
    for (auto const& writer : writers_) run_->add(*writer);
  }
  void require_not_started(char const* what) const {
    if (!run_) return;
    throw Error({.what = std::string(what) + " are added before the first step",
                 .hint = "make the simulation anew, add them, and run it"});
  }

  /// Throws if values that were written through arrays are no valid state.
  void check_changes() {
    if (!may_have_changed_ && !lender_.has_lent()) return;
    simulation().require_valid();
    may_have_changed_ = false;
  }
  void release_arrays() {
    may_have_changed_ = may_have_changed_ || lender_.has_lent();
    lender_.take_back([&] { return simulation().release_columns(); });
  }

  pid_t process_;
  std::thread::id user_;
  SettingsFile settings_;  ///< the settings that were given
  Setup setup_;
  std::vector<std::string> inputs_;  ///< files from which the simulation was made
  RunPlan plan_;
  bool has_end_ = false;
  bool ends_with_protocol_ = false;
  std::vector<std::string> unused_tables_;
  std::vector<std::unique_ptr<PythonWriter>> writers_;
  std::optional<Run> run_;
  ColumnLender lender_;
  bool may_have_changed_ = false;  ///< whether agents may have changed through earlier arrays
};

std::vector<std::string> keys_of_settings() {
  Configuration configuration;
  return setting_keys(describing(configuration));
}

std::string explain_setting(std::string const& key) {
  Configuration configuration;
  return explain(describing(configuration), key);
}

}  // namespace

void bind_simulation(nb::module_& module) {
  nb::class_<PythonSimulation>(module, "Simulation")
      .def(nb::init<std::optional<std::string> const&, Assignments const&, std::optional<std::uint64_t>>(),
           nb::arg("file").none(), nb::arg("assignments"), nb::arg("threads").none())
      .def("run", &PythonSimulation::run, nb::arg("steps").none(), nb::arg("on_progress").none())
      .def("end_callback", &PythonSimulation::end_callback)
      .def("leave_out_until", &PythonSimulation::leave_out_until)
      .def("add_callback", &PythonSimulation::add_callback)
      .def("add_observable", &PythonSimulation::add_observable)
      .def("prepare_arrays", &PythonSimulation::prepare_arrays)
      .def("column", &PythonSimulation::column)
      .def("columns", &PythonSimulation::columns)
      .def("ids", &PythonSimulation::ids)
      .def("column_names", &PythonSimulation::column_names)
      .def("clock", &PythonSimulation::clock)
      .def("box", &PythonSimulation::box)
      .def("time_step", &PythonSimulation::time_step)
      .def("agents", &PythonSimulation::agents)
      .def("state_hash", &PythonSimulation::state_hash)
      .def("has_end", &PythonSimulation::has_end)
      .def("model", &PythonSimulation::model)
      .def("value_names", &PythonSimulation::value_names)
      .def("configuration", &PythonSimulation::configuration)
      .def("require_possible", &PythonSimulation::require_possible, nb::arg("changes"))
      .def("notes", &PythonSimulation::notes)
      .def("series", &PythonSimulation::series)
      .def("series_columns", &PythonSimulation::series_columns)
      .def("results", &PythonSimulation::results)
      .def("distributions", &PythonSimulation::distributions)
      .def("counts", &PythonSimulation::counts)
      .def("inputs", &PythonSimulation::inputs)
      .def("frame", &PythonSimulation::frame)
      .def("write_state", &PythonSimulation::write_state);
  module.def("explain", &explain_setting);
  module.def("setting_keys", &keys_of_settings);
}

}  // namespace gridlock::python
