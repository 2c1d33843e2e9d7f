#include "workspace/sweep_worker.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <cstdint>
#include <exception>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "workspace/sweep_crew.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

SweepOutcome outcome_of_record(RunRecord const& record) {
  return {.has_begun = true,
          .status = record.status,
          .message = record.failure,
          .state_hash = record.state_hash,
          .seconds = record.seconds,
          .results = record.results};
}

std::uint64_t bits_of(double number) { return std::bit_cast<std::uint64_t>(number); }
double number_in(Json const& json) { return std::bit_cast<double>(json.get<std::uint64_t>()); }

}  // namespace

std::optional<SweepOutcome> SweepWorker::make(std::size_t run, Prospect const& prospect,
                                              std::function<bool(double)> const& report) const {
  AllProcesses const processes = settings_.crew == nullptr ? AllProcesses() : settings_.crew->processes();
  RunHooks const hooks{.on_progress = [&](Progress const& progress) { return report(progress.fraction); },
                       .on_event = {},
                       .threads = prospect.threads,
                       .processes = processes};
  auto const directory = directory_.directory_of(run);
  enum class Way : std::uint64_t { is_made, is_stopped, resumes, begins };
  try {
    std::optional<RunSummary> made;
    auto const way = [&] {
      // Another shard with the same directory may have finished the run meanwhile.
      made = directory_.recorded(run);
      if (made && is_finished(outcome_of(*made))) return Way::is_made;
      if (!report(0.0)) return Way::is_stopped;
      return directory_.is_there(run) ? Way::resumes : Way::begins;
    };
    MemoryBudget::Part const memory(memory_, prospect.bytes);
    Way chosen = Way::is_stopped;
    processes.on_root([&] { chosen = way(); });
    switch (processes.of_root(chosen)) {
      case Way::is_made:
        return made ? std::optional(outcome_of(*made)) : std::nullopt;
      case Way::is_stopped:
        return std::nullopt;
      case Way::resumes:
        return outcome_of_record(resume_in(directory, hooks));
      case Way::begins:
        break;
    }
    SettingsFile settings = plan_.runs[run].settings;
    // The resolved configuration must record the number of threads in use.
    if (prospect.takes_threads) settings.set(fmt::format("engine.threads={}", prospect.threads));
    return outcome_of_record(run_in(directory, set_up(settings, {.processes = processes}), hooks));
  } catch (std::exception const& error) {
    processes.require_failure_of_all(error.what());
    return SweepOutcome{.has_begun = true,
                        .status = RunStatus::failed,
                        .message = reason_of(error),
                        .state_hash = 0,
                        .seconds = 0.0,
                        .results = {}};
  }
}

std::string encode(SweepOutcome const& outcome) {
  Json json{{"has_begun", outcome.has_begun},      {"status", static_cast<int>(outcome.status)},
            {"message", outcome.message},          {"state_hash", outcome.state_hash},
            {"seconds", bits_of(outcome.seconds)}, {"results", Json::array()}};
  for (NamedEstimate const& result : outcome.results) {
    auto const& error = result.estimate.error;
    json["results"].push_back({{"name", result.name},
                               {"value", bits_of(result.estimate.value)},
                               {"error", error ? Json(bits_of(*error)) : Json()},
                               {"unit", result.unit}});
  }
  // A message may contain a path that is not valid UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

SweepOutcome decode_outcome(std::string const& text) {
  try {
    Json const json = Json::parse(text);
    SweepOutcome outcome{.has_begun = json.at("has_begun").get<bool>(),
                         .status = static_cast<RunStatus>(json.at("status").get<int>()),
                         .message = json.at("message").get<std::string>(),
                         .state_hash = json.at("state_hash").get<std::uint64_t>(),
                         .seconds = number_in(json.at("seconds")),
                         .results = {}};
    for (Json const& entry : json.at("results")) {
      Estimate estimate{.value = number_in(entry.at("value")), .error = std::nullopt};
      if (!entry.at("error").is_null()) estimate.error = number_in(entry.at("error"));
      outcome.results.push_back({entry.at("name").get<std::string>(), estimate, entry.at("unit").get<std::string>()});
    }
    return outcome;
  } catch (Json::exception const& error) {
    throw RunFailure(fmt::format("a process of the sweep sent what is no outcome of a run: {}", error.what()));
  }
}

}  // namespace gridlock
