#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/detail/free_names.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/model/detail/steps_from_homes.hpp"
#include "gridlock/model/model.hpp"
#include "gridlock/parallel/detail/agent_homes.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/tasks.hpp"
#include "gridlock/simulation/detail/agents_of_rank.hpp"
#include "gridlock/simulation/model_simulation.hpp"

namespace gridlock {

/// The agents of a model whose home is on this rank: all that lie in memory between steps. The leader knows which names
/// are free.
template <class Model>
class ModelOfRank final : public AgentsOfRank {
 public:
  using Agents = typename World<Model>::Agents;

  /// Makes the start, each rank its own agents where they are functions of their numbers, or those of a share; else the
  /// leader makes all, hands them out and forgets them. All ranks call it. `blame(act)` calls act and says what of the
  /// settings is wrong.
  /// Errors: Error, on all ranks.
  ModelOfRank(Communicator& ranks, Model const& model, Box const& box, std::uint64_t seed, std::uint64_t threads,
              std::function<void(std::function<void()> const&)> const& blame)
      : ranks_(ranks), model_(model), threads_(threads), own_{.box = box, .agents = {}, .clock = {}, .seed = seed} {
    agree_on_errors(ranks_, [&] { blame([&] { make_start(); }); });
    if constexpr (!has_first_agents<Model>()) send_home();
    require_inside(blame);
    look_at_all_agents();
    require_cutoff_fits(box, steps_.cutoff, Model::name);
    notes_ = notes_of(model_, own_, ranks_);
  }

  /// What the model says of its start.
  [[nodiscard]] std::vector<std::string> const& notes() const { return notes_; }

  [[nodiscard]] Box const& box() const override { return own_.box; }
  [[nodiscard]] Clock const& clock() const override { return own_.clock; }
  void set_clock(Clock const& clock) override { own_.clock = clock; }
  [[nodiscard]] std::uint64_t seed() const override { return own_.seed; }
  [[nodiscard]] AgentsView view() const override { return own_.agents; }
  [[nodiscard]] std::vector<NamedColumn> columns() override { return columns_of(own_.agents); }
  [[nodiscard]] std::shared_ptr<void> release_columns() override { return own_.agents.release(); }
  [[nodiscard]] Snapshot snapshot(Counters const& counters, Communicator& processes) const override {
    return {own_, counters, processes, count()};
  }
  [[nodiscard]] std::uint64_t sum_of_hashes() const override { return gridlock::sum_of_hashes(own_.agents); }
  [[nodiscard]] std::size_t count() const override { return agents_; }

  [[nodiscard]] std::vector<std::unique_ptr<Observable>> make_observables(ObserveSettings const& settings,
                                                                          Snapshot const& start) const override {
    std::vector<std::unique_ptr<Observable>> observables;
    observables.push_back(std::make_unique<ModelObservations<Model>>(model_, own_));
    observables.front()->begin(start);
    for (auto& observable : gridlock::make_observables(settings, start, {.keeps_counters = keeps_counters<Model>()})) {
      observables.push_back(std::move(observable));
    }
    return observables;
  }

  void serialize(Archive& archive) override {
    gridlock::serialize(archive, own_, [&] {
      own_.agents.serialize_rows(archive);
      names_.serialize(archive);
    });
    if (!archive.is_restoring()) return;
    // A file can hold anything.
    try {
      ModelEngine<Model>::require_inside(own_);
    } catch (RunFailure const& failure) {
      throw Error(Problem{.what = failure.what()});
    }
  }

  void bring_home() override {
    send_home();
    look_at_all_agents();
    agree_on_errors(ranks_, [&] {
      auto const names = own_.agents.ids();
      if (std::ranges::adjacent_find(names) == names.end()) return;
      throw Error(Problem{.what = "two agents of the checkpoint have one name"});
    });
  }

  [[nodiscard]] ArrangedAgents arranged() const override {
    auto const ids = own_.agents.ids();
    std::vector<Id> const first = first_ids_of_blocks(ranks_, ids);
    AgentRows<Agents> rows = exchanged_agents<Agents>(ranks_, ids, own_.agents.values(), [&](std::size_t row) {
      return static_cast<std::size_t>(std::ranges::upper_bound(first, ids[row]) - first.begin()) - 1;
    });
    sort_agents(rows);
    auto const agents = std::make_shared<Agents>();
    agents->become(rows.ids, rows.values);
    std::vector<std::uint64_t> begins{0};
    for (Message const& bytes : all_gather(ranks_, message_of(std::uint64_t{agents->size()}))) {
      begins.push_back(begins.back() + MessageReader(bytes).next<std::uint64_t>());
    }
    return {.rows = RowDivision(std::move(begins)), .own = std::as_const(*agents), .memory = agents};
  }

  bool carry_out(TaskOfRanks task, MessageReader& message) override {
    if (task != TaskOfRanks::steps_from_homes) return false;
    follow_steps_from_homes(ranks_, model_, steps_.cells, message, own_, agents_);
    return true;
  }

  void advance(Counters& counters, StopCondition const& stop_condition) override {
    lead_steps_from_homes(ranks_, model_, steps_, threads_, own_, counters, agents_, names_, stop_condition);
  }
  [[nodiscard]] double time_step() const override { return steps_.time_step; }
  [[nodiscard]] std::vector<Count> event_counts(Counters const& /*counters*/) const override {
    return counts_of_events(own_);
  }
  void require_valid() const override {}

 private:
  /// The agents of this rank or of its share; or all, on the leader.
  void make_start() {
    if constexpr (has_first_agents<Model>()) {
      AgentRows<Agents> rows;
      std::uint64_t const all = model_.agents_at_start();
      for (Id number = ranks_.rank(); number < all; number += ranks_.count()) {
        rows.ids.push_back(number);
        rows.values.resize(rows.ids.size());
        rows.values.put(rows.ids.size() - 1, model_.first_agent(own_, number));
      }
      own_.agents.become(rows.ids, rows.values);
      names_ = FreeNames(all, {});
    } else if constexpr (has_shared_start<Model>()) {
      ShareOfRows const share(ranks_, RowDivision::even(model_.agents_at_start(), ranks_.count()));
      start_share(model_, own_, share);
      // The model has added them as if they were the first.
      AgentRows<Agents> rows;
      own_.agents.become(rows.ids, rows.values);
      for (std::size_t row = 0; row < rows.ids.size(); ++row) rows.ids[row] = share.first() + row;
      own_.agents.become(rows.ids, rows.values);
      names_ = FreeNames(share.all(), {});
    } else if (ranks_.rank() == 0) {
      model_.start(own_);
      names_ = own_.agents.free_names();
    }
  }

  /// Errors: Error, on all ranks, for the agent that one process would name.
  void require_inside(std::function<void(std::function<void()> const&)> const& blame) const {
    constexpr Id nobody = std::numeric_limits<Id>::max();
    std::size_t const row = find_outside(own_.box, own_.agents.template column<X>(), own_.agents.template column<Y>());
    Id const own = row < own_.agents.size() ? own_.agents.ids()[row] : nobody;
    Id first = nobody;
    for (Message const& bytes : all_gather(ranks_, message_of(own))) {
      first = std::min(first, MessageReader(bytes).next<Id>());
    }
    agree_on_errors(ranks_, [&] {
      if (own != nobody && own == first) blame([&] { ModelEngine<Model>::require_inside(own_); });
    });
  }

  void look_at_all_agents() {
    agents_ = all_sum(ranks_, own_.agents.size());
    steps_ = steps_of(ranks_, model_, own_);
  }

  void send_home() {
    AgentRows<Agents> rows;
    own_.agents.become(rows.ids, rows.values);
    gridlock::bring_home(ranks_, rows);
    own_.agents.become(rows.ids, rows.values);
  }

  Communicator& ranks_;
  Model model_;
  std::uint64_t threads_;
  World<Model> own_;
  std::size_t agents_ = 0;  ///< of all ranks
  StepsOfModel steps_;      ///< as the run began or was restored
  std::vector<std::string> notes_;
  FreeNames names_;  ///< on the leader
};

}  // namespace gridlock
