#include "model.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "arrays.hpp"
#include "gridlock/model/detail/field_requests.hpp"
#include "gridlock/simulation/register_model.hpp"
#include "gridlock/simulation/world_simulation.hpp"
#include "model_engine.hpp"
#include "model_world.hpp"

namespace gridlock::python {

namespace {

/// Returns the set of all held objects, which the GIL protects.
std::unordered_set<nb::handle*>& held_objects() {
  static std::unordered_set<nb::handle*> held;
  return held;
}

/// Releases all held objects at the end of the interpreter: class, module and simulation may refer to each other.
void let_go_of_all() {
  for (nb::handle* const handle : std::exchange(held_objects(), {})) {
    handle->dec_ref();
    *handle = nb::handle();
  }
}

}  // namespace

SharedObject::SharedObject(nb::object object)
    : handle_(new nb::handle(object.release()), [](nb::handle* handle) {
        // After the end of the interpreter no object may be released.
        if (Py_IsInitialized() != 0) {
          nb::gil_scoped_acquire const acquired;
          if (held_objects().erase(handle) != 0) handle->dec_ref();
        }
        delete handle;
      }) {
  held_objects().insert(handle_.get());
}

nb::object call_python(std::function<nb::object()> const& call) {
  try {
    return call();
  } catch (nb::python_error& error) {
    nb::object const type = nb::module_::import_("gridlock.errors").attr("Error");
    if (!error.matches(type)) throw;
    nb::object const text = nb::module_::import_("gridlock.models").attr("refusal_text")(error.value());
    auto what = nb::cast<std::string>(text);
    std::string hint;
    constexpr std::string_view mark = "\n  hint: ";
    if (std::size_t const place = what.find(mark); place != std::string::npos) {
      hint = what.substr(place + mark.size());
      what.resize(place);
    }
    throw Error({.what = what, .hint = hint});
  }
}

RunFailure failure_of(nb::python_error& error, std::string const& model, std::uint64_t step) {
  nb::object const text = nb::module_::import_("gridlock.models").attr("failure_text")(error.value(), model, step);
  return RunFailure(nb::cast<std::string>(text));
}

ColumnValues empty_column(std::string const& type) {
  if (type == "float64") return LargeArray<double>();
  if (type == "int32") return LargeArray<std::int32_t>();
  if (type == "uint32") return LargeArray<std::uint32_t>();
  if (type == "uint64") return LargeArray<std::uint64_t>();
  throw Error({.what = "a column cannot have the type " + type, .hint = "use float64, int32, uint32 or uint64"});
}

namespace {

/// A world of a model written in Python, with its engine and observables.
class PythonModelSimulation final : public WorldSimulation<TableModel> {
 public:
  PythonModelSimulation(ModelInstance const& model, World<TableModel>&& start, ObserveSettings const& observed)
      : WorldSimulation(std::make_unique<PythonModelEngine>(model), std::move(start)) {
    // An observation lends arrays of the world, and takes them back at its end, so the world does not change.
    auto& world = const_cast<World<TableModel>&>(this->world());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
    observe(std::make_unique<PythonModelObservations>(model, world));
    observe(observed, {.keeps_counters = false});
  }
};

/// The ModelKind for a class of Python.
class PythonModelKind final : public detail::AgentsKind {
 public:
  explicit PythonModelKind(std::shared_ptr<ModelDefinition const> definition)
      : definition_(std::move(definition)), settings_(definition_->settings) {}

  [[nodiscard]] std::unique_ptr<ModelKind> copy() const override { return std::make_unique<PythonModelKind>(*this); }
  [[nodiscard]] std::string_view name() const override { return definition_->name; }
  [[nodiscard]] std::string_view documentation() const override { return definition_->documentation; }
  [[nodiscard]] std::vector<std::string> value_names(std::string_view column) const override {
    auto const found = definition_->value_names.find(std::string(column));
    return found == definition_->value_names.end() ? std::vector<std::string>() : found->second;
  }
  [[nodiscard]] bool uses_threads(Configuration const& /*configuration*/) const override { return true; }
  [[nodiscard]] std::string unused_because_of(Configuration const& configuration, std::string_view key) const override {
    // The Python package searches neighbours by functions of its own, which verify_every does not check.
    if (key == "model.verify_every") return "model.kind = \"" + definition_->name + "\"";
    return AgentsKind::unused_because_of(configuration, key);
  }
  void check(Configuration const& configuration) const override {
    Box const box = make_box(configuration.box);
    detail::blame_table(name(), [&] {
      nb::gil_scoped_acquire const acquired;
      nb::object const model = make_model();
      call_python([&] { return model.attr("_check")(box_values(box)); });
      static_cast<void>(shapes_of_fields(model, box));
    });
  }

 protected:
  void describe_model(SettingVisitor& visitor) override {
    for (SettingDefinition& setting : settings_) describe_setting(setting, visitor);
  }
  [[nodiscard]] std::uint64_t agents_at_start() const override {
    auto const count = std::ranges::find(settings_, "count", &SettingDefinition::key);
    if (count == settings_.end()) return 0;
    auto const* const value = std::get_if<std::uint64_t>(&count->value);
    return value != nullptr ? *value : 0;
  }
  [[nodiscard]] std::size_t bytes_per_agent() const override {
    // Each agent has its values, their copy from before the step, and temporary arrays of one calculation.
    return 3 * 8 * (2 + definition_->columns.size()) + 40;
  }
  /// A field, two copies from before a step, and a temporary array of one calculation.
  [[nodiscard]] double copies_of_fields() const override { return 4.0; }
  [[nodiscard]] std::vector<FieldShape> shapes_of_fields(Box const& box) const override {
    std::vector<FieldShape> shapes;
    try {
      nb::gil_scoped_acquire const acquired;
      shapes = shapes_of_fields(make_model(), box);
    } catch (Error const&) {             // NOLINT(bugprone-empty-catch): check() tells it
    } catch (nb::python_error const&) {  // NOLINT(bugprone-empty-catch): and so does the start
    }
    return shapes;
  }
  [[nodiscard]] double attempts_at_start(Box const& /*box*/, std::uint64_t /*seed*/) const override { return 0.0; }
  [[nodiscard]] std::unique_ptr<Simulation> make(Box const& box, std::uint64_t seed,
                                                 ModelEngineSettings const& settings, ObserveSettings const& observed,
                                                 std::vector<std::string>& notes,
                                                 AllProcesses /*processes*/) const override {
    World<TableModel> world{
        .box = box, .agents = AgentTable(definition_->columns, definition_->kinds), .clock = {}, .seed = seed};
    ModelInstance model{.definition = definition_,
                        .object = {},
                        .threads = settings.threads,
                        .events = std::make_shared<std::vector<std::uint64_t>>(definition_->events.size()),
                        .searches = std::make_shared<KeptSearches>()};
    detail::blame_table(name(), [&] {
      nb::gil_scoped_acquire const acquired;
      nb::object const object = make_model();
      for (auto const& [name, columns, rows] : shapes_of_fields(object, box)) {
        world.fields.emplace_back(name, columns, rows);
      }
      using NameAndDirection = std::pair<std::string, bool>;
      for (auto& [name, is_directed] : nb::cast<std::vector<NameAndDirection>>(object.attr("_networks")())) {
        world.networks.emplace_back(std::move(name), is_directed);
      }
      {
        ShownWorld const start(world, *definition_, settings.threads, *model.searches, ModelWorld::Phase::start);
        call_python([&] { return object.attr("_start")(start.object()); });
      }
      model.time_step = nb::cast<double>(call_python([&] { return object.attr("_checked_time_step")(); }));
      model.object = SharedObject(object);
      require_inside(world);
      require_finite(world);
      for (Field const& field : world.fields) require_finite(field, 0);
    });
    if (world.agents.size() == 0 && (world.fields.empty() || !world.networks.empty())) {
      notes.push_back("the start of the model " + definition_->name + " has no agents; start.add() adds them");
    }
    return std::make_unique<PythonModelSimulation>(model, std::move(world), observed);
  }

 private:
  /// Returns the fields in the order of their names. Contract: the GIL is held.
  static std::vector<FieldShape> shapes_of_fields(nb::object const& model, Box const& box) {
    using Shapes = std::vector<std::tuple<std::string, std::size_t, std::size_t>>;
    nb::object const found = call_python([&] { return model.attr("_fields")(box_values(box)); });
    std::vector<FieldShape> shapes;
    for (auto const& [name, rows, columns] : nb::cast<Shapes>(found)) shapes.push_back({name, columns, rows});
    return shapes;
  }
  static void describe_setting(SettingDefinition& setting, SettingVisitor& visitor) {
    SettingInfo const info{.key = setting.key,
                           .unit = setting.unit,
                           .documentation = setting.documentation,
                           .min = setting.min,
                           .max = setting.max};
    if (setting.choices.empty()) {
      std::visit([&](auto& value) { visitor.visit(info, value); }, setting.value);
      return;
    }
    std::vector<std::string_view> const choices(setting.choices.begin(), setting.choices.end());
    auto& word = std::get<std::string>(setting.value);
    auto place = static_cast<std::size_t>(std::ranges::find(setting.choices, word) - setting.choices.begin());
    visitor.visit_choice(info, choices, place);
    word = setting.choices.at(place);
  }
  /// Returns an object of the model's class with the present settings.
  [[nodiscard]] nb::object make_model() const {
    nb::dict values;
    for (SettingDefinition const& setting : settings_) {
      values[setting.key.c_str()] = std::visit([](auto const& value) { return nb::cast(value); }, setting.value);
    }
    return call_python([&] { return definition_->type.get().attr("_made_with")(values); });
  }

  std::shared_ptr<ModelDefinition const> definition_;
  std::vector<SettingDefinition> settings_;
};

/// The name, the type and the kinds of a column, see TableColumn.
using ColumnTuple = std::tuple<std::string, std::string, std::vector<std::uint32_t>>;
using SettingTuple = std::tuple<std::string, std::string, std::string, double, double, std::vector<std::string>,
                                std::string, nb::object>;

SettingValue value_of(std::string const& type, nb::object const& value) {
  if (type == "bool") return nb::cast<bool>(value);
  if (type == "int") return nb::cast<std::uint64_t>(value);
  if (type == "float") return nb::cast<double>(value);
  if (type == "str") return nb::cast<std::string>(value);
  return nb::cast<std::vector<double>>(value);
}

void register_python_model(nb::object type, std::string name, std::string documentation,
                           std::vector<ColumnTuple> const& columns, std::size_t kinds, std::vector<std::string> events,
                           std::map<std::string, std::vector<std::string>> value_names,
                           std::vector<SettingTuple> const& settings, bool replaces) {
  auto definition = std::make_shared<ModelDefinition>();
  definition->type = SharedObject(std::move(type));
  definition->name = std::move(name);
  definition->documentation = std::move(documentation);
  for (auto const& [column, type_name, of_kinds] : columns) {
    definition->columns.push_back({column, empty_column(type_name), of_kinds});
  }
  definition->kinds = kinds;
  definition->events = std::move(events);
  definition->value_names = std::move(value_names);
  for (auto const& [key, unit, text, min, max, choices, type_name, value] : settings) {
    definition->settings.push_back({key, unit, text, min, max, choices, value_of(type_name, value)});
  }
  nb::gil_scoped_release const released;
  if (replaces) forget_model(definition->name);
  register_model(std::make_unique<PythonModelKind>(std::move(definition)));
}

}  // namespace

void bind_model(nb::module_& module) {
  bind_model_world(module);
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&let_go_of_all));
  module.def("register_model", &register_python_model, nb::arg("type"), nb::arg("name"), nb::arg("documentation"),
             nb::arg("columns"), nb::arg("kinds"), nb::arg("events"), nb::arg("value_names"), nb::arg("settings"),
             nb::arg("replaces"));
}

}  // namespace gridlock::python
