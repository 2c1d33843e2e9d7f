#include "on_ranks.hpp"

#include "engine/ranks.hpp"
#include "engine/tiled/on_ranks.hpp"
#include "terminal.hpp"
#include "workspace/sweep_crew.hpp"

namespace gridlock::cli {

namespace {

/// Lets the others go, however the work ends.
class Lead {
 public:
  explicit Lead(CrewOptions const& crew) : crew_(crew) {}
  ~Lead() {
    tiled::release_helpers(crew_.ranks);
    crew_.crew.part();
  }
  Lead(Lead const&) = delete;
  Lead& operator=(Lead const&) = delete;

 private:
  CrewOptions const& crew_;
};

}  // namespace

ExitCode carry_out(CrewOptions const* crew, std::function<ExitCode(Ranks*)> const& work) {
  if (crew == nullptr) return work(nullptr);
  crew->crew.meet(0, "");
  if (crew->crew.leads()) {
    Lead const lead(*crew);
    return work(crew->ranks.count() > 1 ? &crew->ranks : nullptr);
  }
  // A request to stop is the leader's to carry out.
  StopSignals const signals;
  tiled::help(crew->ranks);
  crew->crew.part();
  return ExitCode::good;
}

}  // namespace gridlock::cli
