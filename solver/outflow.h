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
  explicit Outflows(const FluidOptions& options) : regions_(options.outflows), taken_(regions_.size(), 0) {}

  /// Takes away the particles that are in a region, the first one where regions overlap. The others keep
  /// their order.
  void take(FluidParticles& particles);

  /// How many particles each region has taken since the start, on all ranks.
  const std::vector<std::size_t>& taken() const { return taken_; }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(taken_);
  }

 private:
  std::vector<Outflow> regions_;
  std::vector<std::uint8_t> region_of_;  // of a particle; as many as there are regions: none
  std::vector<std::uint32_t> kept_;
  std::vector<std::size_t> taken_;  // by each region
};

}  // namespace kappaflow
