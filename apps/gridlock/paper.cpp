#include "study/paper.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <memory>

#include "gridlock/workspace/run_directory.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

struct PaperOptions {
  bool is_quick = false;
  bool is_full = false;
  int figure = 0;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  bool is_quiet = false;
  OutputOptions output;
};

gridlock::PaperSettings settings_of(PaperOptions const& options) {
  gridlock::PaperSettings settings{.extent = options.is_full ? gridlock::full_paper() : gridlock::quick_paper(),
                                   .output = options.output.directory_for("paper"),
                                   .overwrites = options.output.overwrites,
                                   .threads = options.threads,
                                   .seed = options.seed};
  if (options.figure != 0) settings.figure = options.figure;
  return settings;
}

char const* word_for(gridlock::Verdict verdict) {
  switch (verdict) {
    case gridlock::Verdict::agrees:
      return "agrees";
    case gridlock::Verdict::differs:
      return "differs";
    case gridlock::Verdict::undecided:
      break;
  }
  return "not decided";
}

ExitCode make_paper(PaperOptions const& options) {
  gridlock::PaperSettings const settings = settings_of(options);
  gridlock::open_run_directory(settings.output, options.output.overwrites);
  StopSignals const signals;
  gridlock::PaperResult result;
  {
    ProgressLine line;
    result = gridlock::run_paper(settings, [&](gridlock::PaperProgress const& progress) {
      if (!options.is_quiet) line.show(progress.fraction, progress.seconds, progress.what);
      return !StopSignals::is_stop_asked();
    });
  }
  for (std::string const& note : result.notes) fmt::print(stderr, "note: {}\n", note);
  if (result.status != gridlock::RunStatus::finished) {
    // Figure 5 is made of timings alone.
    std::string const partial_results = (settings.output / "partial_results").string();
    // Figure 5 is made of timings alone.
    std::string const finished = result.simulations == 0
                                     ? fmt::format("{} holds the timings that are finished", partial_results)
                                     : fmt::format("{} holds {} finished simulations of {}", partial_results,
                                                   result.finished_simulations, result.simulations);
    fmt::print(stderr, "{}: {}; the same command{} does the rest\n", gridlock::to_text(result.status), finished,
               settings.overwrites ? " without --overwrite" : "");
    return ExitCode::run_failed;
  }
  if (!options.is_quiet) {
    for (gridlock::PaperClaim const& claim : result.claims) {
      fmt::print("{:<12} {}: {}\n", word_for(claim.verdict), claim.where, claim.statement);
    }
    fmt::print("{} in {}; open {}\n", gridlock::to_text(result.status), duration_text(result.seconds),
               (settings.output / "report.html").string());
  }
  return ExitCode::good;
}

}  // namespace

void add_paper(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("paper", "Make the paper's Figures 4 to 7 and check its claims");
  auto const options = std::make_shared<PaperOptions>();
  auto* const quick = verb->add_flag("--quick", options->is_quick,
                                     "Figure 7 with the paper's 100,000 steps and one seed, all else with 10,000; "
                                     "about three minutes on two cores (default)");
  verb->add_flag("--full", options->is_full, "The paper's 100,000 steps, about half an hour on two cores")
      ->excludes(quick);
  verb->add_option("--figure", options->figure, "Make this figure alone")->check(whole_number(4, 7));
  verb->add_option("--seed", options->seed, "The seeds of the runs are this one and those after it")
      ->check(whole_number(0));
  verb->add_option("-j,--threads", options->threads, "Simulations at a time; left out: one for each core")
      ->check(whole_number(1, 4096));
  verb->add_flag("-q,--quiet", options->is_quiet, "Print errors only");
  options->output.add_to(*verb, "results/paper");
  verb->callback([options, &exit_code] { exit_code = make_paper(*options); });
}

}  // namespace gridlock::cli
