#include "surface/tracker/origin_map.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
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
constexpr double kTorn = 3;        // [1] a torn side of so few voters is a guess
constexpr double kUnfelt = 1.25;   // [1] stretch by which an error is no larger
constexpr double kParameters = 4;  // of an affine map, a component
constexpr double kAcross =
    3;  // [1] strain across a sheet, which its particles do not show, over that along it

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

/// The motion of a side about x: X_i - x - R r_i = a + B r_i/sigma, with r_i = x_i - x. Beside the rotation,
/// so that the ridge takes nothing from liquid that has turned, and what particles in one plane leave open
/// turns with them.
struct OriginFit {
  Mat3 rotation = Mat3::Identity();                                          ///< R
  Eigen::Matrix<double, 4, 3> motion = Eigen::Matrix<double, 4, 3>::Zero();  ///< a and the columns of B [m]
  Eigen::LDLT<Eigen::Matrix4d> moment{};  ///< of the voters, with the ridge
  Vec3 mean = Vec3::Zero();               ///< of X_i - x - R r_i [m]
  double weight = 0;                      ///< of the voters

  Vec3 shift() const { return motion.row(0).transpose(); }
};

/// Calls visit(w_i, (1, r_i/sigma), X_i - x - R r_i) for the voters of a side.
template <class Visit>
void for_each_voter(std::span<const OriginMap::Voter> voters, int side, const Vec3& x, const Mat3& rotation,
                    double sigma, const Visit& visit) {
  for (const OriginMap::Voter& voter : voters) {
    if (voter.side != side) continue;
    const Vec3 r = voter.offset / sigma, moved = voter.origin - rotation * voter.offset - x;
    visit(voter.weight, Eigen::Vector4d(1, r[0], r[1], r[2]), moved);
  }
}

OriginFit fitted_origin(const Vec3& x, std::span<const OriginMap::Voter> voters, int side, double sigma) {
  OriginFit fit;
  fit.rotation = fitted_rotation(voters, side);
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> rhs = Eigen::Matrix<double, 4, 3>::Zero();
  for_each_voter(voters, side, x, fit.rotation, sigma,
                 [&](double weight, const Eigen::Vector4d& at, const Vec3& moved) {
                   moment += weight * at * at.transpose();
                   rhs += weight * at * moved.transpose();
                 });
  fit.weight = moment(0, 0);
  fit.mean = rhs.row(0).transpose() / fit.weight;
  moment.diagonal().tail<3>().array() += kRidge * fit.weight;
  fit.moment.compute(moment);
  fit.motion = fit.moment.solve(rhs);
  return fit;
}

/// Whether another side of the same source is here.
bool is_torn(const OriginMap::Voters& voters, int side) {
  const OriginMap::Side& own = voters.sides[side];
  return std::ranges::any_of(voters.sides, [&](const OriginMap::Side& other) {
    return &other != &own && other.source == own.source && other.weight > kLeastShare * voters.weight;
  });
}

/// Of the origin that a fit says, its three components together [m2]; see OriginMap::at().
double variance_of(const OriginFit& fit, const Vec3& x, const OriginMap::Voters& voters, int side,
                   double sigma) {
  const Eigen::Vector4d row = fit.moment.solve(Eigen::Vector4d::Unit(0));
  double leverage = 0, strained = 0, rigid = 0, weight2 = 0;
  Vec3 unseen = Vec3::Zero();
  for_each_voter(voters.all, side, x, fit.rotation, sigma,
                 [&](double weight, const Eigen::Vector4d& at, const Vec3& moved) {
                   const double vote = weight * row.dot(at);
                   leverage += vote * vote;
                   unseen += vote * at.tail<3>();
                   strained += weight * (moved - fit.motion.transpose() * at).squaredNorm();
                   rigid += weight * (moved - fit.mean).squaredNorm();
                   weight2 += weight * weight;
                 });
  const double count = fit.weight * fit.weight / weight2;  // as if all weighed alike (Kish 1965)
  if (count <= kTorn && is_torn(voters, side)) return kInfinity;
  const double deviation = count > kParameters + 1 ? strained / (1 - kParameters / count) : rigid;
  return leverage * deviation / fit.weight +
         kAcross * kAcross * unseen.squaredNorm() * fit.motion.bottomRows<3>().squaredNorm();
}

/// How many times kUnfelt liquid has been drawn out since its origin, in the direction in which that is most;
/// at least 1.
double stretch_of(const OriginFit& fit, double sigma) {
  const Mat3 gradient = fit.rotation + fit.motion.bottomRows<3>().transpose() / sigma;  // of origin by place
  const Eigen::SelfAdjointEigenSolver<Mat3> squares(gradient * gradient.transpose(), Eigen::EigenvaluesOnly);
  constexpr double kLeast = 1e-6;  // what has been drawn out more than a million times counts as so much
  return std::max(1.0, 1 / (kUnfelt * std::sqrt(std::max(squares.eigenvalues()[0], kLeast * kLeast))));
}

/// How much of the difference between a vertex's own origin and a fit's is taken over.
double correction_share(double difference2, double variance, double sigma) {
  const double error2 = variance / 3;
  if (!(difference2 > error2)) return 0;
  const double known = (kGuess - std::sqrt(variance) / sigma) / (kGuess - kKnown);
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
  voters.weight = 0;
  for (const Side& side : voters.sides) voters.weight += side.weight;
}

std::optional<Origin> OriginMap::at(const Vec3& x, Voters& voters) const {
  find_sides(x, voters);
  const auto heaviest = std::ranges::max_element(voters.sides, {}, &Side::weight);
  if (heaviest == voters.sides.end()) return std::nullopt;
  const int side = static_cast<int>(heaviest - voters.sides.begin());
  return Origin{x + fitted_origin(x, voters.all, side, sigma_).shift(), heaviest->source};
}

std::optional<Origin> OriginMap::at(const Vec3& x, const Origin& own, Voters& voters) const {
  find_sides(x, voters);
  OriginFit nearest;
  int nearest_side = -1;
  double difference2 = kInfinity;
  for (int side = 0; side < std::ssize(voters.sides); ++side) {
    const Side& here = voters.sides[side];
    if (own.source != kUnknownSource && here.source != own.source) continue;
    const OriginFit fit = fitted_origin(x, voters.all, side, sigma_);
    const double distance2 = (x + fit.shift() - own.position).squaredNorm();
    if (!(distance2 < difference2)) continue;
    nearest = fit;
    nearest_side = side;
    difference2 = distance2;
  }
  if (nearest_side < 0 || !(nearest.weight > kLeastShare * voters.weight)) return std::nullopt;
  const double stretch = stretch_of(nearest, sigma_),
               variance = stretch * stretch * variance_of(nearest, x, voters, nearest_side, sigma_);
  const Vec3 correction = x + nearest.shift() - own.position;
  return Origin{own.position + correction_share(difference2, variance, sigma_) * correction,
                voters.sides[nearest_side].source};
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
