#include "surface/motion/patch_agreement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/parallel.h"
#include "core/quantile.h"

namespace kappaflow {
namespace {

constexpr double kSmoothness = 0.003;  // kappa [1]; the staircase's slip is the same from 0.001 to 0.01
constexpr double kExact = 1e-3;        // [1] of the fastest speed: a residual that is rounding and damping
constexpr double kTolerance = 1e-5;    // [1] of the energy that the iterations take
constexpr int kMostIterations = 100;
constexpr std::size_t kPatchesPerTask = 32;

/// u_s(y) - u_t(y) halfway between two patches, for motions (unit G, a).
Vec3 difference(const MotionUnknowns& s, const MotionUnknowns& t, const Vec3& half) {
  const auto gradient = [](const MotionUnknowns& z) { return z.head<9>().reshaped<Eigen::RowMajor>(3, 3); };
  return s.tail<3>() - t.tail<3>() + (gradient(s) + gradient(t)) * half;
}

/// What ties a patch to a neighbour.
struct Link {
  int other;       // patch
  Vec3 half;       // half of the way there [units]
  double length2;  // L^2 [units^2]

  /// Adds the derivative of half the link's energy by the motion s of its patch; t: of the other.
  void add_derivative(const MotionUnknowns& s, const MotionUnknowns& t, MotionUnknowns& sum) const {
    const Vec3 d = kSmoothness * difference(s, t, half);
    for (int p = 0; p < 3; ++p) sum.segment<3>(3 * p) += d[p] * half;
    sum.head<9>() += kSmoothness * length2 * (s.head<9>() - t.head<9>());
    sum.tail<3>() += d;
  }

  /// Adds its second derivative by s.
  void add_second(MotionInformation& sum) const {
    for (int p = 0; p < 3; ++p) {
      sum.block<3, 3>(3 * p, 3 * p) += kSmoothness * (half * half.transpose() + length2 * Mat3::Identity());
      sum.block<3, 1>(3 * p, 9 + p) += kSmoothness * half;
      sum.block<1, 3>(9 + p, 3 * p) += kSmoothness * half.transpose();
      sum(9 + p, 9 + p) += kSmoothness;
    }
  }
};

/// Patches of this process, by their places among those that change, that have links to ones of another, and
/// the latter; ascending, so that both know the order.
struct Border {
  int rank = 0;
  std::vector<int> sent{}, received{};
};

/// The patches that change, with what holds them to their fits and to each other.
class Agreement {
 public:
  Agreement(const SurfaceSamples& samples, std::span<const double> length_scale, double fastest,
            std::span<AffineFit> fits, const ItemShares& shares);

  void solve();

 private:
  void choose(double fastest);
  void find_links(const SurfaceSamples& samples, std::span<const double> length_scale);
  void find_border(const ItemShares& shares);
  void weigh();
  double dot(const std::vector<MotionUnknowns>& a, const std::vector<MotionUnknowns>& b) const;
  void exchange_at_border(std::vector<MotionUnknowns>& motions) const;
  template <class Of>
  void add_links(std::size_t k, const Of& of, MotionUnknowns& sum) const;

  std::span<AffineFit> fits_;
  double unit_ = 0;                  // of length [m]
  double median2_ = 0, exact2_ = 0;  // of squared residuals [m2/s2]
  std::vector<int> patch_, place_;   // those that change, and where each patch is among them or -1
  ItemShares shares_;                // of those that change
  std::vector<Border> borders_;
  std::vector<Link> links_;  // of the k-th from first_[k] to first_[k + 1]; of this process's
  std::vector<std::size_t> first_;
  std::vector<MotionInformation> held_;     // (m/r)^2 N
  std::vector<MotionInformation> inverse_;  // of the whole diagonal block: the preconditioner
};

Agreement::Agreement(const SurfaceSamples& samples, std::span<const double> length_scale, double fastest,
                     std::span<AffineFit> fits, const ItemShares& shares)
    : fits_(fits), place_(fits.size(), -1) {
  for (const double L : length_scale)
    if (L > 0 && !(unit_ > 0 && unit_ <= L)) unit_ = L;
  if (!(unit_ > 0)) return;
  choose(fastest);
  shares_ = shares.of(patch_);
  find_links(samples, length_scale);
  find_border(shares);
  weigh();
}

void Agreement::choose(double fastest) {
  std::vector<double> residuals;
  for (const AffineFit& fit : fits_)
    if (fit.radius > 0) residuals.push_back(fit.residual);
  const double median = quantile(residuals, 0.5);
  exact2_ = kExact * kExact * fastest * fastest;
  median2_ = median * median + exact2_;
  for (std::size_t s = 0; s < fits_.size(); ++s)
    if (fits_[s].radius > 0 && fits_[s].residual * fits_[s].residual > median2_) {
      place_[s] = static_cast<int>(patch_.size());
      patch_.push_back(static_cast<int>(s));
    }
}

void Agreement::find_links(const SurfaceSamples& samples, std::span<const double> length_scale) {
  first_.assign(1, 0);
  for (std::size_t k = 0; k < patch_.size(); ++k) {
    const int s = patch_[k];
    for (const int t : samples.rings.of(s)) {
      if (!(fits_[t].radius > 0) || !shares_.is_own(k)) continue;
      const double L = 0.5 * (length_scale[s] + length_scale[t]);
      links_.push_back(
          {t, 0.5 / unit_ * (samples.position[t] - samples.position[s]), L * L / (unit_ * unit_)});
    }
    first_.push_back(links_.size());
  }
}

void Agreement::find_border(const ItemShares& shares) {
  if (shares.group() == nullptr) return;
  std::vector<std::set<int>> sent(static_cast<std::size_t>(shares.group()->size())), received(sent);
  for (std::size_t k = 0; k < patch_.size(); ++k)
    for (std::size_t l = first_[k]; l < first_[k + 1]; ++l) {
      const int other = links_[l].other;
      if (place_[other] < 0 || shares.is_own(other)) continue;
      sent[shares.owner(other)].insert(static_cast<int>(k));
      received[shares.owner(other)].insert(place_[other]);
    }
  for (int r = 0; r < shares.group()->size(); ++r)
    if (!sent[r].empty())
      borders_.push_back({r, {sent[r].begin(), sent[r].end()}, {received[r].begin(), received[r].end()}});
}

void Agreement::weigh() {
  held_.resize(patch_.size());
  inverse_.resize(patch_.size());
  shares_.for_own(
      patch_.size(),
      [&](std::size_t k) {
        const AffineFit& fit = fits_[patch_[k]];
        MotionUnknowns scale = MotionUnknowns::Ones();  // from (radius G, a)
        scale.head<9>().setConstant(fit.radius / unit_);
        const double trust = median2_ / (fit.residual * fit.residual + exact2_);
        held_[k] = trust * (scale.asDiagonal() * fit.information * scale.asDiagonal());
        MotionInformation block = held_[k];
        for (std::size_t l = first_[k]; l < first_[k + 1]; ++l) links_[l].add_second(block);
        inverse_[k] = block.llt().solve(MotionInformation::Identity());
      },
      kPatchesPerTask);
}

/// of(patch): its motion.
template <class Of>
void Agreement::add_links(std::size_t k, const Of& of, MotionUnknowns& sum) const {
  const MotionUnknowns own = of(patch_[k]);
  for (std::size_t l = first_[k]; l < first_[k + 1]; ++l)
    links_[l].add_derivative(own, of(links_[l].other), sum);
}

double Agreement::dot(const std::vector<MotionUnknowns>& a, const std::vector<MotionUnknowns>& b) const {
  std::vector<double> part(patch_.size());
  shares_.for_own(
      part.size(), [&](std::size_t k) { part[k] = a[k].dot(b[k]); }, kDefaultGrain);
  shares_.gather(std::span(part));
  return std::accumulate(part.begin(), part.end(), 0.0);
}

/// Of the others' patches, those that this process's are linked to.
void Agreement::exchange_at_border(std::vector<MotionUnknowns>& motions) const {
  if (shares_.group() == nullptr) return;
  std::vector<std::vector<MotionUnknowns>> sent, received;
  for (const Border& border : borders_) {
    sent.emplace_back();
    for (const int k : border.sent) sent.back().push_back(motions[k]);
    received.emplace_back(border.received.size());
  }
  std::vector<Parcel> to, from;
  for (std::size_t b = 0; b < borders_.size(); ++b) {
    to.push_back({borders_[b].rank, bytes_in(std::span(sent[b]))});
    from.push_back({borders_[b].rank, bytes_in(std::span(received[b]))});
  }
  shares_.group()->exchange(to, from);
  for (std::size_t b = 0; b < borders_.size(); ++b)
    for (std::size_t i = 0; i < received[b].size(); ++i) motions[borders_[b].received[i]] = received[b][i];
}

void Agreement::solve() {
  const std::size_t n = patch_.size();
  std::vector<MotionUnknowns> change(n, MotionUnknowns::Zero()), residual(n), preconditioned(n), direction(n),
      product(n);
  const auto fitted = [&](int s) {
    MotionUnknowns z;
    z << unit_ * fits_[s].gradient.reshaped<Eigen::RowMajor>(), fits_[s].velocity;
    return z;
  };
  const auto directed = [&](int s) {
    return place_[s] < 0 ? MotionUnknowns(MotionUnknowns::Zero()) : direction[place_[s]];
  };
  shares_.for_own(
      n,
      [&](std::size_t k) {
        MotionUnknowns slope = MotionUnknowns::Zero();
        add_links(k, fitted, slope);
        residual[k] = -slope;
        direction[k] = preconditioned[k] = inverse_[k] * residual[k];
      },
      kPatchesPerTask);
  const double first = dot(residual, preconditioned);
  double energy = first;
  for (int i = 0; i < kMostIterations && energy > kTolerance * first; ++i) {
    exchange_at_border(direction);
    shares_.for_own(
        n,
        [&](std::size_t k) {
          product[k] = held_[k] * direction[k];
          add_links(k, directed, product[k]);
        },
        kPatchesPerTask);
    const double step = energy / dot(direction, product);
    shares_.for_own(
        n,
        [&](std::size_t k) {
          change[k] += step * direction[k];
          residual[k] -= step * product[k];
          preconditioned[k] = inverse_[k] * residual[k];
        },
        kPatchesPerTask);
    const double next = dot(residual, preconditioned), keep = next / energy;
    shares_.for_own(
        n, [&](std::size_t k) { direction[k] = preconditioned[k] + keep * direction[k]; }, kPatchesPerTask);
    energy = next;
  }
  shares_.gather(std::span(change));
  for (std::size_t k = 0; k < n; ++k) {
    AffineFit& fit = fits_[patch_[k]];
    fit.velocity += change[k].tail<3>();
    fit.gradient += change[k].head<9>().reshaped<Eigen::RowMajor>(3, 3) / unit_;
  }
}

}  // namespace

void agree(const SurfaceSamples& samples, std::span<const double> length_scale, double fastest,
           std::span<AffineFit> fits, const ItemShares& shares) {
  Agreement(samples, length_scale, fastest, fits, shares).solve();
}

}  // namespace kappaflow
