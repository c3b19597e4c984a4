// Walls in the solver's equations: Akinci, Ihmsen, Akinci, Solenthaler & Teschner, "Versatile rigid-fluid
// coupling for incompressible SPH" (2012).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/body_motion.h"
#include "core/cell_grid.h"
#include "solver/boundary_sampling.h"
#include "solver/fluid_particles.h"
#include "solver/heat_options.h"
#include "solver/kernel.h"

namespace kappaflow {

/// Where liquid rests, in spacings from a wall's surface.
inline constexpr double kContactDistance = 0.5;

/// What the walls that a particle touches are for its heat, weighted as their friction.
struct WallHeatSum {
  float held = 0;         ///< share of those with a given temperature [1]
  float temperature = 0;  ///< their mean one [K]
  float flux = 0;         ///< mean into the liquid, 0 from those with another rule [W/m2]
};

/// What the walls contribute to each liquid particle. They mirror the particle's own pressure and move as
/// prescribed, so these sums over the wall particles b are constant within a step and the solvers' loops have
/// no wall pairs.
struct WallSums {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// By particle: its place in the arrays below, kNone where no wall particle is within the support.
  std::vector<std::uint32_t> contact;
  /// Unit normal n out of the wall (zero between opposite walls); w: g [1/m2]. The friction of a no-slip wall
  /// of velocity v_w is the acceleration -nu g (I - n n^T)(v - v_w).
  std::vector<Vec4f> friction;
  /// v_w at the wall's surface [m/s]; w: -sum_b V_b v_b . grad W_ib, the wall's part in the rate of relative
  /// density [1/s]. Empty when no wall moves.
  std::vector<Vec4f> velocity;
  /// Empty when no wall exchanges heat.
  std::vector<WallHeatSum> heat;

  std::size_t bytes() const { return bytes_of(contact, friction, velocity, heat); }
  bool touches(std::size_t i) const { return contact[i] != kNone; }
  /// g (I - n n^T) u. Precondition: touches(i).
  Vec4f drag(std::size_t i, const Vec4f& u) const {
    const Vec4f f = friction[contact[i]], n(f[0], f[1], f[2], 0);
    return f[3] * (u - n.dot(u) * n);
  }
  /// The same for v_w.
  Vec4f drive(std::size_t i) const {
    if (velocity.empty()) return Vec4f::Zero();
    const Vec4f v = velocity[contact[i]];
    return drag(i, {v[0], v[1], v[2], 0});
  }
  /// Rate of relative density that the walls' motion causes [1/s].
  float density_rate(std::size_t i) const {
    return velocity.empty() || !touches(i) ? 0 : velocity[contact[i]][3];
  }
};

/// Walls with the same motion.
struct WallBody {
  std::vector<WallSample> samples;  ///< as sample_walls() gives them, at t = 0
  BodyMotion motion;
  std::vector<WallHeat> heat{};  ///< of each sample; empty: all are insulated
};

/// The wall particles with their volumes, and the search for them. Every body is searched in its own frame,
/// so a motion costs no more than a change of coordinates.
class Walls {
 public:
  Walls(std::span<const WallBody> bodies, float spacing);

  std::size_t size() const;
  std::size_t bytes() const;
  /// Moves the walls to where they are at `time` [s].
  void move_to(double time);
  /// An upper bound of the walls' speed now [m/s].
  double fastest() const;

  /// Fills `sums` and adds to particles.density, gradient_sum the walls' part. Precondition: both hold the
  /// liquid's.
  void add_to(FluidParticles& particles, WallSums& sums);

 private:
  static constexpr std::size_t kChunk = 256;  // particles whose contacts one task finds

  struct Body {
    CellGrid grid;
    std::vector<char> near;       // by cell of the grid: whether it or a cell beside it holds a sample
    std::vector<Vec4f> position;  // at t = 0, in cell order; w: volume [m3]
    std::vector<Eigen::Vector3f> normal;
    std::vector<Vec4f> heat;  // 1 and the temperature where it is given, the flux where that is, 0; or none
    BodyMotion motion;
    RigidPose pose;
    RigidVelocity velocity;
    double reach = 0;  // largest distance from the motion's point [m]
  };
  struct Contact;

  Body make_body(const WallBody& body) const;
  Contact contact(const Body& body, const Vec4f& x) const;
  void add_to_chunk(std::size_t chunk, FluidParticles& particles, WallSums& sums);

  float spacing_, friction_scale_;
  CubicSpline kernel_;
  bool moving_ = false, heats_ = false;
  std::vector<Body> bodies_;
  // By chunk, with room to spare.
  std::vector<std::vector<Vec4f>> found_friction_, found_velocity_;
  std::vector<std::vector<WallHeatSum>> found_heat_;
  std::vector<std::size_t> first_of_chunk_;
};

}  // namespace kappaflow
