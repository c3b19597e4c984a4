// Surfaces on the first rank alone, and the liquid on the others, which goes on meanwhile.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "solver/ranks.h"
#include "tools/runs/liquid.h"

namespace kappaflow {

/// On the first of several ranks, that has none of the liquid itself: what the others, which are at
/// serve_liquid(), tell it. They are one step of the surfaces ahead.
class DistantLiquid final : public Liquid {
 public:
  /// Throws what making the solver throws there. prepared: must outlive it. folder: of the run, to which the
  /// others write their particles where they tell only those near the surface; empty: they tell all.
  DistantLiquid(const PreparedScene& prepared, Ranks& ranks, std::filesystem::path folder = {});
  DistantLiquid(const DistantLiquid&) = delete;
  DistantLiquid& operator=(const DistantLiquid&) = delete;
  /// Ends serve_liquid().
  ~DistantLiquid() override;

  int ranks() const override { return ranks_.size() - 1; }
  double time() const override { return time_; }
  std::size_t steps() const override { return steps_; }
  bool tells_all() const override { return folder_.empty(); }
  Particles particles() const override { return record_.particles.particles; }
  std::vector<int> sources() const override { return record_.particles.source; }
  std::vector<BodyState> bodies() const override { return record_.bodies; }
  LiquidRecord record() const override { return record_; }
  /// After an error in a step of the surfaces for the particles alone, without what else a record has.
  bool can_be_asked() const override { return record_.particles.particles.size() > 0; }
  LiquidStep step(double until, bool last) override;
  bool can_be_saved() const override { return !begun_ || !saved_.empty(); }
  std::size_t count() const override { return record_.count; }
  void write_particles(const std::filesystem::path& folder, int frame) override;
  void write_state(StateWriter& archive) override;
  void read_state(StateReader& archive) override;

 private:
  void begin();

  const PreparedScene& prepared_;
  Ranks& ranks_;
  std::filesystem::path folder_;
  bool begun_ = false, restored_ = false;
  double time_ = 0;
  std::size_t steps_ = 0;
  LiquidRecord record_;  // of this time; between frames only particles
  std::string saved_;    // the state at time_, where it is known
};

/// What the ranks above 0 do for a DistantLiquid on the first one, until that is destroyed. order: with which
/// that has begun.
void serve_liquid(PreparedScene prepared, Ranks& ranks, const RankOrder& order);

}  // namespace kappaflow
