#include "gridlock/workspace/sweep.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "pictures.hpp"
#include "terminal.hpp"
#include "verbs.hpp"
#include "workspace/sweep_crew.hpp"

namespace gridlock::cli {

namespace {

struct SweepOptions {
  ConfigurationOptions configuration;
  OutputOptions output;
  unsigned threads = 0;
  std::size_t processes_of_run = 1;
  std::string shard;
  bool draws = true;
  bool is_quiet = false;
  SweepCrew* crew = nullptr;
};

/// Returns the shard for a text such as "2/8"; nothing for an empty text.
std::optional<gridlock::Shard> shard_of(std::string const& text) {
  if (text.empty()) return std::nullopt;
  gridlock::Shard shard;
  std::size_t const slash = text.find('/');
  auto const read = [](std::string_view digits, std::size_t& number) {
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    return error == std::errc{} && end == digits.data() + digits.size();
  };
  bool const is_read = slash != std::string::npos && read(std::string_view(text).substr(0, slash), shard.number) &&
                       read(std::string_view(text).substr(slash + 1), shard.count);
  if (!is_read || shard.number < 1 || shard.number > shard.count) {
    throw gridlock::Error({.what = fmt::format("\"{}\" is not a shard", text),
                           .hint = "--shard 2/8 is the second of eight parts",
                           .key = "--shard"});
  }
  return shard;
}

/// Prints the result of a shard. Runs of other shards are not carried out, which is no failure.
ExitCode finish_shard(gridlock::Shard const& shard, std::size_t all, gridlock::SweepResult const& result,
                      std::filesystem::path const& directory) {
  std::size_t const ours = (all + shard.count - shard.number) / shard.count;
  std::size_t const others = all - ours;
  std::size_t const open = result.interruptions > others ? result.interruptions - others : 0;
  fmt::print("shard {} of {}: {} runs, {} failed, {} stopped early; {} collect {} makes the tables\n", shard.number,
             shard.count, ours, result.failures, open, program_name(), directory.string());
  return result.failures == 0 && open == 0 ? ExitCode::good : ExitCode::run_failed;
}

/// Returns the swept values of a run without its seed, by which runs that differ only in the seed are recognized.
std::vector<std::string> values_but_seed(SweepPlan const& plan, std::string const& name) {
  auto const run = std::ranges::find(plan.runs, name, &SweepRun::name);
  if (run == plan.runs.end()) return {name};
  std::vector<std::string> values = run->values;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (plan.keys[k] == "run.seed") values[k].clear();
  }
  return values;
}

/// Prints failures as "seed=1: why". Runs whose reasons differ only in digits and seeds share one line.
void print_failures(SweepPlan const& plan, std::vector<std::string> const& messages) {
  struct Group {
    std::vector<std::string> values;
    std::string reason;  ///< message without the name of the run and without digits
    std::string message;
    std::vector<std::string> others = {};  ///< names of further runs with this reason
  };
  std::vector<Group> groups;
  for (std::string const& message : messages) {
    std::size_t const colon = std::min(message.find(": "), message.size());
    std::string const name = message.substr(0, colon);
    Group group{.values = values_but_seed(plan, name), .reason = message.substr(colon), .message = message};
    std::erase_if(group.reason, [](char letter) { return letter >= '0' && letter <= '9'; });
    auto const known = std::ranges::find_if(
        groups, [&](Group const& other) { return other.values == group.values && other.reason == group.reason; });
    if (known == groups.end()) {
      groups.push_back(std::move(group));
    } else {
      known->others.push_back(name);
    }
  }
  for (Group const& group : groups) {
    fmt::print(stderr, "error: {}\n", group.message);
    if (!group.others.empty()) fmt::print(stderr, "  the same of {}\n", fmt::join(group.others, ", "));
  }
}

ExitCode sweep(SweepOptions const& options) {
  auto const shard = shard_of(options.shard);
  gridlock::SweepPlan const plan = gridlock::plan_sweep(options.configuration.read());
  auto const directory =
      options.output.directory_for(std::filesystem::path(options.configuration.file).stem().string());

  StopSignals const signals;
  gridlock::SweepResult result;
  {
    ProgressLine line;
    result =
        gridlock::run_sweep(plan, {.directory = directory,
                                   .overwrites = options.output.overwrites,
                                   .shard = shard,
                                   .threads = options.threads,
                                   .on_progress =
                                       [&](gridlock::SweepProgress const& progress) {
                                         if (!options.is_quiet) {
                                           line.show(progress.fraction, progress.seconds,
                                                     fmt::format("{} of {} runs", progress.finished, progress.all));
                                         }
                                         return !StopSignals::is_stop_asked();
                                       },
                                   .crew = options.crew,
                                   .settings_file = options.configuration.file});
  }
  // Only the leader has the results and prints them.
  if (options.crew != nullptr && !options.crew->leads()) return ExitCode::good;
  if (!options.is_quiet) {
    for (std::string const& note : result.notes) fmt::print(stderr, "note: {}\n", note);
  }
  if (!shard && options.draws) draw_pictures(directory, options.is_quiet);
  print_failures(plan, result.messages);
  if (shard) return finish_shard(*shard, plan.runs.size(), result, directory);
  std::size_t const good = plan.runs.size() - result.failures - result.interruptions;
  if (!options.is_quiet) {
    fmt::print("{} of {} runs finished; sweep.csv, means.csv and runs/ in {}\n", good, plan.runs.size(),
               directory.string());
  }
  if (good == plan.runs.size()) return ExitCode::good;
  if (result.failures > 0) {
    fmt::print(
        stderr,
        "{} of {} runs failed; fix the cause and run the same command again: finished runs are kept, failed ones "
        "are retried\n",
        result.failures, plan.runs.size());
  }
  if (result.interruptions > 0) {
    fmt::print(stderr, "{} of {} runs were stopped early; the same command{} continues them in {}\n",
               result.interruptions, plan.runs.size(), options.output.overwrites ? " without --overwrite" : "",
               directory.string());
  }
  return ExitCode::run_failed;
}

/// Throws if MPI allows only one thread, but a rank must exchange messages while it carries out a shared run.
void require_threads_that_send(CrewOptions const& crew, SweepOptions const& options) {
  if (options.processes_of_run == 1 || crew.has_threads_that_send) return;
  throw gridlock::Error({.what = "this MPI lets only one thread of each rank send messages (no MPI_THREAD_MULTIPLE)",
                         .hint = "leave it out, so that each run has one rank, or use an MPI built with threads",
                         .key = "--ranks-per-run"});
}

}  // namespace

void add_sweep(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew) {
  CLI::App* const verb = app.add_subcommand("sweep", "Run every combination of the values listed under [sweep]");
  auto const options = std::make_shared<SweepOptions>();
  options->configuration.add_to(*verb);
  options->output.add_to(*verb, "results/<name of FILE>");
  CLI::Option* const threads = verb->add_option("-j,--threads", options->threads,
                                                crew == nullptr ? "Runs at a time; left out: one for each core"
                                                                : "Runs at a time in each rank; left out: one")
                                   ->check(whole_number(1, 4096));
  if (crew == nullptr) {
    verb->add_option("--shard", options->shard, "Make only part I of N, for one of N jobs; gridlock collect joins them")
        ->type_name("I/N");
  } else {
    options->crew = &crew->crew;
    verb->add_option("--ranks-per-run", options->processes_of_run,
                     "Ranks that share each run, of tiled or a synchronous or tiled model; left out: one")
        ->check(whole_number(1))
        ->excludes(threads);
  }
  verb->add_flag("--pictures,!--no-pictures", options->draws,
                 "Draw the results against what varies, as gridlock plot DIR does");
  verb->add_flag("-q,--quiet", options->is_quiet, "Print errors only");
  verb->callback([options, &exit_code, crew] {
    if (crew != nullptr) {
      require_threads_that_send(*crew, *options);
      crew->set_runs_at_a_time(std::max(1U, options->threads));
      crew->set_processes_of_run(options->processes_of_run);
    }
    exit_code = sweep(*options);
  });
}

}  // namespace gridlock::cli
