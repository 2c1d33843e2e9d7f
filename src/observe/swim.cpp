#include "observe/swim.hpp"

namespace gridlock {

void SwimSpeed::begin(Snapshot const& start) {
  reset({{"effective_swim_speed", "",
          "Displacement of self-propelled disks along their headings, as a fraction of that of free disks."}});
  last_swum_ = start.counters.swum;
  last_if_free_ = start.counters.swum_if_free;
}

void SwimSpeed::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  double const swum = now.counters.swum - last_swum_;
  double const if_free = now.counters.swum_if_free - last_if_free_;
  last_swum_ = now.counters.swum;
  last_if_free_ = now.counters.swum_if_free;
  row[0] = if_free > 0.0 ? swum / if_free : no_value;
  if (counts_for_average && if_free > 0.0) average(0, row[0], if_free);
}

void SwimSpeed::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  archive.visit("last_swum", last_swum_);
  archive.visit("last_if_free", last_if_free_);
}

}  // namespace gridlock
