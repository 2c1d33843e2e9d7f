#include "observe/unused_settings.hpp"

namespace gridlock {

std::string_view unused_because_of(ObserveSettings const& settings, std::string_view setting) {
  struct Needed {
    std::string_view setting;
    bool is_used;
    std::string_view choice;
  };
  for (Needed const& needed :
       {Needed{"equilibration", settings.per_decade == 0, "observe.per_decade"},
        Needed{"displacement_lag", settings.per_decade == 0, "observe.per_decade"},
        Needed{"velocity_origin_every", settings.per_decade == 0, "observe.per_decade"},
        Needed{"density_profile", settings.per_decade == 0, "observe.per_decade"},
        Needed{"viscosity_lag", settings.per_decade == 0, "observe.per_decade"},
        Needed{"free_flights", settings.per_decade == 0, "observe.per_decade"},
        Needed{"pair_correlation_range", settings.structure_every > 0, "observe.structure_every = 0"},
        Needed{"pair_correlation_bins", settings.structure_every > 0, "observe.structure_every = 0"},
        Needed{"orientation_correlation", settings.structure_every > 0, "observe.structure_every = 0"},
        Needed{"density_profile_bins", settings.density_profile != ProfileAxes::none,
               "observe.density_profile = \"none\""},
        Needed{"cluster_cutoff", settings.clusters_every > 0, "observe.clusters_every = 0"},
        Needed{"local_density_side", settings.local_density_every > 0, "observe.local_density_every = 0"},
        Needed{"displacement_origin_every", settings.displacement_lag > 0, "observe.displacement_lag = 0"},
        Needed{"flux_position", settings.flux_line != FluxLine::none, "observe.flux_line = \"none\""}}) {
    if (needed.setting == setting && !needed.is_used) return needed.choice;
  }
  return {};
}

}  // namespace gridlock
