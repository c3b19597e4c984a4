// Outflow regions: where particles of liquid are taken away.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/options.h"

namespace kappaflow {

struct FluidParticles;

/// Throws InvalidInput, which says what is allowed, for a region that is empty or not finite.
void check_outflow(const Outflow& outflow);

/// Whether the point is in the region or on its boundary.
bool is_in(const Outflow& outflow, const Vec3& x);

/// The outflow regions of a solver, at most 255.
class Outflows {
 public:
  /// Those of the options. Precondition: check_outflow() passes for each.
  explicit Outflows(const FluidOptions& options) : regions_(options.outflows) {}

  /// Takes away the particles that are in a region, the first one where regions overlap. The others keep
  /// their order.
  void take(FluidParticles& particles);

  /// How many particles each region has taken since the start.
  std::vector<std::size_t> taken(const FluidParticles& particles) const;

 private:
  struct Taken {
    std::uint32_t id;
    std::int32_t region;
  };

  std::vector<Outflow> regions_;
  std::vector<std::uint8_t> region_of_;  // of a particle; as many as there are regions: none
  std::vector<std::uint32_t> kept_;
  std::vector<Taken> taken_;  // in this step, by any rank
};

}  // namespace kappaflow
