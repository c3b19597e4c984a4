#include "surface/tracker/origin_map.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "surface/field/particle_weights.h"

namespace kappaflow {
namespace {

constexpr double kLink = 2;  // [sigma] between the origins of neighbours: liquid that is drawn out has gaps
constexpr double kRidge = 1e-4;      // [1] ten times as much pulls at liquid that is being drawn out
constexpr double kLeastShare = 0.1;  // [1] of the weight in reach: a side with less is hardly there
// [sigma] standard error of an origin: with less it is known, with more it is a guess, as that of a sheet
// thinner than the particles' spacing, which says little of what is above it.
constexpr double kKnown = 0.2, kGuess = 0.4;
constexpr double kParameters = 4;  // of an affine map, a component
constexpr double kLeastSpare =
    0.01;  // of the voters: where they just suffice for the fit they hardly deviate from it

/// Gives all voters that a chain joins to the first one its side.
void spread_side(std::size_t first, double link2, OriginMap::Voters& voters) {
  voters.front.assign(1, first);
  while (!voters.front.empty()) {
    const OriginMap::Voter from = voters.all[voters.front.back()];
    voters.front.pop_back();
    for (std::size_t k = 0; k < voters.all.size(); ++k) {
      OriginMap::Voter& to = voters.all[k];
      if (to.side >= 0 || to.source != from.source || (to.origin - from.origin).squaredNorm() > link2)
        continue;
      to.side = from.side;
      voters.front.push_back(k);
    }
  }
}

/// The rotation that takes the side's places to its origins best (Kabsch 1976).
Mat3 fitted_rotation(std::span<const OriginMap::Voter> voters, int side) {
  double weight = 0;
  Vec3 mean_offset = Vec3::Zero(), mean_origin = Vec3::Zero();
  for (const OriginMap::Voter& voter : voters) {
    if (voter.side != side) continue;
    weight += voter.weight;
    mean_offset += voter.weight * voter.offset;
    mean_origin += voter.weight * voter.origin;
  }
  mean_offset /= weight;
  mean_origin /= weight;
  Mat3 covariance = Mat3::Zero();
  for (const OriginMap::Voter& voter : voters)
    if (voter.side == side)
      covariance += voter.weight * (voter.origin - mean_origin) * (voter.offset - mean_offset).transpose();
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handed = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vec3(1, 1, handed).asDiagonal() * svd.matrixV().transpose();
}

/// What the voters of a side say of x.
struct OriginFit {
  Vec3 origin;      ///< [m]
  double variance;  ///< of its three components together [m2]
};

/// Beside the rotation, so that the ridge takes nothing from liquid that has turned, and what particles in
/// one plane leave open turns with them.
OriginFit fitted_origin(const Vec3& x, std::span<const OriginMap::Voter> voters, int side, double sigma) {
  const Mat3 rotation = fitted_rotation(voters, side);
  const auto basis = [&](const OriginMap::Voter& voter) {
    const Vec3 r = voter.offset / sigma;
    return Eigen::Vector4d(1, r[0], r[1], r[2]);
  };
  const auto moved = [&](const OriginMap::Voter& voter) -> Vec3 {
    return voter.origin - rotation * voter.offset - x;
  };
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> rhs = Eigen::Matrix<double, 4, 3>::Zero();
  for (const OriginMap::Voter& voter : voters) {
    if (voter.side != side) continue;
    const Eigen::Vector4d weighted = voter.weight * basis(voter);
    moment += weighted * basis(voter).transpose();
    rhs += weighted * moved(voter).transpose();
  }
  const double weight = moment(0, 0);
  moment.diagonal().tail<3>().array() += kRidge * weight;
  const Eigen::LDLT<Eigen::Matrix4d> solver(moment);
  const Eigen::Matrix<double, 4, 3> motion = solver.solve(rhs);
  const Eigen::Vector4d share =
      solver.solve(Eigen::Vector4d::Unit(0));  // the origin is sum w share . basis moved
  double leverage = 0, deviation2 = 0, weight2 = 0;
  for (const OriginMap::Voter& voter : voters) {
    if (voter.side != side) continue;
    const Eigen::Vector4d at = basis(voter);
    const double vote = voter.weight * share.dot(at);
    leverage += vote * vote;
    deviation2 += voter.weight * (moved(voter) - motion.transpose() * at).squaredNorm();
    weight2 += voter.weight * voter.weight;
  }
  const double count = weight * weight / weight2;  // of voters that weigh alike and say as much (Kish 1965)
  const double spare = std::max(1 - kParameters / count, kLeastSpare);
  return {x + motion.row(0).transpose(), leverage * deviation2 / (weight * spare)};
}

/// How much of the difference between a vertex's own origin and the fit is the vertex's error.
double share_of_own_error(const OriginFit& fit, const Vec3& own, double sigma) {
  const double difference2 = (fit.origin - own).squaredNorm(), error2 = fit.variance / 3;
  if (!(difference2 > error2)) return 0;
  const double known = (kGuess - std::sqrt(fit.variance) / sigma) / (kGuess - kKnown);
  return std::clamp(known, 0.0, 1.0) * (1 - error2 / difference2);
}

/// Calls visit(v, voters) for each vertex, in parallel.
template <class Visit>
void for_each_vertex(const TriangleMesh& mesh, const Visit& visit) {
  constexpr std::size_t kBlock = 64;  // that share their memory
  const std::size_t n = mesh.vertex_count();
  parallel_for((n + kBlock - 1) / kBlock,
               [&](std::size_t b) {
                 OriginMap::Voters voters;
                 for (std::size_t v = b * kBlock; v < std::min(n, (b + 1) * kBlock); ++v) visit(v, voters);
               },
               1);
}

}  // namespace

OriginMap::OriginMap(const Particles& particles, std::span<const Vec3> origin, std::span<const int> source,
                     double sigma)
    : sigma_(sigma) {
  if (particles.size() == 0) return;
  const std::vector<double> radius = support_radii(particles.size(), sigma, particles.scale);
  reach_ = std::ranges::max(radius);
  grid_.build(std::span<const Vec3>(particles.position), reach_);
  for (const std::uint32_t i : grid_.order()) {
    position_.push_back(particles.position[i]);
    origin_.push_back(origin[i]);
    inverse_sigma2_.push_back(1 / (radius[i] * radius[i]));
    source_.push_back(source.empty() ? kUnknownSource : source[i]);
  }
}

void OriginMap::find_sides(const Vec3& x, Voters& voters) const {
  voters.all.clear();
  grid_.ranges_near(x, reach_, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t k = begin; k < end; ++k) {
      const Vec3 offset = position_[k] - x;
      const double u = 1 - offset.squaredNorm() * inverse_sigma2_[k];
      if (u > 0) voters.all.push_back({offset, origin_[k], u * u * u, source_[k], -1});
    }
  });
  voters.sides.clear();
  for (std::size_t k = 0; k < voters.all.size(); ++k) {
    if (voters.all[k].side >= 0) continue;
    voters.all[k].side = static_cast<int>(voters.sides.size());
    voters.sides.push_back({0, voters.all[k].source});
    spread_side(k, kLink * kLink * sigma_ * sigma_, voters);
  }
  for (const Voter& voter : voters.all) voters.sides[voter.side].weight += voter.weight;
}

std::optional<Origin> OriginMap::at(const Vec3& x, Voters& voters) const {
  find_sides(x, voters);
  const auto heaviest = std::ranges::max_element(voters.sides, {}, &Side::weight);
  if (heaviest == voters.sides.end()) return std::nullopt;
  const int side = static_cast<int>(heaviest - voters.sides.begin());
  return Origin{fitted_origin(x, voters.all, side, sigma_).origin, heaviest->source};
}

std::optional<Origin> OriginMap::at(const Vec3& x, const Origin& own, Voters& voters) const {
  find_sides(x, voters);
  OriginFit nearest{Vec3::Constant(kInfinity), kInfinity};
  int source = kUnknownSource;
  double weight = 0, all = 0;
  for (int side = 0; side < std::ssize(voters.sides); ++side) {
    const Side& here = voters.sides[side];
    all += here.weight;
    if (own.source != kUnknownSource && here.source != own.source) continue;
    const OriginFit fit = fitted_origin(x, voters.all, side, sigma_);
    if (!((fit.origin - own.position).norm() < (nearest.origin - own.position).norm())) continue;
    nearest = fit;
    source = here.source;
    weight = here.weight;
  }
  if (!(weight > kLeastShare * all)) return std::nullopt;
  const double share = share_of_own_error(nearest, own.position, sigma_);
  return Origin{own.position + share * (nearest.origin - own.position), source};
}

void take_origins(const OriginMap& map, TriangleMesh& mesh) {
  for_each_vertex(mesh, [&](std::size_t v, OriginMap::Voters& voters) {
    const std::optional<Origin> origin = map.at(mesh.position[v], voters);
    if (!origin) return;
    mesh.rest_position[v] = origin->position;
    mesh.source[v] = origin->source;
  });
}

void correct_origins(const OriginMap& map, TriangleMesh& mesh) {
  for_each_vertex(mesh, [&](std::size_t v, OriginMap::Voters& voters) {
    const Origin own{mesh.rest_position[v], mesh.source[v]};
    if (const std::optional<Origin> origin = map.at(mesh.position[v], own, voters))
      mesh.rest_position[v] = origin->position;
  });
}

}  // namespace kappaflow
