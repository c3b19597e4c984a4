// Liquid of which the ranks with the surfaces are told the particles near them, while each rank that shares
// it writes its own to files: where it is too much for one machine.
#pragma once

#include <filesystem>

#include "tools/runs/liquid.h"

namespace kappaflow {

/// A rank's part of it.
class LiquidPart {
 public:
  /// ranks: that share it, or nullptr. All must outlive the part.
  LiquidPart(const Scene& scene, const FluidSolver& fluid, Ranks* ranks)
      : scene_(scene), fluid_(fluid), ranks_(ranks) {}

  /// On the first rank, for which the others must be at follow(): particles near the surface, see
  /// near_surface_of(); known: and what else is known of them, and of all of the liquid.
  LiquidRecord near_surface(bool known);
  /// Likewise: all ranks write their particle_piece() of a frame into the run's folder, and to the
  /// disk. Throws IoError there where one of them cannot.
  void write_particles(const std::filesystem::path& folder, int frame);
  /// On the others: does what the first one has ordered.
  void follow(const RankOrder& order);

 private:
  void measure(const ParticleFrame& own, LiquidRecord& record) const;
  void write_own(const std::filesystem::path& folder, int frame) const;
  void announce(const RankOrder& order);

  const Scene& scene_;
  const FluidSolver& fluid_;
  Ranks* ranks_;
};

/// On the first of the ranks that share it.
class NearLiquid final : public OwnLiquid {
 public:
  /// scene: must outlive it.
  NearLiquid(const Scene& scene, FluidSolver fluid, Ranks* ranks)
      : OwnLiquid(scene, std::move(fluid), ranks != nullptr ? ranks->size() : 1),
        part_(scene, this->fluid(), ranks) {}

  bool tells_all() const override { return false; }
  Particles particles() const override { return part_.near_surface(false).particles.particles; }
  std::vector<int> sources() const override { return part_.near_surface(true).particles.source; }
  LiquidRecord record() const override { return part_.near_surface(true); }
  void write_particles(const std::filesystem::path& folder, int frame) override {
    part_.write_particles(folder, frame);
  }

 private:
  mutable LiquidPart part_;
};

}  // namespace kappaflow
