#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/pressure_ramp.hpp"
#include "gridlock/packing/quasistatic_shear.hpp"
#include "protocol/stage.hpp"

namespace gridlock {

namespace {

QuasistaticShearSettings shear_settings(StageSettings const& stage, ProtocolSettings const& protocol) {
  QuasistaticShearSettings settings{.minimizer = minimizer_settings(protocol, stage), .deformation = stage.deformation};
  settings.step = stage.strain_step.value_or(settings.step);
  settings.until_strain = stage.until_strain.value_or(settings.until_strain);
  settings.until_stress = stage.until_stress.value_or(settings.until_stress);
  settings.cycles = stage.cycles.value_or(0);
  settings.accuracy = stage.strain_accuracy.value_or(1e-3 * settings.step);
  settings.min_drop = stage.min_drop;
  return settings;
}

class ShearStage final : public Stage {
 public:
  ShearStage(ProtocolSettings const& protocol, std::size_t number, State const& state)
      : soft_(protocol.soft), shear_(shear_settings(protocol.stages[number], protocol), packing_of(state)) {}

  bool advance(State& state, ShouldContinue const& should_continue) override {
    if (!shear_.advance(should_continue)) return false;
    write_packing(shear_.packing(), state);
    auto const image_x = state.agents.column<ImageX>();
    auto const image_y = state.agents.column<ImageY>();
    std::vector<std::uint32_t> const rows = rows_in_order(state.agents.ids());
    std::vector<std::int32_t> const crossed_x = shear_.crossed_x();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      image_x[rows[i]] += crossed_x[i] + shear_.widths_shifted_back() * image_y[rows[i]];
      image_y[rows[i]] += shear_.crossed_y()[i];
    }
    return true;
  }
  void serialize(Archive& archive, State const& /*state*/) override { shear_.serialize(archive); }
  [[nodiscard]] std::uint64_t work() const override { return shear_.minimizer().iterations(); }
  [[nodiscard]] std::optional<ShearResult> shear_so_far() const override {
    return ShearResult{
        .minima = shear_.minima(), .events = shear_.events(), .motions = shear_.motions(), .cycles = shear_.cycles()};
  }
  [[nodiscard]] StageResult result(State const& state) const override {
    ContactNetwork const network = find_contact_network(shear_.packing(), soft_.potential);
    PressureLevel level = level_of(shear_.packing(), network);
    level.iterations = work();
    StageResult result{.packing_fraction = packing_fraction_of(state),
                       .is_converged = shear_.status() == ShearStatus::reached,
                       .levels = {level}};
    if (!*result.is_converged) result.packing_fraction_without_minimum = result.packing_fraction;
    result.shear = shear_so_far();
    add_end(network, soft_, result);
    return result;
  }

 private:
  SoftSettings soft_;
  QuasistaticShear shear_;
};

void check_shear(StageCheck const& check) {
  StageSettings const& stage = check.stage;
  if (stage.until_strain && *stage.until_strain == 0.0) {
    check.report("until_strain", "a stage \"shear\" cannot end at the strain 0", "give the strain at its end");
    return;
  }
  if (stage.cycles && stage.until_stress) {
    check.report("until_stress", "cycles of strain cannot end at a stress", "leave out cycles or until_stress");
  }
  try {
    require_valid(shear_settings(stage, {}));
  } catch (Error const& error) {
    for (Problem const& problem : error.problems())
      check.report(problem.key.substr(problem.key.find('.') + 1), problem.what, problem.hint);
  }
  double const step = stage.strain_step.value_or(QuasistaticShearSettings{}.step);
  if (stage.strain_accuracy && *stage.strain_accuracy > step) {
    check.report("strain_accuracy",
                 fmt::format("an accuracy of {} is more than a step of {}", *stage.strain_accuracy, step),
                 "use a smaller one");
  }
}

}  // namespace

StageRecord shear_stage() {
  return {.name = "shear",
          .documentation = "strains them in small steps and finds the minimum after each",
          .settings = {"deformation", "strain_step", "until_strain", "until_stress", "cycles", "strain_accuracy",
                       "min_drop"},
          .ends = {"until_strain"},
          .leaves_overlaps = true,
          .has_soft_disks = true,
          .needs_images = true,
          .may_end_without_pressure = true,
          .check = check_shear,
          .packing_fraction_after = [](StageSettings const&, std::optional<double> before) { return before; },
          .make = make_stage<ShearStage>};
}

}  // namespace gridlock
