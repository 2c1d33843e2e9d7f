#include "gridlock/simulation/detail/model_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/simulation/register_model.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/slow_start.hpp"

namespace gridlock {

namespace {

ModelKinds& all_known() {
  static ModelKinds kinds = shipped_models();
  return kinds;
}

/// Returns whether a table of settings has this name: a table of every run, of disks or of a sweep.
bool is_name_of_table(std::string_view name) {
  Configuration configuration;
  configuration.models.keep_only("disks");
  std::vector<std::string> keys = setting_keys(describing(configuration));
  keys.emplace_back("sweep");
  return std::ranges::any_of(keys,
                             [&](std::string const& key) { return key.substr(0, key.find_first_of(".[")) == name; });
}

/// Protects all_known(), since threads create configurations while models are registered and forgotten.
std::mutex& mutex_of_all_known() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

ModelKinds known_models() {
  std::scoped_lock const lock(mutex_of_all_known());
  return all_known();
}

void register_model(std::unique_ptr<ModelKind> kind) {
  bool const is_table = is_name_of_table(kind->name());
  std::scoped_lock const lock(mutex_of_all_known());
  if (all_known().find(kind->name()) != nullptr) {
    throw Error({.what = fmt::format("there is a model {} already", kind->name()),
                 .hint = "give this one another name, and call register_model() for it once",
                 .key = "model.kind"});
  }
  if (is_table) {
    throw Error({.what = fmt::format("a model is called {}, as a table of the settings is", kind->name()),
                 .hint = "give it another name",
                 .key = "model.kind"});
  }
  all_known().add(std::move(kind));
}

void forget_model(std::string_view name) {
  std::scoped_lock const lock(mutex_of_all_known());
  all_known().remove(name);
}

std::optional<Problem> ModelKind::not_shared(Configuration const& /*configuration*/) const {
  return Problem{.what = fmt::format("the model \"{}\"", name()), .key = "model.kind"};
}

namespace detail {

void blame_table(std::string_view model, std::function<void()> const& act) {
  try {
    act();
  } catch (RunFailure const& failure) {
    throw Error({.what = failure.what(), .key = std::string(model)});
  } catch (Error const& error) {
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      problem.key = problem.key.empty() ? std::string(model) : fmt::format("{}.{}", model, problem.key);
    }
    throw Error(std::move(problems));
  }
}

std::string AgentsKind::title(Configuration const& /*configuration*/) const { return fmt::format("model {}", name()); }

std::vector<SettingTable> AgentsKind::tables(Configuration& configuration) {
  return {{"engine", "Of a model only the threads and the device.",
           [&](SettingVisitor& visitor) {
             describe_device(configuration.engine, visitor);
             describe_threads(configuration.engine, visitor);
           }},
          {std::string(name()), std::string(documentation()),
           [this](SettingVisitor& visitor) { describe_model(visitor); }}};
}

std::string AgentsKind::unused_because_of(Configuration const& configuration, std::string_view key) const {
  bool const is_used = !key.starts_with("engine.") || (key == "engine.threads" && uses_threads(configuration)) ||
                       (key == "engine.device" && can_use_device(configuration));
  return is_used ? "" : fmt::format("model.kind = \"{}\"", name());
}

std::optional<Problem> AgentsKind::not_shared(Configuration const& configuration) const {
  bool const has_fields = !shapes_of_fields(make_box(configuration.box)).empty();
  if (has_fields || has_networks()) {
    return Problem{.what = fmt::format("the model \"{}\", whose {} no process has in part,", name(),
                                       has_fields ? "fields" : "networks"),
                   .hint = "use gridlock run with engine.threads, or gridlock-mpi sweep for many runs",
                   .key = "model.kind"};
  }
  if (!can_be_shared()) return ModelKind::not_shared(configuration);
  if (configuration.model.verify_every == 0) return {};
  return Problem{.what = "a run with model.verify_every, whose searches are compared with a look at all agents,",
                 .hint = "leave model.verify_every out, or use gridlock run",
                 .key = "model.verify_every"};
}

std::vector<MemoryDemand> AgentsKind::memory(Configuration const& configuration) const {
  auto const agents = static_cast<double>(agents_at_start());
  std::vector<MemoryDemand> demands{{fmt::format("{:.0f} agents", agents), fmt::format("{}.count", name()),
                                     agents * static_cast<double>(bytes_per_agent()), "use fewer agents"}};
  for (auto const& [field, columns, rows] : shapes_of_fields(make_box(configuration.box))) {
    double const bytes = 8.0 * static_cast<double>(columns) * static_cast<double>(rows);
    demands.push_back({fmt::format("the field {} of {} × {} cells", field, columns, rows), std::string(name()),
                       copies_of_fields() * bytes, "use fewer cells"});
  }
  return demands;
}

double AgentsKind::expected_bytes(Configuration const& /*configuration*/, std::size_t agents) const {
  constexpr double bytes_per_agent = 250.0;
  return bytes_per_agent * static_cast<double>(agents);
}

void AgentsKind::build(Setup& setup, SetupOptions const& options) const {
  Configuration const& configuration = setup.configuration;
  Box const box = make_box(configuration.box);
  std::uint64_t const seed = configuration.run.seed;
  bool const may_be_slow = options.on_slow_start && agents_at_start() >= many_agents;
  double const attempts = may_be_slow ? attempts_at_start(box, seed) : 0.0;
  if (!makes_start(attempts, "model.kind", options, setup.notes)) return;
  std::vector<std::string> notes;
  std::uint64_t const threads = threads_of(configuration, options.threads, options.processes);
  setup.simulation = make(box, seed,
                          {.threads = threads,
                           .verify_every = configuration.model.verify_every,
                           .is_on_device = uses_device(configuration)},
                          configuration.observe, notes, options.processes);
  for (std::string const& text : notes) {
    setup.notes.push_back({.kind = EventKind::note_of_model, .key = "model.kind", .values = {{"text", text}}});
  }
}

}  // namespace detail

}  // namespace gridlock
