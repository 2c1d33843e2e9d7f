#include "gridlock/protocol/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/soft_disks.hpp"
#include "protocol/stage.hpp"

namespace gridlock {

namespace {

void serialize_optional(Archive& archive, std::string_view name, std::optional<double>& value) {
  // In an archive nan stands for a missing result.
  double number = value.value_or(std::numeric_limits<double>::quiet_NaN());
  archive.visit(name, number);
  value = number == number ? std::optional(number) : std::nullopt;
}

void serialize_optional(Archive& archive, std::string const& name, std::optional<bool>& value) {
  bool is_known = value.has_value();
  bool flag = value.value_or(false);
  archive.visit(name + "_is_known", is_known);
  archive.visit(name, flag);
  value = is_known ? std::optional(flag) : std::nullopt;
}

void serialize_swap(Archive& archive, SwapResult& swap) {
  serialize_optional(archive, "displacement_acceptance", swap.displacement_acceptance);
  serialize_optional(archive, "swap_acceptance", swap.swap_acceptance);
  serialize_optional(archive, "area_acceptance", swap.area_acceptance);
  serialize_optional(archive, "overlap_relaxation_time", swap.overlap_relaxation_time);
  serialize_optional(archive, "bond_relaxation_time", swap.bond_relaxation_time);
  serialize_optional(archive, "relaxation_times", swap.relaxation_times);
  serialize_optional(archive, "density_drift", swap.density_drift);
  archive.visit("is_equilibrated", swap.is_equilibrated);
  archive.visit("lags", swap.lags);
  archive.visit("self_overlap", swap.self_overlap);
  archive.visit("bond_orientation", swap.bond_orientation);
  archive.require(swap.self_overlap.size() == swap.lags.size() && swap.bond_orientation.size() == swap.lags.size(),
                  "the correlations of swap Monte Carlo differ in length");
  archive.visit("density_sweeps", swap.density_sweeps);
  archive.visit("packing_fractions", swap.packing_fractions);
  archive.visit("adjusting_stretches", swap.adjusting_stretches);
  archive.require(swap.packing_fractions.size() == swap.density_sweeps.size() &&
                      swap.adjusting_stretches <= swap.density_sweeps.size(),
                  "the packing fractions of Monte Carlo differ in length");
}

void serialize_result(Archive& archive, StageResult& result) {
  archive.visit("packing_fraction", result.packing_fraction);
  serialize_optional(archive, "pressure", result.pressure);
  serialize_optional(archive, "softest_mode", result.softest_mode);
  serialize_optional(archive, "is_converged", result.is_converged);
  serialize_optional(archive, "packing_fraction_without_minimum", result.packing_fraction_without_minimum);
  serialize_optional(archive, "mean_overlap", result.mean_overlap);
  serialize_optional(archive, "is_jammed", result.is_jammed);
  archive.visit("disks", result.disks);
  archive.visit("work", result.work);
  archive.visit("pair_collisions", result.pair_collisions);
  // Checkpoints of earlier versions have no state hash here.
  if (!archive.is_restoring() || archive.has("state_hash")) archive.visit("state_hash", result.state_hash);
  serialize_optional(archive, "jamming_packing_fraction", result.jamming_packing_fraction);
  serialize_optional(archive, "error_of_jamming_packing_fraction", result.error_of_jamming_packing_fraction);
  bool has_swap = result.swap.has_value();
  archive.visit("has_swap", has_swap);
  if (has_swap) {
    SwapResult swap = result.swap.value_or(SwapResult());
    serialize_inside(archive, "swap", [&] { serialize_swap(archive, swap); });
    result.swap = std::move(swap);
  }
  bool has_shear = result.shear.has_value();
  archive.visit("has_shear", has_shear);
  if (has_shear) {
    ShearResult shear = result.shear.value_or(ShearResult());
    serialize_inside(archive, "shear", [&] {
      serialize(archive, shear.minima);
      serialize(archive, shear.events);
      serialize(archive, shear.motions);
      serialize(archive, shear.cycles);
    });
    result.shear = std::move(shear);
  }
  serialize(archive, result.levels);
}

std::string text_of(Error const& error) {
  Problem const& problem = error.problems().front();
  return problem.hint.empty() ? problem.what : fmt::format("{}\n  hint: {}", problem.what, problem.hint);
}

/// Returns the subject of an error text, such as: stage 2 of the protocol, "quench",
std::string stage_text(std::size_t number, std::string_view kind) {
  return fmt::format("stage {} of the protocol, \"{}\",", number + 1, kind);
}

/// Returns the setting of a stage for the key that an engine or a ramp uses for it; other keys are returned unchanged.
std::string setting_of_stage(std::string const& key, std::size_t number, StageRecord const& record) {
  std::string const table = std::string(record.table_of_errors) + ".";
  if (!key.starts_with(table)) return key;
  std::string const name = key.substr(table.size());
  if (name == "kind") return fmt::format("protocol[{}].stage", number);
  for (std::string const& setting : {name, "until_" + name}) {
    if (std::ranges::find(record.settings, setting) != record.settings.end())
      return fmt::format("protocol[{}].{}", number, setting);
  }
  return key;
}

/// Returns an error of the start of a stage with the stage and its settings named in it.
Error located(Error const& error, std::size_t number, StageRecord const& record) {
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems) {
    problem.what = fmt::format("{} cannot begin: {}", stage_text(number, record.name), problem.what);
    problem.key = setting_of_stage(problem.key, number, record);
  }
  return Error(std::move(problems));
}

/// Copies the jamming packing fraction from the previous stage, which knows it for the same disks. A ramp that begins
/// at its end has a single minimum, from which it cannot extrapolate.
void take_over_jamming_packing_fraction(StageResult const& before, StageResult& result) {
  bool const is_same = result.levels.size() == 1 && result.packing_fraction == before.packing_fraction;
  if (!is_same || before.levels.empty() || result.jamming_packing_fraction) return;
  result.jamming_packing_fraction = before.jamming_packing_fraction;
  result.error_of_jamming_packing_fraction = before.error_of_jamming_packing_fraction;
}

}  // namespace

Protocol::Protocol(ProtocolSettings settings, State const& start) : settings_(std::move(settings)) {
  require_valid(settings_.stages, packing_fraction_of(start));
  for (StageSettings const& stage : settings_.stages) {
    StageRecord const& record = stage_record(stage.kind);
    if (record.has_soft_disks) require_equal_edges(start.box);
    bool const is_box_free = stage.box_shape == BoxShape::free;
    if ((record.needs_images || is_box_free) && !start.box.is_periodic()) {
      throw Error({.what = fmt::format("a stage \"{}\"{} in a box that is {}", record.name,
                                       is_box_free ? " with box_shape = \"free\"" : "", edges_in_words(start.box)),
                   .hint = "it needs a box without walls: box.edge = \"periodic\"",
                   .key = "box.edge"});
    }
  }
  // This call only refuses a stage that cannot begin; the stage itself begins later, with the disks as they are then.
  if (settings_.stages.empty()) return;
  StageRecord const& record = stage_record(settings_.stages.front().kind);
  if (record.require_start != nullptr) record.require_start(start);
  try {
    static_cast<void>(record.make(settings_, 0, start));
  } catch (Error const& error) {
    throw located(error, 0, record);
  }
}

Protocol::~Protocol() = default;

bool Protocol::advance(State& state, std::function<bool()> const& should_continue) {
  while (stage() < stages()) {
    begin_stage(state);
    std::string const& kind = settings_.stages[stage()].kind;
    try {
      if (!current_->advance(state, should_continue)) return false;
      StageResult result = current_->result(state);
      result.kind = kind;
      result.work = current_->work();
      result.disks = static_cast<double>(state.agents.size());
      result.state_hash = hash(state);
      if (!results_.empty()) take_over_jamming_packing_fraction(results_.back(), result);
      results_.push_back(std::move(result));
    } catch (RunFailure const& failure) {
      throw RunFailure(fmt::format("{} failed: {}", stage_text(stage(), kind), failure.what()));
    } catch (Error const& error) {
      throw RunFailure(fmt::format("{} failed: {}\n  hint: use more disks, or a lower packing fraction or pressure",
                                   stage_text(stage(), kind), error.problems().front().what));
    }
    current_ = nullptr;
  }
  return true;
}

void Protocol::begin_stage(State const& state) {
  if (current_) return;
  StageRecord const& record = stage_record(settings_.stages[stage()].kind);
  try {
    current_ = record.make(settings_, stage(), state);
  } catch (Error const& error) {
    throw RunFailure(text_of(located(error, stage(), record)));
  }
}

std::string Protocol::name_of_stage() const {
  return stage() < stages() ? settings_.stages[stage()].kind : std::string();
}

std::optional<ShearResult> Protocol::shear_so_far() const { return current_ ? current_->shear_so_far() : std::nullopt; }

std::uint64_t Protocol::work() const {
  std::uint64_t sum = current_ ? current_->work() : 0;
  for (StageResult const& result : results_) sum += result.work;
  return sum;
}

std::vector<std::uint64_t> Protocol::state_hashes() const {
  std::vector<std::uint64_t> hashes;
  for (StageResult const& result : results_) hashes.push_back(result.state_hash);
  return hashes;
}

void Protocol::serialize(Archive& archive, State const& state) {
  std::uint64_t ended = results_.size();
  archive.visit("stages_ended", ended);
  archive.require(ended <= stages(), "a protocol has ended more stages than it has");
  results_.resize(ended);
  for (std::size_t k = 0; k < ended; ++k) {
    results_[k].kind = settings_.stages[k].kind;
    serialize_inside(archive, fmt::format("result_{}", k), [&] { serialize_result(archive, results_[k]); });
  }
  bool has_begun = current_ != nullptr;
  archive.visit("has_begun", has_begun);
  archive.require(!has_begun || stage() < stages(), "a protocol has begun a stage that it does not have");
  if (archive.is_restoring())
    current_ = has_begun ? stage_record(settings_.stages[stage()].kind).make(settings_, stage(), state) : nullptr;
  if (current_) serialize_inside(archive, "stage", [&] { current_->serialize(archive, state); });
}

}  // namespace gridlock
