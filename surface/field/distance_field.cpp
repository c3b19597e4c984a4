#include "surface/field/distance_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "surface/field/symmetric_place.h"

namespace kappaflow {
namespace {

constexpr int kPadding = GridSpline::kMargin + 3;  // [points] around an image, so that its border is inside

// How fast a surface may be along itself, which its shape does not tell: so many times as fast as along its
// normal, and at least so many length scales from one image to the next.
constexpr double kFasterThanNormal = 4, kLeastMotion = 0.5;

RegularGrid padded(RegularGrid grid) {
  for (int a = 0; a < 3; ++a) {
    grid.first[a] -= kPadding;
    grid.dims[a] += 2 * kPadding;
  }
  return grid;
}

/// The index of the point of `inner` that is nearest to a point of the padded grid, and how far off it is.
struct NearestInner {
  std::size_t index;
  double distance;  // [m]

  NearestInner(const RegularGrid& inner, int i, int j, int k) {
    const std::array<int, 3> at{i - kPadding, j - kPadding, k - kPadding};
    std::array<int, 3> nearest;
    Vec3 off;
    for (int a = 0; a < 3; ++a) {
      nearest[a] = std::clamp(at[a], 0, inner.dims[a] - 1);
      off[a] = inner.spacing[a] * (at[a] - nearest[a]);
    }
    index = inner.index(nearest[0], nearest[1], nearest[2]);
    distance = off.norm();
  }
};

/// Calls value(i, j, k) for every point of a grid.
template <class Value>
std::vector<float> filled(const RegularGrid& grid, const Value& value) {
  std::vector<float> result(grid.size());
  const std::size_t nx = grid.dims[0], ny = grid.dims[1];
  parallel_for(
      ny * static_cast<std::size_t>(grid.dims[2]),
      [&](std::size_t row) {
        for (std::size_t i = 0; i < nx; ++i)
          result[row * nx + i] = static_cast<float>(
              value(static_cast<int>(i), static_cast<int>(row % ny), static_cast<int>(row / ny)));
      },
      16);
  return result;
}

/// How deep a point of the grid is within the image's box [m].
double depth_in_box(const RegularGrid& grid, int i, int j, int k) {
  const std::array<int, 3> at{i, j, k};
  double depth = kInfinity;
  for (int a = 0; a < 3; ++a)
    depth = std::min(depth, grid.spacing[a] * std::min(at[a], grid.dims[a] - 1 - at[a]));
  return depth;
}

bool inside_at_border(const SignedDistances& distances) {
  const RegularGrid& grid = distances.grid;
  for (std::size_t p = 0; p < distances.value.size(); ++p) {
    if (!(distances.value[p] < 0)) continue;
    const auto nx = static_cast<std::size_t>(grid.dims[0]), ny = static_cast<std::size_t>(grid.dims[1]);
    if (depth_in_box(grid, static_cast<int>(p % nx), static_cast<int>(p / nx % ny),
                     static_cast<int>(p / (nx * ny))) == 0)
      return true;
  }
  return false;
}

/// f with kPadding points around the image. Beyond it, and where the image cuts the liquid off, f is no more
/// than minus the distance from the image's box.
std::vector<float> padded_f(const SignedDistances& distances) {
  const RegularGrid& inner = distances.grid;
  const bool is_cut = inside_at_border(distances);
  return filled(padded(inner), [&](int i, int j, int k) {
    const NearestInner nearest(inner, i, j, k);
    const double f = -static_cast<double>(distances.value[nearest.index]);
    if (nearest.distance > 0) return std::min(f, 0.0) - nearest.distance;
    return is_cut ? std::min(f, depth_in_box(inner, i - kPadding, j - kPadding, k - kPadding)) : f;
  });
}

void check(const SignedDistances& distances) {
  const RegularGrid& grid = distances.grid;
  const auto& [nx, ny, nz] = grid.dims;
  if (std::min({nx, ny, nz}) < 2 || distances.value.size() != grid.size())
    throw InvalidInput(
        fmt::format("an image of {} x {} x {} points with {} distances; expected two points "
                    "along each axis, and a distance a point",
                    nx, ny, nz, distances.value.size()));
  if (!distances.velocity.empty() && distances.velocity.size() != grid.size())
    throw InvalidInput(
        fmt::format("an image of {} points with {} velocities", grid.size(), distances.velocity.size()));
  if (!(grid.spacing.minCoeff() > 0))
    throw InvalidInput(
        fmt::format("the spacing of an image is {}; it must be positive", grid.spacing.minCoeff()));
  if (!std::ranges::all_of(distances.value, [](float d) { return std::isfinite(d); }) ||
      !std::ranges::all_of(distances.velocity, [](const Eigen::Vector3f& v) { return v.allFinite(); }))
    throw InvalidInput("an image has values that are not finite");
}

/// The weights of values at instants in the derivative at time t of the polynomial through them: that of
/// Lagrange.
std::vector<double> derivative_weights(double t, std::span<const double> time) {
  std::vector<double> weight(time.size());
  for (std::size_t i = 0; i < time.size(); ++i)
    for (std::size_t j = 0; j < time.size(); ++j) {
      if (j == i) continue;
      double slope = 1 / (time[i] - time[j]);
      for (std::size_t k = 0; k < time.size(); ++k)
        if (k != i && k != j) slope *= (t - time[k]) / (time[i] - time[k]);
      weight[i] += slope;
    }
  return weight;
}

/// The weights of the four images in f and in its rate at one time.
struct TimeWeights {
  std::array<double, 4> value{}, rate{};

  TimeWeights(const std::array<DistanceMotion::Image, 4>& images, double t) {
    const double t0 = images[1]->time(), dt = images[2]->time() - t0, s = (t - t0) / dt, r = 1 - s;
    value[1] = (1 + 2 * s) * r * r;
    value[2] = s * s * (3 - 2 * s);
    rate[2] = 6 * s * r / dt;
    rate[1] = -rate[2];
    add_slope(images, 1, dt * s * r * r, r * r - 2 * s * r);
    add_slope(images, 2, -dt * s * s * r, s * s - 2 * s * r);
  }

 private:
  /// The slope at image m: that of the parabola through it and its neighbours; at an end of the series of the
  /// three images next to it, or of the only two.
  void add_slope(const std::array<DistanceMotion::Image, 4>& images, std::size_t m, double in_value,
                 double in_rate) {
    using Range = std::pair<std::size_t, std::size_t>;
    const std::array<Range, 3> ranges{Range{m - 1, m + 1}, Range{2 - m, 4 - m}, Range{1, 2}};
    const auto [first, last] = *std::ranges::find_if(
        ranges, [&](const Range& r) { return images[r.first] != nullptr && images[r.second] != nullptr; });
    std::vector<double> time;
    for (std::size_t k = first; k <= last; ++k) time.push_back(images[k]->time());
    const std::vector<double> weight = derivative_weights(images[m]->time(), time);
    for (std::size_t k = first; k <= last; ++k) {
      value[k] += in_value * weight[k - first];
      rate[k] += in_rate * weight[k - first];
    }
  }
};

GridSpline sum_of(const std::array<DistanceMotion::Image, 4>& images, const std::array<double, 4>& weight) {
  std::vector<GridSpline::Term> terms;
  for (std::size_t k = 0; k < images.size(); ++k)
    if (images[k] != nullptr) terms.push_back({&images[k]->f(), weight[k], images[k]->outside()});
  return GridSpline::sum(terms);
}

std::array<GridSpline, 3> velocities_of(const std::array<DistanceMotion::Image, 4>& images,
                                        const std::array<double, 4>& weight) {
  std::array<GridSpline, 3> result;
  if (!images[1]->has_velocity()) return result;
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<GridSpline::Term> terms;
    for (std::size_t k = 0; k < images.size(); ++k)
      if (images[k] != nullptr) terms.push_back({&images[k]->velocity()[a], weight[k], 0});
    result[a] = GridSpline::sum(terms);
  }
  return result;
}

/// The points of an image next to its surface.
std::vector<Vec3> points_at_surface(const DistanceImage& image) {
  const RegularGrid& grid = image.f().grid();
  const double near = grid.spacing.maxCoeff();
  std::vector<Vec3> points;
  for (int k = GridSpline::kMargin; k < grid.dims[2] - GridSpline::kMargin; ++k)
    for (int j = GridSpline::kMargin; j < grid.dims[1] - GridSpline::kMargin; ++j)
      for (int i = GridSpline::kMargin; i < grid.dims[0] - GridSpline::kMargin; ++i)
        if (std::abs(image.f().coefficient(i, j, k)) <= near) points.push_back(grid.point(i, j, k));
  return points;
}

constexpr double kShareOfMotion = 0.999;

/// See DistanceMotion::displacement().
double displacement_between(const DistanceImage& from, const DistanceImage& to,
                            std::span<const Vec3> points) {
  constexpr double kVanished = 0.1, kCutOff = 0.95;
  std::vector<double> found, beyond;
  for (const Vec3& x : points) {
    const double f = to.f().at<0>(x)[0], motion = std::abs(f - from.f().at<0>(x)[0]);
    (std::abs(f) < kCutOff * to.reach() ? found : beyond).push_back(motion);
  }
  if (static_cast<double>(beyond.size()) > kVanished * static_cast<double>(points.size()))
    found.insert(found.end(), beyond.begin(), beyond.end());
  return found.empty() ? 0 : quantile(found, kShareOfMotion);
}

/// See DistanceMotion::material_displacement().
double material_displacement_of(const DistanceImage& from, double dt, std::span<const Vec3> points) {
  if (!from.has_velocity() || points.empty()) return 0;
  std::vector<double> found;
  for (const Vec3& x : points) {
    Vec3 velocity;
    for (int a = 0; a < 3; ++a) velocity[a] = from.velocity()[a].at<0>(x)[0];
    found.push_back(dt * velocity.norm());
  }
  return quantile(found, kShareOfMotion);
}

}  // namespace

DistanceImage::DistanceImage(const SignedDistances& distances, double time) : time_(time) {
  check(distances);
  const RegularGrid grid = padded(distances.grid);
  std::vector<float> f = padded_f(distances);
  reach_ = parallel_max(distances.value.size(), 0.0,
                        [&](std::size_t p) { return std::abs(static_cast<double>(distances.value[p])); });
  outside_ = *std::ranges::min_element(f);
  f_ = GridSpline(grid, std::move(f));
  if (distances.velocity.empty()) return;
  for (int a = 0; a < 3; ++a)
    velocity_[a] = GridSpline(grid, filled(grid, [&](int i, int j, int k) {
                                return distances.velocity[NearestInner(distances.grid, i, j, k).index][a];
                              }));
}

DistanceField::DistanceField(GridSpline f, GridSpline rate, std::array<GridSpline, 3> velocity,
                             double fastest_speed, double time)
    : f_(std::move(f)),
      rate_(std::move(rate)),
      velocity_(std::move(velocity)),
      length_scale_(kLengthScale * f_.grid().spacing.maxCoeff()),
      fastest_speed_(fastest_speed),
      time_(time) {}

Jet DistanceField::jet(const Vec3& x) const {
  const auto f = f_.at<3>(x);
  const auto rate = rate_.at<2>(x);
  const auto vector = [](const auto& d) { return Vec3(d[1], d[2], d[3]); };
  const auto matrix = [](const auto& d) {
    Mat3 m;
    m << d[4], d[5], d[6], d[5], d[7], d[8], d[6], d[8], d[9];
    return m;
  };
  Jet jet{f[0],          vector(f),
          matrix(f),     {f[10], f[11], f[12], f[13], f[14], f[15], f[16], f[17], f[18], f[19]},
          rate[0],       vector(rate),
          matrix(rate),  length_scale_,
          fastest_speed_};
  return jet;
}

Jet DistanceField::jet(const Vec3& x, StrainResponse& strain) const {
  Jet jet = this->jet(x);
  const Vec3& g = jet.g;
  const Mat3 N = g * g.transpose();
  std::array<Mat3, 3> N_a;  // its derivatives
  for (int a = 0; a < 3; ++a) {
    const Vec3 A_a = jet.A.col(a);
    N_a[a] = A_a * g.transpose() + g * A_a.transpose();
  }
  strain.f = jet.f * N;
  for (int a = 0; a < 3; ++a) strain.g[a] = g[a] * N + jet.f * N_a[a];
  // Without the term f N_ab: on the surface, where this is asked for, f vanishes.
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b)
      strain.A[symmetric_place(a, b)] = jet.A(a, b) * N + g[a] * N_a[b] + g[b] * N_a[a];
  return jet;
}

ValueAndGradient DistanceField::value_and_gradient(const Vec3& x) const {
  const auto f = f_.at<1>(x);
  ValueAndGradient at{f[0], {f[1], f[2], f[3]}};
  const Vec3 beyond = x - f_.inside(x);
  if (const double distance = beyond.norm(); distance > 0) {
    at.f -= distance;
    at.g -= beyond / distance;
  }
  return at;
}

Bounds DistanceField::bounds() const {
  const RegularGrid& grid = f_.grid();
  return {grid.point(0, 0, 0), grid.point(grid.dims[0] - 1, grid.dims[1] - 1, grid.dims[2] - 1)};
}

std::optional<Vec3> DistanceField::material_velocity(const Vec3& x) const {
  if (velocity_[0].grid().size() == 0) return std::nullopt;
  return Vec3(velocity_[0].at<0>(x)[0], velocity_[1].at<0>(x)[0], velocity_[2].at<0>(x)[0]);
}

std::optional<std::vector<std::array<int, 3>>> DistanceField::occupied_cubes(const SampledField& lattice,
                                                                             int cells) const {
  const RegularGrid& grid = f_.grid();
  const Bounds box = bounds();
  std::array<int, 3> cubes;
  for (int a = 0; a < 3; ++a) cubes[a] = std::max(0, lattice.dims[a] - 2) / cells + 1;
  std::vector<std::array<int, 3>> all, found;
  for (int k = 0; k < cubes[2]; ++k)
    for (int j = 0; j < cubes[1]; ++j)
      for (int i = 0; i < cubes[0]; ++i) all.push_back({i, j, k});
  std::vector<char> is_occupied(all.size());
  parallel_for(
      all.size(),
      [&](std::size_t c) {
        const Vec3 lower = lattice.origin + lattice.spacing * cells * Vec3(all[c][0], all[c][1], all[c][2]);
        const Vec3 upper = lower + Vec3::Constant(lattice.spacing * cells);
        std::array<int, 3> first, last;
        for (int a = 0; a < 3; ++a) {
          const auto point = [&](double x) { return (x - grid.origin[a]) / grid.spacing[a]; };
          first[a] = static_cast<int>(std::floor(point(std::max(lower[a], box.lower[a]))));
          last[a] = static_cast<int>(std::ceil(point(std::min(upper[a], box.upper[a]))));
        }
        is_occupied[c] = f_.upper_bound(first, last) > 0;
      },
      8);
  for (std::size_t c = 0; c < all.size(); ++c)
    if (is_occupied[c] != 0) found.push_back(all[c]);
  return found;
}

DistanceMotion::DistanceMotion(Image from, Image to, Image before, Image after)
    : images_{std::move(before), std::move(from), std::move(to), std::move(after)} {
  if (images_[1] == nullptr || images_[2] == nullptr)
    throw InvalidInput("a motion of images takes two of them at least");
  const DistanceImage* last = nullptr;
  for (const Image& image : images_) {
    if (image == nullptr) continue;
    const RegularGrid &first = images_[1]->f().grid(), &grid = image->f().grid();
    if (grid.origin != first.origin || grid.spacing != first.spacing)
      throw InvalidInput("the grids of images have different origins or spacings");
    if (last != nullptr && !(last->time() < image->time()))
      throw InvalidInput(
          fmt::format("an image at {} s after one at {} s; times must ascend", image->time(), last->time()));
    if (last != nullptr && last->has_velocity() != image->has_velocity())
      throw InvalidInput(
          fmt::format("of the images at {} s and at {} s one has velocities", last->time(), image->time()));
    last = image.get();
  }
  const std::vector<Vec3> points = points_at_surface(*images_[1]);
  displacement_ = displacement_between(*images_[1], *images_[2], points);
  material_displacement_ = material_displacement_of(*images_[1], t1() - t0(), points);
}

std::shared_ptr<const Field> DistanceMotion::at(double t) {
  if (!(t >= t0() && t <= t1()))
    throw InvalidInput(fmt::format("a field at {} s was asked of a motion from {} s to {} s", t, t0(), t1()));
  for (const auto& field : fields_)
    if (field->time() == t) return field;
  const TimeWeights weights(images_, t);
  const double spacing = images_[1]->f().grid().spacing.maxCoeff(), dt = t1() - t0();
  const double fastest = std::max({kFasterThanNormal * displacement_, material_displacement_,
                                   kLeastMotion * DistanceField::kLengthScale * spacing}) /
                         dt;
  fields_.push_back(std::make_shared<DistanceField>(sum_of(images_, weights.value),
                                                    sum_of(images_, weights.rate),
                                                    velocities_of(images_, weights.value), fastest, t));
  return fields_.back();
}

void DistanceMotion::forget_before(double t) {
  std::erase_if(fields_, [t](const auto& field) { return field->time() < t; });
}

}  // namespace kappaflow
