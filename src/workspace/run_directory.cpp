#include "gridlock/workspace/run_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <new>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/core/version.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "io/checkpoint.hpp"
#include "io/file.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/settings_difference.hpp"
#include "simulation/trajectory.hpp"
#include "workspace/checkpoint_clock.hpp"
#include "workspace/continued_run.hpp"
#include "workspace/hash_chain.hpp"
#include "workspace/result_files.hpp"
#include "workspace/run_files.hpp"
#include "workspace/run_log.hpp"
#include "workspace/run_results.hpp"
#include "workspace/summary.hpp"

namespace gridlock {

namespace {

constexpr char const* trajectory_name = "trajectory.h5";
constexpr char const* begun_trajectory_name = "trajectory.h5.part";

/// Returns the note on audits; nothing if the run has no audits.
std::optional<Event> audit_event(Simulation const& simulation) {
  Event event{.kind = EventKind::audited, .severity = Severity::info};
  for (auto const& [name, value] : simulation.audits()) event.values.emplace_back(name, value);
  return event.values.empty() ? std::nullopt : std::optional(event);
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

/// A run in its directory. If processes share the run, the root writes the files.
class RunInDirectory {
 public:
  RunInDirectory(std::filesystem::path directory, Setup setup, std::string configuration, RunHooks const& hooks)
      : directory_(std::move(directory)),
        setup_(std::move(setup)),
        processes_(setup_.simulation->processes()),
        start_hash_(setup_.simulation->state_hash()),
        hooks_(hooks),
        log_(directory_, hooks.on_event, processes_),
        configuration_(std::move(configuration)),
        plan_(plan_of(setup_)),
        simulation_(*setup_.simulation),
        run_(simulation_, plan_),
        chain_(run_, plan_, setup_.configuration.checkpoint.keep_states,
               [this](std::uint64_t step) { keep_state(step); }) {
    add_trajectory();
    run_.add(chain_);
  }

  void begin() {
    processes_.on_root([&] {
      remove_results(directory_);
      for (char const* name : {"run.log", configuration_name, "start.xyz", "checkpoint.gridlock",
                               "checkpoint.previous.gridlock", trajectory_name, begun_trajectory_name}) {
        record_result(directory_ / name);
      }
      if (setup_.configuration.checkpoint.keep_states > 0) record_result(directory_ / states_name);
    });
    if (!setup_.start_file.empty()) {
      simulation_.give_frame([&](FrameSource const& frame) { write_xyz(frame, directory_ / "start.xyz"); });
    }
    processes_.on_root([&] { write_file(directory_ / configuration_name, configuration_); });
    for (Event const& note : setup_.notes) {
      if (!note.is_default) log_.write(note);
    }
    Configuration const& configuration = setup_.configuration;
    ModelKind const& kind = configuration.kind();
    log_.write({.kind = EventKind::begun,
                .severity = Severity::info,
                .step = simulation_.clock().step,
                .values = {{"version", version()},
                           {"title", kind.title(configuration)},
                           {"agents", static_cast<std::uint64_t>(simulation_.agents())},
                           {"agents_name", std::string(kind.agents_name())},
                           {"seed", configuration.run.seed},
                           {"start_hash", hash_text(start_hash_)}}});
  }

  /// Restores the newest checkpoint. Changes only run.log and trajectory.h5, after `require` has accepted the run.
  void restore(std::function<void()> const& require) {
    std::uint64_t const first_step = simulation_.clock().step;
    auto const restored = restore_checkpoint_of_all(
        directory_, [&](Archive& archive) { serialize(archive); }, processes_);
    if (restored) simulation_.take_restored();
    processes_.agree(require);
    processes_.on_root([&] {
      std::error_code ignored;
      std::filesystem::remove(directory_ / begun_trajectory_name, ignored);
    });
    if (!restored) {
      log_.write({.kind = EventKind::began_again, .severity = Severity::info});
      return;
    }
    auto const last_stop = run_.last_stop();
    if (trajectory_ && last_stop) trajectory_->restore(simulation_, first_step, *last_stop);
    if (restored->note.empty()) {
      saved_at_ = simulation_.clock();
      saved_work_ = simulation_.preparation().work;
    }
    if (!restored->note.empty()) {
      log_.write({.kind = EventKind::checkpoint_damaged,
                  .severity = Severity::warning,
                  .step = simulation_.clock().step,
                  .values = {{"why", restored->note}}});
    }
    log_.write({.kind = EventKind::resumed,
                .severity = Severity::info,
                .step = simulation_.clock().step,
                .values = {{"version", version()}, {"file", restored->file.filename().string()}}});
    note_version();
  }

  void require_below_length() const {
    if (!run_.has_reached_end()) return;
    Clock const clock = simulation_.clock();
    throw Error({.what = fmt::format("the run in {} has come to step {}, time {:.6g} already", directory_.string(),
                                     clock.step, clock.time),
                 .hint = "the new length counts from the start of the run and has to be above what it has",
                 .file = directory_.string()});
  }

  /// Returns the fraction of the run that averages leave out, by Run::fit_equilibration().
  double take_length() {
    double const equilibration = run_.fit_equilibration();
    if (equilibration != setup_.configuration.observe.equilibration) {
      log_.write({.kind = EventKind::equilibration_fitted,
                  .step = simulation_.clock().step,
                  .key = "observe.equilibration",
                  .values = {{"equilibration", equilibration}}});
    }
    return equilibration;
  }

  /// Records a new length; the run in the directory is unfinished from here on.
  void record_length(std::string configuration, std::string const& length) {
    configuration_ = std::move(configuration);
    processes_.on_root([&] {
      std::error_code ignored;
      // Without a summary the run counts as interrupted, with the old or the new length, if a kill follows.
      std::filesystem::remove(directory_ / summary_name, ignored);
      write_file(directory_ / configuration_name, configuration_);
    });
    write_chain();
    log_.write({.kind = EventKind::lengthened,
                .severity = Severity::info,
                .step = simulation_.clock().step,
                .values = {{"length", length}}});
  }

  RunRecord carry_out() {
    log_.write(processors_event());
    CheckpointClock checkpoints(setup_.configuration.checkpoint);
    RunStatus const status =
        run_.advance(hooks_.on_progress, {.is_due = [&](std::uint64_t steps) { return checkpoints.is_due(steps); },
                                          .call =
                                              [&](std::uint64_t steps) {
                                                save();
                                                checkpoints.note(steps);
                                              },
                                          .call_at_end =
                                              [&](std::uint64_t) {
                                                if (setup_.configuration.checkpoint.keep_last) save();
                                              }});
    if (status == RunStatus::interrupted) save();
    RunRecord record = run_.record();
    try {
      // An interrupted run has just been saved with its chain.
      if (status != RunStatus::interrupted) {
        write_chain(status == RunStatus::finished ? std::optional(record.state_hash) : std::nullopt);
      }
      simulation_.give_frame([&](FrameSource const& frame) {
        write_run_results(directory_, versions_, setup_.configuration, start_hash_, record, frame,
                          processes_.communicator().traffic_of_ranks());
      });
    } catch (RunFailure const& failure) {
      // A full disk may first end the run and then keep results from being written; the error names both reasons.
      if (record.failure.empty()) throw;
      throw RunFailure(fmt::format("{}; then {}", record.failure, failure.what()));
    } catch (Error const& error) {
      // A user's file took the name of a result during the run. That is no mistake of input, and the checkpoint stays.
      throw RunFailure(error.problems().front().what);
    }
    processes_.on_root([&] {
      if (status == RunStatus::finished) {
        setup_.configuration.checkpoint.keep_last ? remove_previous_checkpoint(directory_)
                                                  : remove_checkpoints(directory_);
      }
      remove_leftovers(directory_);
    });
    for (Event const& note : record.notes) log_.write(note);
    if (auto const audits = audit_event(simulation_)) log_.write(*audits);
    log_traffic();
    log_.write({.kind = EventKind::ended,
                .severity = Severity::info,
                .step = record.clock.step,
                .values = {{"status", to_text(record.status)},
                           {"seconds", record.seconds},
                           {"state_hash", hash_text(record.state_hash)},
                           {"failure", record.failure}}});
    return record;
  }

 private:
  void add_trajectory() {
    TrajectorySettings const& settings = setup_.configuration.trajectory;
    if (!settings.has_frames()) return;
    trajectory_.emplace(settings, simulation_.time_step(),
                        TrajectoryWriter::Origin{directory_ / trajectory_name, configuration_, version(),
                                                 [this](std::string_view column) {
                                                   return setup_.configuration.kind().value_names(column);
                                                 }});
    run_.add(*trajectory_);
  }

  /// Adds this version to those of the checkpoint, with a note, if the checkpoint was saved by another version.
  void note_version() {
    constexpr std::string_view then = ", then ";
    std::size_t const place = versions_.rfind(then);
    std::string const former = place == std::string::npos ? versions_ : versions_.substr(place + then.size());
    if (former == version()) return;
    versions_ += fmt::format("{}{}", then, version());
    log_.write({.kind = EventKind::version_changed,
                .severity = Severity::note,
                .step = simulation_.clock().step,
                .values = {{"former", former}, {"version", version()}}});
  }

  void serialize(Archive& archive) {
    archive.visit("versions", versions_);
    std::string configuration = configuration_;
    archive.visit("configuration", configuration);
    if (archive.is_restoring()) require_same_configuration(configuration);
    serialize_inside(archive, "run", [&] { run_.serialize(archive); });
  }

  /// Throws an Error if the checkpoint has other settings, apart from the length. A run that was killed while it was
  /// lengthened has a checkpoint with the former length.
  void require_same_configuration(std::string const& configuration) const {
    auto const difference = find_difference(setting_texts(configuration, "checkpoint"),
                                            setting_texts(configuration_, configuration_name), settings_of_length());
    if (!difference) return;
    throw Error({.what = fmt::format("its configuration is not the one of this directory: {}",
                                     to_text(*difference, "the checkpoint", configuration_name))});
  }

  /// Returns the note on the number of threads of the run.
  [[nodiscard]] Event processors_event() const {
    Event event{.kind = EventKind::threads_chosen,
                .severity = Severity::info,
                .step = simulation_.clock().step,
                .values = {{"threads", threads_of(setup_.configuration, hooks_.threads, processes_)}}};
    if (processes_.count() > 1) event.values.emplace_back("ranks", std::uint64_t{processes_.count()});
    return event;
  }

  void log_traffic() {
    std::vector<Traffic> const traffic = processes_.communicator().traffic_of_ranks();
    for (std::size_t process = 0; process < traffic.size(); ++process) {
      log_.write({.kind = EventKind::traffic_counted,
                  .severity = Severity::info,
                  .step = simulation_.clock().step,
                  .values = {{"rank", std::uint64_t{process}},
                             {"messages_sent", traffic[process].messages},
                             {"bytes_sent", traffic[process].bytes},
                             {"seconds_waiting", traffic[process].seconds_waiting}}});
    }
  }

  void save() {
    Clock const clock = simulation_.clock();
    std::uint64_t const work = simulation_.preparation().work;
    if (saved_at_ == clock && saved_work_ == work) return;
    attempt_to_save([&] {
      if (!run_.has_reached_end()) write_chain();
      write_checkpoint_of_all(
          directory_, [&](Archive& archive) { serialize(archive); }, processes_);
      saved_at_ = clock;
      saved_work_ = work;
      log_.write({.kind = EventKind::checkpoint_written, .severity = Severity::info, .step = clock.step});
    });
  }

  /// Saves the present state for `gridlock verify`, without the series and the writers of the run.
  void keep_state(std::uint64_t step) {
    attempt_to_save([&] {
      std::filesystem::path const directory = directory_of_state(directory_, step);
      processes_.on_root([&] {
        std::error_code ignored;  // write_checkpoint() names the reason
        std::filesystem::create_directories(directory, ignored);
      });
      write_checkpoint_of_all(
          directory,
          [&](Archive& archive) {
            archive.visit("configuration", configuration_);
            serialize_inside(archive, "simulation", [&] { simulation_.serialize(archive); });
          },
          processes_);
      // A run that was continued from before this state has kept it already.
      processes_.on_root([&] { remove_previous_checkpoint(directory); });
    });
  }

  /// Calls `save` and logs its failure, which does not end the run: its results are written at its end.
  void attempt_to_save(std::function<void()> const& save) {
    auto const warn = [&](std::string const& why) {
      // Parts of an incomplete checkpoint are removed, since a full disk needs their space.
      processes_.on_root([&] { remove_unneeded_parts(directory_); });
      log_.write({.kind = EventKind::checkpoint_failed,
                  .severity = Severity::warning,
                  .step = simulation_.clock().step,
                  .values = {{"why", why}}});
    };
    try {
      save();
    } catch (RunFailure const& failure) {
      warn(failure.what());
    } catch (Error const& error) {
      warn(error.problems().front().what);
    } catch (std::bad_alloc const&) {
      warn("not enough memory");
    }
  }

  /// Writes hashes.csv; `end` is the hash of the last state if the run is finished.
  void write_chain(std::optional<std::uint64_t> end = std::nullopt) {
    std::uint64_t const step = simulation_.clock().step;
    std::uint64_t const first_step = step - run_.extent().steps;
    std::vector<HashLink> links{{.of = "settings", .step = first_step, .hash = hash_of_settings(configuration_)},
                                {.of = "start", .step = first_step, .hash = start_hash_}};
    for (std::uint64_t const hash : simulation_.preparation().state_hashes) {
      links.push_back({.of = fmt::format("stage {}", links.size() - 1), .step = first_step, .hash = hash});
    }
    links.insert(links.end(), chain_.links().begin(), chain_.links().end());
    if (end) links.push_back({.of = "end", .step = step, .hash = *end});
    processes_.on_root([&] {
      record_result(directory_ / hashes_name);
      write_hashes(links, directory_ / hashes_name);
    });
  }

  std::filesystem::path directory_;
  Setup setup_;
  AllProcesses processes_;
  std::uint64_t start_hash_;
  RunHooks const& hooks_;
  RunLog log_;
  std::string configuration_;
  std::string versions_ = version();  ///< versions that carried out the run, in order
  RunPlan plan_;
  Simulation& simulation_;  ///< owned by setup_
  Run run_;
  HashChain chain_;
  std::optional<TrajectoryWriter> trajectory_;
  std::optional<Clock> saved_at_;  ///< clock of the newest checkpoint
  std::uint64_t saved_work_ = 0;   ///< work of the protocol at that checkpoint
};

std::string resolved(Configuration configuration, bool starts_from_file) {
  if (starts_from_file) {
    configuration.disks.file = "start.xyz";
    configuration.disks.frame.reset();
  }
  return to_toml(describing(configuration));
}

RunRecord continue_in(std::filesystem::path const& directory, std::optional<RunLength> length, RunHooks const& hooks) {
  AllProcesses const processes = hooks.processes;
  std::optional<DirectoryLock> lock;
  SettingsFile file;
  processes.on_root([&] {
    require_run(directory);
    lock.emplace(directory);
    file = settings_to_continue(directory, length);
  });
  length = processes.of_root(length);
  Setup setup = set_up(file, {.threads = hooks.threads, .processes = processes});
  Configuration configuration = setup.configuration;
  bool const starts_from_file = !setup.start_file.empty();
  processes.on_root([&] {
    std::vector<std::filesystem::path> files = run_files(directory, configuration);
    adopt_results(directory, files);
    // Checkpoints are left out, since restoring checks them and names an older one to continue from.
    std::erase_if(files, [](std::filesystem::path const& result) { return result.extension() == ".gridlock"; });
    protect_files({.results = files, .inputs = {}, .maker = "", .hint = "move what is in the way, and resume again"});
  });
  RunInDirectory run(directory, std::move(setup), resolved(configuration, starts_from_file), hooks);
  run.restore([&] {
    if (length) run.require_below_length();
  });
  if (length) {
    configuration.observe.equilibration = run.take_length();
    run.record_length(resolved(configuration, starts_from_file), length_text(*length));
  }
  return run.carry_out();
}

}  // namespace

std::string resolved_configuration(Setup const& setup) {
  return resolved(setup.configuration, !setup.start_file.empty());
}

RunRecord run_in(std::filesystem::path const& directory, Setup setup, RunHooks const& hooks) {
  std::optional<DirectoryLock> lock;
  setup.simulation->processes().on_root([&] {
    protect_files({.results = run_files(directory, setup.configuration),
                   .inputs = {setup.start_file},
                   .maker = "",
                   .hint = hint_of_directories});
    make_output_directory(directory);
    lock.emplace(directory);
  });
  std::string configuration = resolved_configuration(setup);
  RunInDirectory run(directory, std::move(setup), std::move(configuration), hooks);
  run.begin();
  return run.carry_out();
}

RunRecord resume_in(std::filesystem::path const& directory, RunHooks const& hooks) {
  return continue_in(directory, std::nullopt, hooks);
}

RunRecord lengthen_in(std::filesystem::path const& directory, RunLength const& length, RunHooks const& hooks) {
  return continue_in(directory, length, hooks);
}

}  // namespace gridlock
