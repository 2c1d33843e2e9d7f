#include "study/paper.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <string_view>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "study/figure_5.hpp"
#include "study/figures.hpp"
#include "workspace/job_pool.hpp"
#include "workspace/result_files.hpp"

namespace gridlock {

namespace {

constexpr int first_figure = 4;
constexpr int last_figure = 7;
constexpr char const* report_name = "report.html";

Error impossible(std::string what, std::string hint) {
  return Error({.what = std::move(what), .hint = std::move(hint), .key = "paper"});
}

void require_possible(PaperSettings const& settings) {
  PaperExtent const& extent = settings.extent;
  if (settings.figure && (*settings.figure < first_figure || *settings.figure > last_figure)) {
    throw impossible(fmt::format("the study has no Figure {}", *settings.figure), "use 4, 5, 6 or 7");
  }
  auto const is_length = [](PaperLength const& length) {
    return length.steps > 0 && length.sample_every > 0 && length.seeds > 0;
  };
  bool const has_counts = is_length(extent.figure_6) && is_length(extent.figure_7) && extent.timing_repeats > 0 &&
                          extent.plateau_seeds > 0 && extent.choice_seeds > 0;
  bool const has_values = !extent.engines.empty() && !extent.square_densities.empty() &&
                          !extent.triangular_densities.empty() && !extent.fan_densities.empty() &&
                          !extent.timing_counts.empty() && !extent.choice_time_steps.empty();
  bool const has_no_orders = extent.order_square_densities.empty() && extent.order_triangular_densities.empty() &&
                             extent.order_periodic_densities.empty();
  bool const has_order_counts =
      extent.order_diameters > 0.0 && !extent.order_time_steps.empty() && extent.order_seeds > 0;
  if (!has_counts || !has_values || !(has_no_orders || has_order_counts)) {
    throw impossible("the extent of the study is empty in part", "start from quick_paper() or full_paper()");
  }
  auto const is_sorted = [](std::vector<double> const& densities) { return std::ranges::is_sorted(densities); };
  if (!is_sorted(extent.square_densities) || !is_sorted(extent.triangular_densities)) {
    throw impossible("the packing fractions of the study do not rise", "sort them");
  }
  if (!fits_neighbourhoods(extent)) {
    throw impossible(
        "the disks of Figure 5 are too large for its finest neighbourhoods, so blocks would be wider than 3×3",
        "let timing_counts reach 700 disks or more");
  }
}

/// Shares the progress among the parts of the study by the seconds each is expected to take.
class Progression {
 public:
  Progression(OnPaperProgress const& on_progress, std::vector<double> parts)
      : on_progress_(on_progress), parts_(std::move(parts)) {}

  /// Reports how far the present part is; says whether to continue.
  bool report(double share_of_part, std::string const& what) {
    if (is_stopped_ || !on_progress_) return !is_stopped_;
    double all = 0.0;
    double done = 0.0;
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      all += parts_[part];
      if (part < present_) done += parts_[part];
    }
    if (present_ < parts_.size()) done += parts_[present_] * share_of_part;
    is_stopped_ = !on_progress_({.fraction = all > 0.0 ? done / all : 1.0, .seconds = seconds(), .what = what});
    return !is_stopped_;
  }
  void next_part() { ++present_; }

  [[nodiscard]] bool is_stopped() const { return is_stopped_; }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  OnPaperProgress const& on_progress_;
  std::vector<double> parts_;
  std::size_t present_ = 0;
  bool is_stopped_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Which claims hold, at one look; what was measured is in the chapters.
PageTable overview_of(std::vector<PaperClaim> const& claims) {
  PageTable table{.header = {"where", "the paper says", "verdict"}};
  for (PaperClaim const& claim : claims) {
    std::string where = claim.where;
    // "Figure 5" stays on one line, however narrow its column.
    if (std::size_t const space = where.find(' '); space != std::string::npos) where.replace(space, 1, "\u00a0");
    table.rows.push_back({where, claim.statement, claim.verdict});
  }
  return table;
}

PageTable table_of(std::vector<PaperClaim> const& claims) {
  PageTable table{.header = {"the paper says", "measured here", "verdict"}};
  for (PaperClaim const& claim : claims) table.rows.push_back({claim.statement, claim.measured, claim.verdict});
  return table;
}

void add_to(Page& page, Chapter const& chapter, Study& study) {
  page.heading(chapter.title);
  for (std::string const& text : chapter.introduction) page.paragraph(text);
  for (Drawing const& drawing : chapter.drawings) {
    std::vector<std::filesystem::path> files;
    for (std::string const& file : drawing.files) files.push_back(study.path_of(file));
    // A plot that could not be drawn has left a note, which is at the end of the report.
    std::erase_if(files, [](std::filesystem::path const& file) { return !std::filesystem::exists(file); });
    if (!files.empty()) page.figure(files, drawing.caption);
  }
  if (!chapter.claims.empty()) page.table(table_of(chapter.claims));
  for (PageTable const& table : chapter.tables) page.table(table);
  for (std::string const& text : chapter.conclusions) page.paragraph(text);
}

std::string summary_of(std::vector<PaperClaim> const& claims) {
  auto const count = [&](Verdict verdict) { return std::ranges::count(claims, verdict, &PaperClaim::verdict); };
  return fmt::format("Verdicts: {} agree, {} differ, {} undecided.", count(Verdict::agrees), count(Verdict::differs),
                     count(Verdict::undecided));
}

/// What a reader is to take away, from the verdicts alone.
std::string conclusion_of(std::vector<PaperClaim> const& claims) {
  std::vector<std::string> differing;
  for (PaperClaim const& claim : claims) {
    if (claim.verdict == Verdict::differs) differing.push_back(fmt::format("“{}” ({})", claim.statement, claim.where));
  }
  auto const agreeing = std::ranges::count(claims, Verdict::agrees, &PaperClaim::verdict);
  auto const open = static_cast<std::ptrdiff_t>(claims.size() - differing.size()) - agreeing;
  std::string text = fmt::format("What to conclude: {} of the {} claims tested here hold", agreeing, claims.size());
  if (open > 0) text += fmt::format(", these runs cannot decide {}", open);
  return differing.empty() ? text + "." : fmt::format("{}, and these do not: {}", text, fmt::join(differing, " "));
}

/// The part of the study that makes one section of the report.
struct Part {
  std::optional<int> figure;  ///< none: made only with all figures
  void (*plan)(Study&) = nullptr;
  Chapter (*make)(Study&) = nullptr;
};

constexpr Part parts[] = {
    {4, nullptr, figure_4},
    {5, nullptr, nullptr},  // measured on its own, before anything runs beside it
    {6, plan_figure_6, figure_6},
    {7, plan_figure_7, figure_7},
    {std::nullopt, plan_open_choices, open_choices},
    {std::nullopt, nullptr, physics_or_step},
    {std::nullopt, plan_turn_order, turn_order},
};

/// The study in progress.
class PaperStudy {
 public:
  PaperStudy(PaperSettings const& settings, OnPaperProgress const& on_progress)
      : settings_(settings),
        study_(settings, [this](std::string const& name) { return report_drawing("drawing " + name); }),
        progression_(on_progress, expected_seconds()) {}

  PaperResult run() {
    is_resumed_ = study_.runs.finished() > 0;
    measure_times();
    simulate_all();
    for (Part const& part : parts) {
      if (is_wanted(part) && !progression_.is_stopped()) make(part);
    }
    return finish();
  }

 private:
  [[nodiscard]] bool is_wanted(Part const& part) const { return !settings_.figure || part.figure == settings_.figure; }
  [[nodiscard]] bool is_wanted(int figure) const { return !settings_.figure || *settings_.figure == figure; }

  std::vector<double> expected_seconds() {
    for (Part const& part : parts) {
      if (part.plan && is_wanted(part)) part.plan(study_);
    }
    study_.runs.keep_in(study_.partial_results);
    constexpr double seconds_per_disk_step = 2e-7;
    constexpr double seconds_for_pictures = 4.0;
    return {is_wanted(5) ? seconds_to_measure(settings_.extent) : 0.0,
            study_.runs.work() * seconds_per_disk_step / jobs_for(settings_.threads), seconds_for_pictures};
  }

  void measure_times() {
    if (is_wanted(5)) {
      costs_ = measure_step_costs(study_, [&](double share) {
        return progression_.report(share, "Figure 5: counting distances and timing steps");
      });
    }
    progression_.next_part();
  }

  void simulate_all() {
    if (study_.runs.size() > 0 && !progression_.is_stopped()) {
      study_.runs.run_all(settings_.threads, [&](double share, std::size_t finished) {
        return progression_.report(share, fmt::format("{} of {} simulations", finished, study_.runs.size()));
      });
      if (!progression_.is_stopped()) study_.write(study_.runs.rows(), "runs.csv");
    }
    progression_.next_part();
  }

  void make(Part const& part) {
    if (part.figure == 5) {
      if (!costs_.empty()) chapters_.push_back(figure_5(study_, costs_));
    } else {
      chapters_.push_back(part.make(study_));
    }
    report_drawing("drawing");
  }

  bool report_drawing(std::string const& what) {
    double const made = static_cast<double>(chapters_.size()) / static_cast<double>(std::size(parts));
    return progression_.report(std::min(made, 1.0), what);
  }

  PaperResult finish() {
    for (std::string const& failure : study_.runs.failures()) study_.note(failure);
    if (std::string const problem = study_.partial_results.problem(); !problem.empty()) {
      study_.note("partial results were not all kept: " + problem);
    }
    PaperResult result{.status = progression_.is_stopped() ? RunStatus::interrupted : RunStatus::finished,
                       .simulations = study_.runs.size(),
                       .finished_simulations = study_.runs.finished()};
    result.seconds = progression_.seconds();
    if (result.status == RunStatus::finished) {
      for (Chapter const& chapter : chapters_) std::ranges::copy(chapter.claims, std::back_inserter(result.claims));
      write_report(result);
      study_.partial_results.remove_all();
    }
    result.files = study_.files();
    result.notes = study_.notes();
    return result;
  }

  [[nodiscard]] std::string runs_text() const {
    if (study_.runs.size() == 0) return "";
    return fmt::format(" Each of the {} simulations is listed in runs.csv with its settings and state hash.",
                       study_.runs.size());
  }

  void write_report(PaperResult const& result) {
    Page page("The paper's figures, made afresh",
              fmt::format(
                  "Agent based simulations and optimization with uniform grid applied to colloidal jamming transitions "
                  "(J.-X. Shen). {}",
                  summary_of(result.claims)));
    page.paragraph(
        fmt::format("Extent: {}. Gridlock {}, seed {}, {:.0f} s{}. Every plot has its data (.csv) and script (.gp) "
                    "beside it.{}",
                    settings_.extent.name, version(), settings_.seed, result.seconds,
                    is_resumed_ ? " since the last interruption" : "", runs_text()));
    if (!result.claims.empty()) page.paragraph(conclusion_of(result.claims));
    page.heading("Claim by claim");
    page.table(overview_of(result.claims));
    for (Chapter const& chapter : chapters_) {
      add_to(page, chapter, study_);
    }
    if (!study_.notes().empty()) {
      page.heading("What went wrong");
      page.list(study_.notes());
    }
    record_result(study_.path_of(report_name));
    write_file(study_.path_of(report_name), page.html());
    study_.add_file(report_name);
  }

  PaperSettings const& settings_;
  Study study_;
  Progression progression_;
  std::vector<StepCost> costs_;
  std::vector<Chapter> chapters_;
  bool is_resumed_ = false;
};

}  // namespace

PaperExtent quick_paper() {
  return {.name = "quick",
          .figure_6 = {.steps = 10'000, .sample_every = 20, .seeds = 3},
          .figure_7 = {.steps = 100'000, .sample_every = 200, .seeds = 1, .densest_of_others = 0.76},
          .square_densities = {0.1, 0.3, 0.5, 0.6, 0.66, 0.69, 0.72, 0.75, 0.78},
          .triangular_densities = {0.1, 0.3, 0.5, 0.6, 0.66, 0.69, 0.72, 0.76, 0.8, 0.84},
          .fan_densities = {0.1, 0.3, 0.5, 0.6, 0.66, 0.69, 0.72, 0.75, 0.8, 0.84},
          .timing_counts = {225, 400, 625, 900, 1000, 1225, 1600, 2000, 2209, 2304, 2401, 2500},
          .timing_repeats = 3,
          .plateau_densities = {0.1},
          .plateau_seeds = 4,
          .choice_time_steps = {0.05, 0.1, 0.2},
          .choice_diameters = 150.0,
          .choice_seeds = 5,
          .choice_square_densities = {0.66, 0.74},
          .choice_triangular_densities = {0.8},
          .order_diameters = 128.0,
          .order_time_steps = {0.1, 0.025},
          .order_seeds = 8,
          .order_square_densities = {0.3, 0.6, 0.7},
          .order_triangular_densities = {0.7, 0.8},
          .order_periodic_densities = {0.3, 0.7}};
}

PaperExtent full_paper() {
  return {.name = "full",
          .figure_6 = {.steps = 100'000, .sample_every = 100, .seeds = 4},
          .figure_7 = {.steps = 100'000, .sample_every = 100, .seeds = 4},
          .square_densities = {0.05, 0.1,  0.2, 0.3,  0.4,  0.5,  0.55, 0.6,  0.62, 0.64, 0.66,
                               0.68, 0.69, 0.7, 0.71, 0.72, 0.73, 0.74, 0.75, 0.76, 0.77, 0.78},
          .triangular_densities = {0.05, 0.1, 0.2,  0.3,  0.4,  0.5,  0.55, 0.6,  0.62, 0.64, 0.66, 0.68,
                                   0.69, 0.7, 0.71, 0.72, 0.73, 0.74, 0.76, 0.78, 0.8,  0.82, 0.84, 0.86},
          .fan_densities = {0.1, 0.3, 0.5, 0.6, 0.66, 0.69, 0.71, 0.73, 0.76, 0.8, 0.84},
          .timing_counts = {225, 400, 625, 900, 1000, 1225, 1600, 2000, 2209, 2304, 2401, 2500},
          .timing_repeats = 9,
          .plateau_densities = {0.1, 0.3, 0.5},
          .plateau_seeds = 8,
          .plateau_relaxations = 20,
          .choice_time_steps = {0.025, 0.05, 0.1, 0.2},
          .choice_diameters = 1000.0,
          .choice_seeds = 4,
          .choice_square_densities = {0.5, 0.66, 0.7, 0.74, 0.77},
          .choice_triangular_densities = {0.7, 0.74, 0.8, 0.84},
          .order_diameters = 512.0,
          .order_time_steps = {0.1, 0.025},
          .order_seeds = 10,
          .order_square_densities = {0.1, 0.3, 0.5, 0.66, 0.7, 0.74},
          .order_triangular_densities = {0.7, 0.74, 0.8, 0.84},
          .order_periodic_densities = {0.3, 0.5, 0.7}};
}

PaperResult run_paper(PaperSettings const& settings, OnPaperProgress const& on_progress) {
  require_possible(settings);
  make_output_directory(settings.output);
  DirectoryLock const lock(settings.output);
  if (settings.overwrites) PartialResults(settings.output / partial_results_name).remove_all();
  // Last to come and first to go: a directory with a report holds a finished study.
  std::error_code ignored;
  std::filesystem::remove(settings.output / report_name, ignored);
  return PaperStudy(settings, on_progress).run();
}

}  // namespace gridlock
