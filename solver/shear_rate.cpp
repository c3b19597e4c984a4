#include "solver/shear_rate.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "solver/lanes.h"

namespace kappaflow {
namespace {

// Of C, whose eigenvalues are 1 inside of liquid and 1/2 across a free surface: below it a direction counts
// as one without neighbours. What the gradient loses is the square of its share.
constexpr float kFewest = 0.01f;

struct Moments {
  Eigen::Matrix3f velocity, position;  // B, C
};

Moments of_pairs(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                 const std::vector<Vec4f>& v) {
  const Vec4f &xi = particles.position[i], &vi = v[i];
  std::array<Wide, 9> b;
  std::array<Wide, 6> c;
  b.fill(Wide::Zero());
  c.fill(Wide::Zero());
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block), vj = gather(v, block);
    const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
    const Wide weight = -lists.factor(block);
    const Wide wx = weight * x, wy = weight * y, wz = weight * z;
    const Wide u[3] = {vi[0] - vj.x, vi[1] - vj.y, vi[2] - vj.z};
    for (std::size_t k = 0; k < 3; ++k) {
      b[3 * k] += u[k] * wx;
      b[3 * k + 1] += u[k] * wy;
      b[3 * k + 2] += u[k] * wz;
    }
    c[0] += wx * x;
    c[1] += wy * y;
    c[2] += wz * z;
    c[3] += wy * z;
    c[4] += wx * z;
    c[5] += wx * y;
  }
  Moments m;
  for (std::size_t k = 0; k < 3; ++k)
    m.velocity.row(static_cast<Eigen::Index>(k)) =
        sums(b[3 * k], b[3 * k + 1], b[3 * k + 2]).head<3>().transpose();
  const Vec4f diagonal = sums(c[0], c[1], c[2]), others = sums(c[3], c[4], c[5]);
  m.position << diagonal[0], others[2], others[1], others[2], diagonal[1], others[0], others[1], others[0],
      diagonal[2];
  return m;
}

void add_wall(const Vec4f& v, const WallSums& walls, std::size_t contact, float spacing, float slip,
              Moments& m) {
  const Vec4f friction = walls.friction[contact];
  const Eigen::Vector3f n = friction.head<3>();
  const float distance = static_cast<float>(kContactDistance) * spacing;
  const float weight = std::min(1.0f, friction[3] * spacing * distance);  // 1 where the first layer rests
  Eigen::Vector3f u = v.head<3>();
  if (!walls.velocity.empty()) u -= walls.velocity[contact].head<3>();
  const Eigen::Vector3f across = n.dot(u) * n;
  m.velocity += weight / distance * (across + slip * (u - across)) * n.transpose();
  m.position += weight * n * n.transpose();
}

}  // namespace

float shear_rate(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                 const WallSums& walls, const std::vector<Vec4f>& v, float spacing, float slip) {
  Moments m = of_pairs(i, particles, lists, v);
  for (std::uint32_t k = walls.first[i]; k < walls.first[i + 1]; ++k)
    add_wall(v[i], walls, k, spacing, slip, m);
  // Neighbours along one line leave two eigenvalues to kFewest: single precision could not invert that.
  const Eigen::Matrix3d position = m.position.cast<double>();
  const Eigen::Matrix3d square =
      position * position + double{kFewest} * kFewest * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3f gradient = m.velocity * (square.inverse() * position).eval().cast<float>();
  Eigen::Matrix3f strain = (gradient + gradient.transpose()) / 2;
  strain.diagonal().array() -= strain.trace() / 3;
  return std::sqrt(2 * strain.squaredNorm());
}

}  // namespace kappaflow
