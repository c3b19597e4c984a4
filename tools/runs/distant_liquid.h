// Surfaces on the first ranks, and the liquid on the others, which goes on meanwhile.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "solver/ranks.h"
#include "tools/runs/liquid.h"

namespace kappaflow {

/// The ranks of a run whose surfaces are apart: the first ones follow these, the others share the liquid.
struct RanksApart {
  Ranks& all;
  int surface_ranks = 1;        ///< how many follow them
  bool is_near = false;         ///< whether these are told of the particles near the surface alone
  std::shared_ptr<Ranks> part;  ///< of this rank: those that do the same

  bool has_surfaces() const { return all.rank() < surface_ranks; }
};

/// All ranks call it, the first with what it wants, the others after RankTask::serve.
RanksApart set_apart(Ranks& all, int surfaces = 1, bool is_near = false);

/// On a rank with the surfaces, that has none of the liquid itself: what the others, which are at
/// serve_liquid(), tell the first one, and that the other ones with the surfaces. They are one step of the
/// surfaces ahead.
class DistantLiquid final : public Liquid {
 public:
  /// Throws what making the solver throws there. prepared: must outlive it. folder: of the run, to which the
  /// others write their particles where they tell only those near the surface.
  DistantLiquid(const PreparedScene& prepared, RanksApart ranks, std::filesystem::path folder = {});
  DistantLiquid(const DistantLiquid&) = delete;
  DistantLiquid& operator=(const DistantLiquid&) = delete;
  /// On the first rank, ends serve_liquid(), and what the other ones with surfaces are at.
  ~DistantLiquid() override;

  int ranks() const override { return ranks_.all.size() - ranks_.surface_ranks; }
  double time() const override { return time_; }
  std::size_t steps() const override { return steps_; }
  bool tells_all() const override { return !ranks_.is_near; }
  Particles particles() const override { return record_.particles.particles; }
  std::vector<int> sources() const override { return record_.particles.source; }
  std::vector<BodyState> bodies() const override { return record_.bodies; }
  LiquidRecord record() const override { return record_; }
  /// After an error in a step of the surfaces for the particles alone, without what else a record has.
  bool can_be_asked() const override { return record_.particles.particles.size() > 0; }
  LiquidStep step(double until, bool last) override;
  bool can_be_saved() const override { return !begun_ || is_saved_; }
  std::size_t count() const override { return record_.count; }
  void write_particles(const std::filesystem::path& folder, int frame) override;
  Ranks* surface_ranks() const override { return ranks_.surface_ranks > 1 ? ranks_.part.get() : nullptr; }
  void write_state(StateWriter& archive) override;
  /// On the ranks above the first: time() and steps() alone.
  void read_state(StateReader& archive) override;

 private:
  bool is_first() const { return ranks_.all.rank() == 0; }
  int teller() const { return ranks_.surface_ranks; }  // the first rank of the liquid
  void begin();
  void end_others();
  std::string hear();

  const PreparedScene& prepared_;
  RanksApart ranks_;
  std::filesystem::path folder_;
  bool begun_ = false, restored_ = false, is_saved_ = false;
  double time_ = 0;
  std::size_t steps_ = 0;
  LiquidRecord record_;  // of this time; between frames only particles
  std::string saved_;    // the state at time_, where it is known, on the first rank
};

/// What the ranks without surfaces do for a DistantLiquid, until that is destroyed.
void serve_liquid(PreparedScene prepared, RanksApart ranks);

}  // namespace kappaflow
