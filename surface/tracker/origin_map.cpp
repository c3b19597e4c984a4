#include "surface/tracker/origin_map.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>

#include "surface/field/particle_weights.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {
namespace {

constexpr double kLink = 2;  // [sigma] between the origins of neighbours: liquid that is drawn out has gaps
constexpr double kRidge = 0.001;     // [1] that of Field::material_velocity()
constexpr double kLeastShare = 0.1;  // [1] of the weight in reach: a side with less is hardly there

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

/// Beside the rotation, so that the ridge takes nothing from liquid that has turned, and what particles in
/// one plane leave open turns with them.
Vec3 fitted_origin(const Vec3& x, std::span<const OriginMap::Voter> voters, int side, double sigma) {
  const Mat3 rotation = fitted_rotation(voters, side);
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> rhs = Eigen::Matrix<double, 4, 3>::Zero();
  for (const OriginMap::Voter& voter : voters) {
    if (voter.side != side) continue;
    const Vec3 r = voter.offset / sigma;
    const Eigen::Vector4d weighted = voter.weight * Eigen::Vector4d(1, r[0], r[1], r[2]);
    moment += weighted * Eigen::RowVector4d(1, r[0], r[1], r[2]);
    rhs += weighted * (voter.origin - rotation * voter.offset - x).transpose();
  }
  moment.diagonal().tail<3>().array() += kRidge * moment(0, 0);
  return x + moment.ldlt().solve(rhs).row(0).transpose();
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
  return Origin{fitted_origin(x, voters.all, side, sigma_), heaviest->source};
}

std::optional<Origin> OriginMap::at(const Vec3& x, const Origin& own, Voters& voters) const {
  find_sides(x, voters);
  Origin nearest{Vec3::Constant(kInfinity), kUnknownSource};
  double weight = 0, all = 0;
  for (int side = 0; side < std::ssize(voters.sides); ++side) {
    const Side& here = voters.sides[side];
    all += here.weight;
    if (own.source != kUnknownSource && here.source != own.source) continue;
    const Vec3 origin = fitted_origin(x, voters.all, side, sigma_);
    if (!((origin - own.position).norm() < (nearest.position - own.position).norm())) continue;
    nearest = {origin, here.source};
    weight = here.weight;
  }
  if (!(weight > kLeastShare * all)) return std::nullopt;
  return nearest;
}

}  // namespace kappaflow
