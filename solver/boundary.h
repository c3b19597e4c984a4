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
#include "solver/ranks.h"

namespace kappaflow {

/// Where liquid rests, in spacings from a wall's surface.
inline constexpr double kContactDistance = 0.5;

/// What the walls that a particle touches are for its heat, weighted as their friction.
struct WallHeatSum {
  float held = 0;         ///< share of those with a given temperature [1]
  float temperature = 0;  ///< their mean one [K]
  float flux = 0;         ///< mean into the liquid, 0 from those with another rule [W/m2]
};

/// What the walls contribute to each liquid particle. They mirror the particle's own pressure, so the sums
/// over wall particles b are constant within a step and the solvers' loops have no wall pairs. A particle has
/// one contact with all walls whose motion is prescribed, and one with each rigid body (rigid_bodies.h) that
/// it touches.
struct WallSums {
  static constexpr std::uint32_t kPrescribed = ~std::uint32_t{0};

  /// By particle, and one more: where its contacts begin in the arrays below.
  std::vector<std::uint32_t> first;
  /// Unit normal n out of the wall (zero between opposite walls); w: g [1/m2]. The friction of a no-slip wall
  /// of velocity v_w is the acceleration -nu g (I - n n^T)(v - v_w).
  std::vector<Vec4f> friction;
  /// v_w at the wall's surface, of a rigid body's motion at the particle [m/s]; w: -sum_b V_b v_b . grad
  /// W_ib, the wall's part in the rate of relative density [1/s]. Empty when no wall moves. RigidBodies
  /// writes those of the bodies.
  std::vector<Vec4f> velocity;
  /// Empty when no wall exchanges heat.
  std::vector<WallHeatSum> heat;
  /// Which rigid body, or kPrescribed; empty when there are none.
  std::vector<std::uint32_t> body;
  /// sum_b V_b grad W_ib [1/m]; empty likewise.
  std::vector<Vec4f> gradient;

  std::size_t bytes() const { return bytes_of(first, friction, velocity, heat, body, gradient); }
  bool touches(std::size_t i) const { return first[i] != first[i + 1]; }
  /// g (I - n n^T) u of one contact.
  Vec4f contact_drag(std::size_t contact, const Vec4f& u) const {
    const Vec4f f = friction[contact], n(f[0], f[1], f[2], 0);
    return f[3] * (u - n.dot(u) * n);
  }
  /// The same, summed over the particle's contacts.
  Vec4f drag(std::size_t i, const Vec4f& u) const {
    Vec4f sum = Vec4f::Zero();
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) sum += contact_drag(k, u);
    return sum;
  }
  /// The same for v_w.
  Vec4f drive(std::size_t i) const {
    Vec4f sum = Vec4f::Zero();
    if (velocity.empty()) return sum;
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) {
      const Vec4f v = velocity[k];
      sum += contact_drag(k, {v[0], v[1], v[2], 0});
    }
    return sum;
  }
  /// Rate of relative density that the walls' motion causes [1/s].
  float density_rate(std::size_t i) const {
    float sum = 0;
    if (velocity.empty()) return sum;
    for (std::uint32_t k = first[i]; k < first[i + 1]; ++k) sum += velocity[k][3];
    return sum;
  }
};

/// Walls with the same motion, or a rigid body.
struct WallBody {
  std::vector<WallSample> samples;  ///< as sample_walls() gives them, at t = 0
  BodyMotion motion;                ///< of a rigid body none, about its centre of mass
  std::vector<WallHeat> heat{};     ///< of each sample; empty: all are insulated
  bool rigid = false;               ///< a rigid body: it moves as place() says
};

/// The wall particles with their volumes, and the search for them. Every body is searched in its own frame,
/// so a motion costs no more than a change of coordinates.
class Walls {
 public:
  Walls(std::span<const WallBody> bodies, float spacing);

  std::size_t size() const;
  std::size_t bytes() const;
  /// Moves the walls whose motion is prescribed to where they are at `time` [s].
  void move_to(double time);
  /// Moves a rigid body, counted in the order of those given. pose: of its position at t = 0.
  void place(std::size_t rigid_body, const RigidPose& pose, const RigidVelocity& velocity);
  /// An upper bound of the walls' speed now [m/s].
  double fastest() const;

  /// Fills `sums` and adds to particles.density, gradient_sum the walls' part. Precondition: both hold the
  /// liquid's.
  void add_to(FluidParticles& particles, WallSums& sums);
  /// Share of a rigid body's particles that have liquid within the kernel's support.
  double wet_share(std::size_t rigid_body) const;

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
    bool rigid = false;
    std::vector<char> wet;  // of a rigid body, by sample: whether liquid is within the support
    bool moves() const { return rigid || !motion.at_rest(); }
  };
  struct Contact;
  /// As in WallSums, of a chunk.
  struct Found {
    std::vector<Vec4f> friction, velocity;
    std::vector<WallHeatSum> heat;
    std::vector<std::uint32_t> body;
    std::vector<Vec4f> gradient;
  };

  Body make_body(const WallBody& body) const;
  bool is_near(const Body& body, const Vec4f& x) const;
  Contact contact(Body& body, const Vec4f& x) const;
  void share_wet(Ranks& ranks);
  void add_to_chunk(std::size_t chunk, FluidParticles& particles, WallSums& sums);
  void add_contact(const Contact& sum, std::uint32_t body, std::size_t i, FluidParticles& particles,
                   Found& found) const;

  float spacing_, friction_scale_;
  CubicSpline kernel_;
  bool moving_ = false, heats_ = false, rigid_ = false;
  std::vector<Body> bodies_;
  std::vector<Found> found_;  // by chunk, with room to spare
  std::vector<std::size_t> first_of_chunk_;
};

}  // namespace kappaflow
