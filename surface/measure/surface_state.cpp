#include "surface/measure/surface_state.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/connectivity.h"
#include "core/shared_loop.h"
#include "surface/field/curvature.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/pointwise.h"

namespace kappaflow {
namespace {

// [1] Directions of a rigid motion that are this much less determined than the best are left at rest.
constexpr double kSingular = 1e-10;
// [1] A rotation counts as none when it moves the surface by this share of its speed or less.
constexpr double kNoRotation = 1e-6;

Vec3 tangential(const Vec3& v, const Vec3& normal) {
  return v - v.dot(normal) * normal;
}

void fill_geometry(const Field& field, std::span<const Vec3> position, SurfaceState& state) {
  state.normal.resize(position.size());
  state.gaussian_curvature.resize(position.size());
  state.mean_curvature.resize(position.size());
  shared_for(
      position.size(),
      [&](std::size_t v) {
        const Jet jet = field.jet(position[v]);
        const bool regular = has_gradient(jet);
        state.normal[v] = regular ? Vec3(-jet.g.normalized()) : Vec3::Zero();
        const CurvatureJet curvature = regular ? curvature_jet(jet) : CurvatureJet{};
        state.gaussian_curvature[v] = curvature.K;
        state.mean_curvature[v] = curvature.H;
      },
      kDefaultGrain, state.normal, state.gaussian_curvature, state.mean_curvature);
}

/// Material velocity and slip. A field that knows the velocity of its material nowhere leaves both empty;
/// where it knows none at a single vertex, the vertex counts as at rest and without slip.
void fill_material(const Field& field, std::span<const Vec3> position, SurfaceState& state) {
  std::vector<char> known(position.size());
  state.material_velocity.resize(position.size());
  state.material_slip.resize(position.size());
  shared_for(
      position.size(),
      [&](std::size_t v) {
        const std::optional<Vec3> material = field.material_velocity(position[v]);
        known[v] = material.has_value();
        state.material_velocity[v] = material.value_or(Vec3::Zero());
        state.material_slip[v] =
            known[v] ? tangential(state.motion.velocity[v] - *material, state.normal[v]).norm() : 0.0;
      },
      kDefaultGrain, known, state.material_velocity, state.material_slip);
  if (std::ranges::count(known, 1) > 0) return;
  state.material_velocity.clear();
  state.material_slip.clear();
}

double mean_square(std::span<const double> area, const auto& square) {
  const Vec2 sum = parallel_sum(area.size(), Vec2(Vec2::Zero()), [&](std::size_t v) -> Vec2 {
    return {area[v] * square(v), area[v]};
  });
  return sum[1] > 0 ? sum[0] / sum[1] : 0;
}

template <class T>
std::vector<T> gather(std::span<const T> values, std::span<const int> indices) {
  std::vector<T> gathered;
  gathered.reserve(indices.size());
  for (const int i : indices) gathered.push_back(values[i]);
  return gathered;
}

Vec3 weighted_mean(std::span<const double> area, std::span<const Vec3> value) {
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (std::size_t v = 0; v < value.size(); ++v) {
    sum += area[v] * value[v];
    total += area[v];
  }
  return total > 0 ? Vec3(sum / total) : Vec3::Zero();
}

std::optional<double> captured_by(std::span<const int> piece, const TriangleMesh& mesh,
                                  const SurfaceState& state, const Vec3& axis) {
  if (state.material_velocity.empty()) return std::nullopt;
  const std::vector<Vec3> position = gather<Vec3>(mesh.position, piece);
  const std::vector<Vec3> velocity = gather<Vec3>(state.motion.velocity, piece);
  const std::vector<Vec3> normal = gather<Vec3>(state.normal, piece);
  const std::vector<double> area = gather<double>(state.area, piece);
  // The method `material`: tangentially as the material, with the normal velocity that all methods share.
  std::vector<Vec3> material = gather<Vec3>(state.material_velocity, piece);
  for (std::size_t v = 0; v < piece.size(); ++v)
    material[v] = tangential(material[v], normal[v]) + velocity[v].dot(normal[v]) * normal[v];

  const double rotation = fitted_angular_velocity(position, area, material).dot(axis);
  const Vec3 centre = weighted_mean(area, position);
  const double radius =
      std::sqrt(mean_square(area, [&](std::size_t v) { return (position[v] - centre).squaredNorm(); }));
  const double speed = std::sqrt(mean_square(area, [&](std::size_t v) { return material[v].squaredNorm(); }));
  if (!(std::abs(rotation) * radius > kNoRotation * speed)) return std::nullopt;
  return fitted_angular_velocity(position, area, velocity).dot(axis) / rotation;
}

}  // namespace

SurfaceState surface_state(const Field& field, const TriangleMesh& mesh, const VertexRings& rings,
                           const VelocityFunction& method, const VelocityOptions& options) {
  SurfaceState state;
  state.area = vertex_areas(mesh.position, mesh.triangles);
  fill_geometry(field, mesh.position, state);
  method(field, {mesh.position, state.area, rings}, options, state.motion.sized(mesh.vertex_count()));
  fill_material(field, mesh.position, state);
  return state;
}

std::optional<double> slip(const SurfaceState& state) {
  if (state.material_slip.empty()) return std::nullopt;
  const double slip_square =
      mean_square(state.area, [&](std::size_t v) { return state.material_slip[v] * state.material_slip[v]; });
  const double speed_square = mean_square(state.area, [&](std::size_t v) {
    return tangential(state.material_velocity[v], state.normal[v]).squaredNorm();
  });
  if (!(speed_square > 0)) return std::nullopt;
  return std::sqrt(slip_square / speed_square);
}

std::vector<PieceRotation> rotation_by_piece(const TriangleMesh& mesh, const SurfaceState& state,
                                             const Vec3& axis) {
  std::vector<PieceRotation> rotations;
  for (const std::vector<int>& piece : members_by_piece(vertex_pieces(mesh.vertex_count(), mesh.triangles)))
    rotations.push_back({piece.size(), captured_by(piece, mesh, state, axis)});
  return rotations;
}

std::optional<double> largest_piece_rotation(std::span<const PieceRotation> pieces) {
  const auto largest = std::ranges::max_element(pieces, {}, &PieceRotation::vertices);
  return largest == pieces.end() ? std::nullopt : largest->captured;
}

Vec3 fitted_angular_velocity(std::span<const Vec3> position, std::span<const double> area,
                             std::span<const Vec3> velocity) {
  const Vec3 centre = weighted_mean(area, position), mean_velocity = weighted_mean(area, velocity);
  Mat3 inertia = Mat3::Zero();
  Vec3 momentum = Vec3::Zero();
  for (std::size_t v = 0; v < position.size(); ++v) {
    const Vec3 r = position[v] - centre;
    inertia += area[v] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    momentum += area[v] * r.cross(velocity[v] - mean_velocity);
  }
  // Pseudo-inverse: about the axis of points that lie on a line no rotation is determined.
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
  Vec3 inverse = Vec3::Zero();
  for (int a = 0; a < 3; ++a)
    if (eigen.eigenvalues()[a] > kSingular * eigen.eigenvalues()[2]) inverse[a] = 1 / eigen.eigenvalues()[a];
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose() * momentum;
}

}  // namespace kappaflow
