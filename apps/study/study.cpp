#include "study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "workspace/result_files.hpp"

namespace gridlock {

void Study::write(Table const& table, std::string const& file) {
  record_result(path_of(file));
  write_csv(table, path_of(file));
  add_file(file);
}

void Study::draw(State const& state, PictureSettings const& settings, std::string const& name) {
  if (!on_drawing_(name)) return;
  for (char const* extension : {".svg", ".png"}) {
    record_result(path_of(name + extension));
    draw_disks(state, settings, path_of(name + extension));
    add_file(name + extension);
  }
}

void Study::draw(Plot const& plot) {
  if (!on_drawing_(plot.name)) return;
  for (char const* extension : {".gp", ".svg", ".png"}) record_result(path_of(plot.name + extension));
  try {
    PlotOutcome const outcome = draw_plot(plot, settings_.output);
    add_file(plot.name + ".gp");
    if (outcome == PlotOutcome::gnuplot_is_missing) {
      note(plot.name + ": gnuplot is not installed; the script is there to be drawn later");
      return;
    }
    for (char const* extension : {".svg", ".png"}) add_file(plot.name + extension);
  } catch (std::exception const& error) {
    note(plot.name + ": " + error.what());
  }
}

std::string to_text(Estimate const& estimate) {
  std::string const sign = estimate.value < 0.0 ? "−" : "";
  double const size = std::abs(estimate.value);
  if (!estimate.error || !(*estimate.error > 0.0)) return fmt::format("{}{:.4g}", sign, size);
  int const leading = static_cast<int>(std::floor(std::log10(*estimate.error)));
  int const decimals = std::clamp(1 - leading, 0, 12);
  return fmt::format("{}{:.{}f} ± {:.{}f}", sign, size, decimals, *estimate.error, decimals);
}

State start_state(PaperExtent const& extent, StartKind start, double packing_fraction, std::uint64_t seed) {
  Configuration configuration;
  configuration.disks = {.count = extent.disks, .packing_fraction = packing_fraction, .start = start};
  configuration.run.seed = seed;
  configuration.run.steps = 1;
  return disks_of(set_up(configuration));
}

}  // namespace gridlock
