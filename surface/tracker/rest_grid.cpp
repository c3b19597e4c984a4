#include "surface/tracker/rest_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/whole_within.h"

namespace kappaflow {
namespace {

constexpr int kSide = 8;  // points of a block along each axis
constexpr std::size_t kPoints = kSide * kSide * kSide;
constexpr double kOutside = 0.5;    // [spacings]: so that sheets thinner than a cell have points
constexpr int kContinued = 3;       // [points]: a cell's corners are no further apart
constexpr int kFarthest = 1 << 29;  // [points]: as isosurface_lattice() has them at most

int floor_of(double x) {
  return whole_within(std::floor(x), -kFarthest, kFarthest);
}

/// Rounded down, as shifts are.
int block_of(int point) {
  return point >> 3;
}
static_assert(1 << 3 == kSide);

/// Whether x is in the liquid, or just outside.
bool is_inside(const Field& field, const Vec3& x, double spacing) {
  const ValueAndGradient at = field.value_and_gradient(x);
  return at.f > -kOutside * spacing * at.g.norm();
}

/// Where what is at x is `dt` later, or was, by the midpoint rule; nullopt where no velocity is known.
std::optional<Vec3> traced(const Field& here, const Field& midway, const Vec3& x, double dt) {
  const std::optional<Vec3> velocity = here.material_velocity(x);
  if (!velocity) return std::nullopt;
  return x + dt * midway.material_velocity(x + 0.5 * dt * *velocity).value_or(*velocity);
}

}  // namespace

std::ptrdiff_t RestGrid::Band::find(const Place& point) const {
  const Place block{block_of(point[0]), block_of(point[1]), block_of(point[2])};
  const auto found = std::lower_bound(blocks.begin(), blocks.end(), block);
  if (found == blocks.end() || *found != block) return -1;
  const auto within = [&](int a) { return point[a] & (kSide - 1); };
  return (found - blocks.begin()) * static_cast<std::ptrdiff_t>(kPoints) +
         (within(0) * kSide + within(1)) * kSide + within(2);
}

RestGrid::Place RestGrid::Band::place_of(std::size_t point) const {
  const Place& block = blocks[point / kPoints];
  const int within = static_cast<int>(point % kPoints), row = within / kSide;
  return {kSide * block[0] + row / kSide, kSide * block[1] + row % kSide, kSide * block[2] + within % kSide};
}

RestGrid::RestGrid(const Field& field, double spacing) : origin_(field.bounds().lower), spacing_(spacing) {
  find_blocks(field, next_);
  is_inside_.resize(next_.rest.size());
  parallel_for(next_.rest.size(), [&](std::size_t p) {
    next_.rest[p] = place_of(next_, p);
    is_inside_[p] = is_inside(field, next_.rest[p], spacing_);
    next_.known[p] = is_inside_[p] ? carried : no;
  });
  continue_next();
  std::swap(band_, next_);
}

/// All blocks in which the liquid may be. Their points have no values yet.
void RestGrid::find_blocks(const Field& field, Band& band) const {
  const Bounds bounds = field.bounds();
  const double side = kSide * spacing_;
  SampledField lattice;
  lattice.spacing = spacing_;
  Place first{};  // x, y, z
  for (int a = 0; a < 3; ++a) {
    first[a] = block_of(floor_of((bounds.lower[a] - origin_[a]) / spacing_));
    lattice.dims[a] =
        kSide * (block_of(floor_of((bounds.upper[a] - origin_[a]) / spacing_)) - first[a] + 1) + 1;
    lattice.origin[a] = origin_[a] + side * first[a];
  }
  band.blocks.clear();
  const auto add = [&](int i, int j, int k) {
    band.blocks.push_back({first[2] + k, first[1] + j, first[0] + i});
  };
  if (const auto cubes = field.occupied_cubes(lattice, kSide)) {
    for (const auto& [i, j, k] : *cubes) add(i, j, k);
  } else {
    for (int k = 0; k < lattice.dims[2] / kSide; ++k)
      for (int j = 0; j < lattice.dims[1] / kSide; ++j)
        for (int i = 0; i < lattice.dims[0] / kSide; ++i) add(i, j, k);
  }
  band.rest.assign(band.blocks.size() * kPoints, Vec3::Zero());  // saved as a whole
  band.known.assign(band.rest.size(), no);
}

Vec3 RestGrid::place_of(const Band& band, std::size_t point) const {
  const Place place = band.place_of(point);
  return origin_ + spacing_ * Vec3(place[2], place[1], place[0]);
}

std::optional<RestGrid::Sample> RestGrid::sample(const Band& band, std::span<const Vec3> values,
                                                 const Vec3& x) const {
  const Vec3 scaled = (x - origin_) / spacing_;
  const Place corner{floor_of(scaled[2]), floor_of(scaled[1]), floor_of(scaled[0])};
  const Vec3 t = scaled - Vec3(corner[2], corner[1], corner[0]);
  Sample result{Vec3::Zero(), Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)};
  for (int c = 0; c < 8; ++c) {
    const int i = c & 1, j = c >> 1 & 1, k = c >> 2;
    const std::ptrdiff_t point = band.find({corner[0] + k, corner[1] + j, corner[2] + i});
    if (point < 0 || band.known[point] == no) return std::nullopt;
    const Vec3& value = values[point];
    result.value += (i ? t[0] : 1 - t[0]) * (j ? t[1] : 1 - t[1]) * (k ? t[2] : 1 - t[2]) * value;
    result.least = result.least.cwiseMin(value);
    result.most = result.most.cwiseMax(value);
  }
  return result;
}

std::optional<Vec3> RestGrid::at(const Vec3& x) const {
  const std::optional<Sample> found = sample(band_, band_.rest, x);
  return found ? std::optional(found->value) : std::nullopt;
}

void RestGrid::step(FieldMotion& motion) {
  find_blocks(*motion.at(motion.t1()), next_);
  trace_back(motion);
  correct(motion);
  parallel_for(next_.rest.size(), [&](std::size_t p) {
    if (next_.known[p] == no) return;
    const Sample before = *sample(band_, band_.rest, from_[p]),
                 corrected = *sample(band_, corrected_, from_[p]);
    next_.rest[p] = corrected.value.cwiseMax(before.least).cwiseMin(before.most);
  });
  continue_next();
  std::swap(band_, next_);
}

/// A X at the points of next_, and where they come from.
void RestGrid::trace_back(FieldMotion& motion) {
  const double dt = motion.t1() - motion.t0();
  const auto end = motion.at(motion.t1()), midway = motion.at(motion.t0() + 0.5 * dt);
  from_.resize(next_.rest.size());
  is_inside_.resize(next_.rest.size());
  parallel_for(next_.rest.size(), [&](std::size_t p) {
    const Vec3 x = place_of(next_, p);
    is_inside_[p] = is_inside(*end, x, spacing_);
    const std::optional<Vec3> from = is_inside_[p] ? traced(*end, *midway, x, -dt) : std::nullopt;
    const std::optional<Sample> before = from ? sample(band_, band_.rest, *from) : std::nullopt;
    if (!before) return;
    from_[p] = *from;
    next_.rest[p] = before->value;
    next_.known[p] = carried;
  });
}

/// X* at the points of band_.
void RestGrid::correct(FieldMotion& motion) {
  const double dt = motion.t1() - motion.t0();
  const auto start = motion.at(motion.t0()), midway = motion.at(motion.t0() + 0.5 * dt);
  corrected_.resize(band_.rest.size());
  parallel_for(band_.rest.size(), [&](std::size_t p) {
    corrected_[p] = band_.rest[p];
    if (band_.known[p] != carried) return;
    const std::optional<Vec3> to = traced(*start, *midway, place_of(band_, p), dt);
    const std::optional<Sample> after = to ? sample(next_, next_.rest, *to) : std::nullopt;
    if (after) corrected_[p] += 0.5 * (band_.rest[p] - after->value);
  });
}

/// The mean of the linear continuations along the axes; of constant ones where a single point is known.
std::optional<Vec3> RestGrid::continued_at(std::size_t point) const {
  const Place place = next_.place_of(point);
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int a = 0; a < 3; ++a)
    for (const int way : {-1, 1}) {
      Place neighbour = place;
      neighbour[a] += way;
      const std::ptrdiff_t near = next_.find(neighbour);
      if (near < 0 || next_.known[near] == no) continue;
      neighbour[a] += way;
      const std::ptrdiff_t far = next_.find(neighbour);
      const bool both = far >= 0 && next_.known[far] != no;
      sum += both ? 2 * next_.rest[near] - next_.rest[far] : next_.rest[near];
      ++count;
    }
  if (count == 0) return std::nullopt;
  return sum / count;
}

void RestGrid::continue_next() {
  const std::size_t n = next_.rest.size();
  found_.resize(n);
  is_found_.resize(n);
  for (int layer = 0; layer < kContinued; ++layer) {
    parallel_for(n, [&](std::size_t p) {
      const std::optional<Vec3> found = next_.known[p] == no ? continued_at(p) : std::nullopt;
      is_found_[p] = found.has_value();
      if (found) found_[p] = *found;
    });
    parallel_for(n, [&](std::size_t p) {
      if (!is_found_[p]) return;
      next_.rest[p] = found_[p];
      next_.known[p] = continued;
    });
  }
  parallel_for(n, [&](std::size_t p) {
    if (next_.known[p] != no || !is_inside_[p]) return;
    next_.rest[p] = place_of(next_, p);
    next_.known[p] = continued;
  });
}

}  // namespace kappaflow
