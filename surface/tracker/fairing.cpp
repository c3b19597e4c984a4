// Fujisawa, Mandachi, Miura 2011, section 3.4.
#include "surface/tracker/fairing.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/connectivity.h"
#include "core/shared_loop.h"
#include "core/triangle_geometry.h"

namespace kappaflow {
namespace {

using Mat2 = Eigen::Matrix2d;

// [mean rest lengths of the vertex's springs] A longer move could fold triangles over.
constexpr double kLongestMove = 0.25;
// [1] Share of a spring's stiffness that is added in every direction, for rings that have folded into a line.
constexpr double kRegularisation = 1e-3;

/// Two orthonormal rows that span the plane normal to the unit vector n (Duff et al. 2017).
Eigen::Matrix<double, 2, 3> plane_basis(const Vec3& n) {
  const double sign = std::copysign(1.0, n[2]);
  const double a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
  Eigen::Matrix<double, 2, 3> basis;
  basis << 1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0], b, sign + n[1] * n[1] * a, -n[1];
  return basis;
}

/// A Newton step in the tangent plane towards the equilibrium of the springs that end at vertex v.
Vec3 spring_move(const VertexRings& rings, std::span<const double> rest_length,
                 std::span<const Vec3> position, const Vec3& gradient, int v) {
  const Eigen::Matrix<double, 2, 3> plane = plane_basis(gradient.normalized());
  Vec2 force = Vec2::Zero();
  Mat2 stiffness = Mat2::Zero();
  double rest_sum = 0;
  const int begin = rings.start[v], end = rings.start[v + 1];
  for (int k = begin; k < end; ++k) {
    const Vec3 edge = position[rings.neighbour[k]] - position[v];
    const Vec2 in_plane = plane * edge;
    const double length = edge.norm(), length_in_plane = in_plane.norm(), rest = rest_length[k];
    rest_sum += rest;
    if (!(length_in_plane > 0)) continue;
    const Vec2 direction = in_plane / length_in_plane;
    force += (length - rest) * direction;
    // A compressed spring would push sideways; leaving that out keeps the matrix positive.
    const double across = std::max(0.0, 1 - rest / length);
    stiffness +=
        (1 - across) * direction * direction.transpose() + (across + kRegularisation) * Mat2::Identity();
  }
  if (begin == end) return Vec3::Zero();
  const Vec3 move = plane.transpose() * (stiffness.inverse() * force);
  const double longest = kLongestMove * rest_sum / (end - begin), distance = move.norm();
  return distance > longest ? Vec3(move * (longest / distance)) : move;
}

/// Whether a triangle at vertex v looks inward, i.e. along the gradients of its corners.
bool is_folded(const VertexRings& rings, std::span<const int> third_corner, const TriangleMesh& mesh, int v) {
  const std::vector<Vec3>& position = mesh.position;
  for (int k = rings.start[v]; k < rings.start[v + 1]; ++k) {
    const int b = rings.neighbour[k], c = third_corner[k];
    const Vec3 outward = twice_area_vector(position[v], position[b], position[c]);
    if (outward.dot(mesh.gradient[v] + mesh.gradient[b] + mesh.gradient[c]) > 0) return true;
  }
  return false;
}

/// From vertex v to the centroid of its neighbours.
Vec3 centroid_move(std::span<const int> ring, std::span<const Vec3> position, int v) {
  if (ring.empty()) return Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  for (const int neighbour : ring) sum += position[neighbour] - position[v];
  return sum / static_cast<double>(ring.size());
}

bool is_lost(const VertexRings& rings, const TriangleMesh& mesh, const FairingState& state, int v) {
  return mesh.unprojected[v] || is_folded(rings, state.third_corner, mesh, v);
}

/// Vertices that have somewhere to go, and their neighbours, whose triangles they could fold.
void find_moving(const VertexRings& rings, const TriangleMesh& mesh, FairingState& state) {
  state.restless.resize(mesh.vertex_count());
  parallel_for(mesh.vertex_count(), [&](std::size_t v) {
    state.restless[v] = mesh.mobility[v] > 0 || is_lost(rings, mesh, state, static_cast<int>(v));
  });
  state.moving.clear();
  const auto is_restless = [&](int v) { return state.restless[v] != 0; };
  for (int v = 0; v < static_cast<int>(mesh.vertex_count()); ++v)
    if (is_restless(v) || std::ranges::any_of(rings.of(v), is_restless)) state.moving.push_back(v);
  state.moved_position.resize(state.moving.size());
  state.moved_gradient.resize(state.moving.size());
  state.moved_unprojected.resize(state.moving.size());
}

void relax_vertices(const VertexRings& rings, double relaxation, const TriangleMesh& mesh,
                    FairingState& state) {
  shared_for(
      state.moving.size(),
      [&](std::size_t k) {
        const int v = state.moving[k];
        const bool lost = is_lost(rings, mesh, state, v);
        const double share = relaxation * (lost ? 1 : mesh.mobility[v]);
        state.moved_position[k] = mesh.position[v];
        if (!(share > 0)) return;
        const Vec3 move = lost ? centroid_move(rings.of(v), mesh.position, v)
                               : spring_move(rings, state.rest_length, mesh.position, mesh.gradient[v], v);
        state.moved_position[k] += share * move;
      },
      kDefaultGrain, state.moved_position);
}

void take_moved(const FairingState& state, TriangleMesh& mesh) {
  parallel_for(state.moving.size(), [&](std::size_t k) {
    const int v = state.moving[k];
    mesh.position[v] = state.moved_position[k];
    mesh.gradient[v] = state.moved_gradient[k];
    mesh.unprojected[v] = state.moved_unprojected[k];
  });
}

/// Rest lengths go the share 1 - exp(-dt/time) of the way to the current lengths.
void relax_rest_lengths(const VertexRings& rings, std::span<const Vec3> position, double share,
                        std::span<double> rest_length) {
  parallel_for(position.size(), [&](std::size_t v) {
    for (int k = rings.start[v]; k < rings.start[v + 1]; ++k)
      rest_length[k] += share * ((position[rings.neighbour[k]] - position[v]).norm() - rest_length[k]);
  });
}

/// For every neighbour the third corner of the triangle that runs from the vertex to it.
void third_corners(const VertexRings& rings, std::span<const Triangle> triangles, std::vector<int>& third) {
  third.resize(rings.neighbour.size());
  // Of an oriented manifold no two triangles run along an edge in the same direction: each entry is set once.
  parallel_for(triangles.size(), [&](std::size_t i) {
    const Triangle& t = triangles[i];
    for (int corner = 0; corner < 3; ++corner)
      third[rings.place_of(t[corner], t[(corner + 1) % 3])] = t[(corner + 2) % 3];
  });
}

}  // namespace

FairingState fairing_state(const TriangleMesh& mesh, const VertexRings& rings) {
  FairingState state;
  state.rest_length.assign(rings.neighbour.size(), 0);
  relax_rest_lengths(rings, mesh.position, 1, state.rest_length);
  third_corners(rings, mesh.triangles, state.third_corner);
  return state;
}

void renew_fairing_state(const TriangleMesh& mesh, const VertexHistory& history, const VertexRings& before,
                         const VertexRings& rings, FairingState& state) {
  state.renewed.resize(rings.neighbour.size());
  parallel_for(mesh.vertex_count(), [&](std::size_t i) {
    const int v = static_cast<int>(i), old_v = history.before(v);
    for (int k = rings.start[v]; k < rings.start[v + 1]; ++k) {
      const int w = rings.neighbour[k], old_w = history.before(w);
      const int place = old_v >= 0 && old_w >= 0 ? before.place_of(old_v, old_w) : -1;
      state.renewed[k] = place >= 0 ? state.rest_length[place] : (mesh.position[w] - mesh.position[v]).norm();
    }
  });
  std::swap(state.rest_length, state.renewed);
  third_corners(rings, mesh.triangles, state.third_corner);
}

double fair(const Field& field, const VertexRings& rings, const FairingOptions& options,
            const ProjectionOptions& projection, double dt, TriangleMesh& mesh, FairingState& state) {
  double residual = 0;
  if (options.iterations > 0) find_moving(rings, mesh, state);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    relax_vertices(rings, options.relaxation, mesh, state);
    residual =
        project_all(field, projection, state.moved_position, state.moved_unprojected, state.moved_gradient);
    take_moved(state, mesh);
  }
  relax_rest_lengths(rings, mesh.position, 1 - std::exp(-dt / options.rest_length_time), state.rest_length);
  return residual;
}

}  // namespace kappaflow
