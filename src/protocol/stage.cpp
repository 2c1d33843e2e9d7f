#include "protocol/stage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

namespace gridlock {

/// All kinds of stages. A new kind takes one line here, one in stage.hpp, and a file of its own.
std::span<StageRecord const> stage_records() {
  static std::array const records{grow_stage(),        run_stage(),        quench_stage(),   compress_stage(),
                                  decompress_stage(),  shear_stage(),      separate_stage(), swap_stage(),
                                  monte_carlo_stage(), event_chain_stage()};
  return records;
}

StageRecord const& stage_record(std::string_view kind) {
  auto const found = std::ranges::find(stage_records(), kind, &StageRecord::name);
  if (found != stage_records().end()) return *found;
  throw Error({.what = fmt::format("the stage \"{}\" is not known", kind),
               .hint = fmt::format("a stage is one of: {}", fmt::join(stage_kinds(), ", ")),
               .key = "protocol"});
}

std::vector<std::string> stage_kinds() {
  std::vector<std::string> kinds;
  for (StageRecord const& record : stage_records()) kinds.emplace_back(record.name);
  return kinds;
}

bool leaves_overlaps(std::string_view kind) { return stage_record(kind).leaves_overlaps; }

std::optional<double> packing_fraction_at_end(StageSettings const& stage, std::optional<double> /*before*/) {
  return stage.until_pressure ? std::nullopt : stage.until_packing_fraction;
}

void StageCheck::report(std::string_view setting, std::string what, std::string hint) const {
  problems.push_back({.what = std::move(what),
                      .hint = std::move(hint),
                      .key = setting.empty() ? place : fmt::format("{}.{}", place, setting)});
}

void StageCheck::report_pressure(std::string hint) const {
  report("until_pressure",
         fmt::format("a stage \"{}\" cannot end at a pressure of {}", stage.kind, *stage.until_pressure),
         std::move(hint));
}

void StageCheck::check_direction(bool leads_up, std::string_view opposite) const {
  if (!packing_fraction || !stage.until_packing_fraction) return;
  double const before = *packing_fraction;
  double const end = *stage.until_packing_fraction;
  constexpr double rounding = 1e-9;
  if (leads_up ? end >= before * (1.0 - rounding) : end <= before * (1.0 + rounding)) return;
  std::string const other = opposite.empty() ? "" : fmt::format(", or a stage \"{}\"", opposite);
  report("until_packing_fraction",
         fmt::format("a stage \"{}\" leads {}, but the packing fraction is {:.6g}, and the stage ends at {:.6g}",
                     stage.kind, leads_up ? "up" : "down", before, end),
         fmt::format("use a value {} {:.6g}{}", leads_up ? "above" : "below", before, other));
}

}  // namespace gridlock
