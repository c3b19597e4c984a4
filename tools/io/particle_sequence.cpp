#include "tools/io/particle_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <span>
#include <system_error>
#include <utility>

#include "core/errors.h"
#include "core/hashed_bins.h"
#include "core/nearest_points.h"
#include "core/quantile.h"
#include "core/split_mix.h"
#include "core/text_hash.h"
#include "tools/io/frame_times.h"
#include "tools/io/near_surface.h"
#include "tools/io/parallel_vtk.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// Indices of the particles in ascending order of their ids.
std::vector<std::size_t> order_by_id(std::span<const std::int64_t> id) {
  std::vector<std::size_t> order(id.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!std::ranges::is_sorted(id)) std::ranges::stable_sort(order, {}, [&](std::size_t i) { return id[i]; });
  return order;
}

template <class T>
std::vector<T> ordered(const std::vector<T>& values, std::span<const std::size_t> order) {
  std::vector<T> result;
  if (values.empty()) return result;
  result.reserve(order.size());
  for (const std::size_t i : order) result.push_back(values[i]);
  return result;
}

/// An id that several particles have.
std::optional<std::int64_t> repeated_id(std::vector<std::int64_t> id) {
  std::ranges::sort(id);
  const auto found = std::ranges::adjacent_find(id);
  return found == id.end() ? std::nullopt : std::optional(*found);
}

using IndexPairs = std::span<const std::pair<std::size_t, std::size_t>>;

/// Pairs of particles with the same id, by their indices in both frames. No id occurs twice in a frame.
std::vector<std::pair<std::size_t, std::size_t>> pairs_by_id(const InputFrame& before,
                                                             const InputFrame& after) {
  const std::vector<std::size_t> a = order_by_id(before.id), b = order_by_id(after.id);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const std::int64_t id = before.id[a[i]], other = after.id[b[j]];
    if (id == other) pairs.emplace_back(a[i], b[j]);
    i += id <= other;
    j += other <= id;
  }
  return pairs;
}

/// How far particles move between frames, beside what their velocities say.
struct Displacements {
  double along_velocity = 0;  // sum of displacement . velocity [m2/s]
  double velocity2 = 0;       // sum of |velocity|^2 [m2/s2]
  double displacement2 = 0;   // sum of |displacement|^2 [m2]

  void add(const InputFrame& before, const InputFrame& after, IndexPairs pairs) {
    for (const auto& [p, q] : pairs) {
      const Vec3 displacement = after.position[q] - before.position[p];
      const Vec3 velocity = 0.5 * (before.velocity[p] + after.velocity[q]);
      along_velocity += displacement.dot(velocity);
      velocity2 += velocity.squaredNorm();
      displacement2 += displacement.squaredNorm();
    }
  }

  bool any_motion() const { return along_velocity > 0; }
  double frames_per_second() const { return velocity2 / along_velocity; }  // by least squares
  /// Share of the displacements that velocities account for, in [0, 1].
  double agreement() const { return along_velocity * along_velocity / (velocity2 * displacement2); }
};

/// How particles move in a frame beside their neighbours: medians, in large frames of some of them [m].
struct NeighbourMotion {
  double spacing;  // to a neighbour
  double own;      // a particle's motion, less that of all
  double apart;    // a particle's motion, less its neighbour's
};

NeighbourMotion neighbour_motion(const InputFrame& before, const InputFrame& after, IndexPairs pairs) {
  constexpr std::size_t kEnough = 10000;
  const std::size_t stride = 2 * (pairs.size() / (2 * kEnough) + 1);
  Vec3 mean = Vec3::Zero();
  std::array<std::vector<Vec3>, 2> place, motion;  // of some particles, and of every other one
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Vec3& from = before.position[pairs[k].first];
    const Vec3 moved = after.position[pairs[k].second] - from;
    mean += moved / static_cast<double>(pairs.size());
    if (k % 2 == 0 && k % stride != 0) continue;
    place[k % 2].push_back(from);
    motion[k % 2].push_back(moved);
  }
  const std::vector<std::uint32_t> neighbour = nearest_points(place[1], place[0]);
  std::vector<double> spacing, own, apart;
  for (std::size_t i = 0; i < neighbour.size(); ++i) {
    spacing.push_back((place[0][i] - place[1][neighbour[i]]).norm());
    own.push_back((motion[0][i] - mean).norm());
    apart.push_back((motion[0][i] - motion[1][neighbour[i]]).norm());
  }
  return {quantile(spacing, 0.5), quantile(own, 0.5), quantile(apart, 0.5)};
}

/// A sentence where ids do not follow the particles from a frame to the next: where no particle is in both,
/// or where neighbours part, by spacings. A liquid's move alike, however far they move in a frame;
/// docs/track.md has what was measured.
std::string wrong_ids(const InputFrame& before, const InputFrame& after, IndexPairs pairs,
                      const fs::path& file, const fs::path& next) {
  constexpr std::size_t kLeastPairs = 30;
  constexpr double kLeastSpacings = 1, kLeastShare = 0.7;
  if (pairs.empty())
    return fmt::format("no id of {} is in {}: do the ids follow the particles?", file.string(),
                       next.string());
  if (pairs.size() < kLeastPairs) return {};
  const NeighbourMotion motion = neighbour_motion(before, after, pairs);
  if (!(motion.apart > kLeastSpacings * motion.spacing) || !(motion.apart > kLeastShare * motion.own))
    return {};
  return fmt::format(
      "from {} to {} particles part from their neighbours by {:.2g} spacings: do the ids follow the "
      "particles?",
      file.string(), next.string(), motion.apart / motion.spacing);
}

/// What the first reading of all files finds out.
struct Survey {
  explicit Survey(const FileSeries& series) : times(series) {}

  FrameTimes times;
  std::vector<std::size_t> particles;
  std::vector<double> fast_speed;
  Displacements displacements;
  std::string repeated;    // where an id is used twice; empty: nowhere
  std::string wrong_ids;   // where ids do not follow the particles; empty: nowhere
  std::string coincident;  // where particles are in the places of others; empty: nowhere
  std::string id_name, velocity_name, radius_name;
  double radius = 0, smallest = 0, largest = 0;  // median of the first frame; range over all
  std::size_t left_out = 0, kept = 0;
  TextHash hash;

  void add_radii(std::vector<double> radii) {
    if (radii.empty()) return;
    const auto [least, most] = std::ranges::minmax(radii);
    smallest = radius > 0 ? std::min(smallest, least) : least;
    largest = std::max(largest, most);
    if (radius == 0) radius = upper_median(radii);
  }
};

void add_to(TextHash& hash, const InputFrame& frame) {
  const double time = frame.time.value_or(0);
  hash.add_values(std::span(&time, 1));
  hash.add_values(std::span(frame.position));
  if (!frame.zone.empty()) hash.add_values(std::span(&frame.all, 1));
  hash.add_values(std::span(frame.id));
  hash.add_values(std::span(frame.velocity));
  hash.add_values(std::span(frame.density));
  hash.add_values(std::span(frame.pressure));
  hash.add_values(std::span(frame.temperature));
  hash.add_values(std::span(frame.source));
  hash.add_values(std::span(frame.radius));
}

std::string coincidence_note(const InputFrame& frame, const fs::path& file) {
  const Coincidence found = coincident_particles(frame.position);
  if (found.count == 0) return {};
  const auto name = [&](std::size_t i) {
    return frame.id.empty() ? fmt::format("number {}", i) : fmt::format("{}", frame.id[i]);
  };
  return fmt::format("{} particles of {} are where others are, e.g. {} and {}", found.count, file.string(),
                     name(found.first), name(found.second));
}

void check_same_array(const char* what, const std::string& first_name, const std::string& name,
                      const fs::path& first, const fs::path& file) {
  if (first_name.empty() == name.empty()) return;
  const bool missing = name.empty();
  throw InvalidInput({(missing ? file : first).string()},
                     fmt::format("has no {}; {} has them (\"{}\")", what, (missing ? first : file).string(),
                                 missing ? first_name : name));
}

Survey survey(InputFrames& frames, const FileSeries& series,
              const std::function<void(std::size_t file)>& watch) {
  Survey found(series);
  const std::vector<fs::path>& files = series.files;
  for (std::size_t k = 0; k < files.size(); ++k) {
    if (watch) watch(k);
    const fs::path& file = files[k];
    const InputFrame& frame = frames[k];
    const bool is_first = k == 0;
    if (is_first)
      found.id_name = frame.id_name, found.velocity_name = frame.velocity_name,
      found.radius_name = frame.radius_name;
    check_same_array("ids", found.id_name, frame.id_name, files.front(), file);
    check_same_array("velocities", found.velocity_name, frame.velocity_name, files.front(), file);
    check_same_array("radii", found.radius_name, frame.radius_name, files.front(), file);
    found.add_radii(frame.radius);
    found.times.add(frame.time);
    if (const auto id = repeated_id(frame.id); id && found.repeated.empty())
      found.repeated = fmt::format("{} has several particles with the id {}", file.string(), *id);
    if (found.coincident.empty()) found.coincident = coincidence_note(frame, file);
    if (!is_first && found.repeated.empty() && !frame.id.empty()) {
      const InputFrame& before = frames[k - 1];
      const auto pairs = pairs_by_id(before, frame);
      if (!frame.velocity.empty()) found.displacements.add(before, frame, pairs);
      if (found.wrong_ids.empty()) found.wrong_ids = wrong_ids(before, frame, pairs, files[k - 1], file);
    }
    found.particles.push_back(frame.all);
    found.kept += frame.position.size();
    found.fast_speed.push_back(frame.fast_speed);
    found.left_out += frame.left_out;
    add_to(found.hash, frame);
  }
  return found;
}

/// What is said about ids, velocities and particles that are left out.
std::vector<std::string> array_notes(const Survey& s, ParticleSequence::Velocity velocity) {
  std::vector<std::string> notes;
  const auto [fewest, most] = std::ranges::minmax(s.particles);
  notes.push_back(fewest == most ? fmt::format("{} particles", most)
                                 : fmt::format("{} to {} particles", fewest, most));
  if (s.id_name.empty())
    notes.emplace_back("no ids: particles are not matched between frames");
  else if (!s.repeated.empty())
    notes.push_back(fmt::format("ids \"{}\" cannot be used: {}", s.id_name, s.repeated));
  else
    notes.push_back(fmt::format("matched by id (\"{}\")", s.id_name));
  using enum ParticleSequence::Velocity;
  if (velocity == given) notes.push_back(fmt::format("velocities from \"{}\"", s.velocity_name));
  if (velocity == estimated) notes.emplace_back("no velocities: estimated from positions by id");
  if (velocity == unknown)
    notes.emplace_back("no velocities: point clouds, tracked by the change of their field");
  if (!s.radius_name.empty())
    notes.push_back(s.smallest == s.largest
                        ? fmt::format("one radius (\"{}\")", s.radius_name)
                        : fmt::format("radii \"{}\", {:.3g} to {:.3g} times the median: each its own sigma",
                                      s.radius_name, s.smallest / s.radius, s.largest / s.radius));
  if (s.left_out > 0)
    notes.push_back(fmt::format("{} particles of walls or ghosts are left out, over all frames", s.left_out));
  return notes;
}

std::optional<std::string> displacement_note(const Survey& s, double frames_per_second) {
  constexpr double kLeastAgreement = 0.5, kTolerance = 0.1;
  const Displacements& d = s.displacements;
  if (!d.any_motion()) return std::nullopt;
  if (d.agreement() < kLeastAgreement)
    return fmt::format(
        "velocities account for {:.0f} % of how particles with the same id move: do the ids follow "
        "the particles?",
        100 * d.agreement());
  if (std::abs(d.frames_per_second() / frames_per_second - 1) > kTolerance)
    return fmt::format("velocities and displacements fit {:.3g} frames a second, not {:.3g}",
                       d.frames_per_second(), frames_per_second);
  return std::nullopt;
}

/// What is known of frames a second where nobody has said it.
std::string rate_hint(const Survey& s) {
  if (!s.displacements.any_motion()) return {};
  return fmt::format(" (velocities and displacements fit {:.3g})", s.displacements.frames_per_second());
}

/// The derivative at time t of the polynomial through (time, position), of which there are one to three.
Vec3 derivative_at(double t, std::span<const double> time, std::span<const Vec3> position) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < time.size(); ++i)  // Lagrange: d/dt prod_j (t - t_j)/(t_i - t_j), j != i
    for (std::size_t j = 0; j < time.size(); ++j) {
      if (j == i) continue;
      double slope = 1 / (time[i] - time[j]);
      for (std::size_t k = 0; k < time.size(); ++k)
        if (k != i && k != j) slope *= (t - time[k]) / (time[i] - time[k]);
      sum += slope * position[i];
    }
  return sum;
}

}  // namespace

Coincidence coincident_particles(std::span<const Vec3> position) {
  const auto key_of = [](const Vec3& x) {
    std::uint64_t key = 0;
    for (const double c : x) key = split_mix(key + std::bit_cast<std::uint64_t>(c + 0.0));  // -0 is 0
    return key;
  };
  std::vector<HashedBins::Entry> entries(position.size());
  for (std::size_t i = 0; i < position.size(); ++i) entries[i] = {key_of(position[i]), static_cast<int>(i)};
  const HashedBins bins(entries);
  Coincidence found;
  for (std::size_t i = 0; i < position.size(); ++i)
    for (const HashedBins::Entry& other : bins.near(entries[i].key)) {
      const auto before = static_cast<std::size_t>(other.number);
      if (before >= i) break;
      if (position[before] != position[i]) continue;
      if (found.count++ == 0) found.first = before, found.second = i;
      break;
    }
  return found;
}

ParticleSequence::ParticleSequence(FileSeries series, std::optional<double> frames_per_second,
                                   const std::function<void(std::size_t file)>& watch,
                                   const ParticleChoice& choice)
    : series_(std::move(series)), inputs_(series_) {
  if (!choice.all) choose(choice);
  const Survey found = survey(inputs_, series_, watch);
  found.times.check_gap();
  hash_ = found.hash.text();
  time_ = found.times.times(frames_per_second, rate_hint(found));
  matched_ = !found.id_name.empty() && found.repeated.empty();
  using enum Velocity;
  velocity_ = !found.velocity_name.empty() ? given : matched_ ? estimated : unknown;
  radius_ = found.smallest < found.largest ? found.radius : 0;
  particles_ = found.particles;
  fast_speed_ = found.fast_speed;
  first_id_.resize(size());
  std::exclusive_scan(particles_.begin(), particles_.end(), first_id_.begin(), std::size_t{0});

  std::ranges::move(array_notes(found, velocity_), std::back_inserter(notes_));
  if (!keeps_all_)
    notes_.push_back(fmt::format(
        "{} particles a frame are near the surface, or stand for others in the depth", found.kept / size()));
  const double mean_rate = static_cast<double>(size() - 1) / (time_.back() - time_.front());
  std::ranges::move(found.times.notes(frames_per_second), std::back_inserter(notes_));
  if (!found.coincident.empty()) notes_.push_back(found.coincident);
  if (!found.wrong_ids.empty())
    notes_.push_back(found.wrong_ids);
  else if (const auto note = displacement_note(found, mean_rate))
    notes_.push_back(*note);
}

/// Decides from the first and the last frame.
void ParticleSequence::choose(const ParticleChoice& choice) {
  constexpr std::size_t kLeastBytes = 4;  // of a particle in a file
  for (const std::size_t k : {std::size_t{0}, size() - 1}) {
    const auto files = series_.files_of(k);
    std::uintmax_t bytes = 0;
    for (const fs::path& file : files)
      for (const fs::path& piece : pieces_of(file)) {
        std::error_code ignored;  // who reads it says what is wrong
        const std::uintmax_t size = fs::file_size(piece, ignored);
        bytes += ignored ? 0 : size;
      }
    if (bytes / kLeastBytes <= choice.many) continue;
    const FrameContent content = content_of(files);
    if (content.particles <= choice.many) continue;
    if (content.has_several_radii || (content.has_ids && !content.has_velocities)) {
      notes_.push_back(
          fmt::format("all particles are kept, also in the depth: they {}",
                      content.has_several_radii ? "have several radii" : "have ids and no velocities"));
      return;
    }
    keeps_all_ = false;
  }
  if (!keeps_all_)
    inputs_.keep_near_surface(choice.sigma ? *choice.sigma : 2 * rough_spacing(series_.files_of(0)));
}

ParticleFrame ParticleSequence::frame(std::size_t frame) {
  const InputFrame& now = inputs_[frame];
  std::vector<std::size_t> order(now.position.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (matched_) order = order_by_id(now.id);
  if (!keeps_all_) std::erase_if(order, [&](std::size_t i) { return now.zone[i] == Zone::passing; });
  return frame_of(frame, order);
}

Particles ParticleSequence::arrival(std::size_t frame, std::span<const std::int64_t> before) {
  if (!matched_) return this->frame(frame).particles;
  const InputFrame& now = inputs_[frame];
  std::vector<std::size_t> order = order_by_id(now.id);
  std::erase_if(order, [&](std::size_t i) {
    return now.zone[i] > Zone::middle && !std::ranges::binary_search(before, now.id[i]);
  });
  inputs_.forget_before(frame);
  return frame_of(frame, order).particles;
}

std::pair<std::vector<Vec3>, std::vector<std::uint32_t>> ParticleSequence::inside() {
  const InputFrame& first = inputs_[0];
  std::vector<Vec3> position;
  std::vector<std::uint32_t> middle;
  for (std::size_t i = 0; i < first.position.size(); ++i) {
    if (first.zone[i] > Zone::inner) continue;
    if (first.zone[i] == Zone::middle) middle.push_back(static_cast<std::uint32_t>(position.size()));
    position.push_back(first.position[i]);
  }
  return {std::move(position), std::move(middle)};
}

/// Of the particles of these indices.
ParticleFrame ParticleSequence::frame_of(std::size_t frame, std::span<const std::size_t> order) {
  const InputFrame& now = inputs_[frame];
  ParticleFrame result{{time(frame), {}, ordered(now.position, order), ordered(now.velocity, order)},
                       ordered(now.density, order),
                       ordered(now.pressure, order),
                       ordered(now.source, order),
                       ordered(now.temperature, order)};
  Particles& particles = result.particles;
  if (radius_ > 0)
    for (const std::size_t i : order) particles.scale.push_back(now.radius[i] / radius_);
  if (!keeps_all_) {
    particles.scale.resize(order.size(), 1);
    for (std::size_t k = 0; k < order.size(); ++k) particles.scale[k] *= scale_of(now.zone[order[k]]);
  }
  particles.id = ordered(now.id, order);
  if (!matched_) {
    particles.id.resize(order.size());
    std::iota(particles.id.begin(), particles.id.end(), static_cast<std::int64_t>(first_id_[frame]));
  }
  if (velocity_ == Velocity::unknown) particles.velocity.assign(order.size(), Vec3::Zero());
  if (velocity_ == Velocity::estimated) estimate_velocities(frame, particles);
  return result;
}

void ParticleSequence::estimate_velocities(std::size_t frame, Particles& particles) {
  const std::size_t window = std::min<std::size_t>(3, size());
  const std::size_t first = std::min(frame == 0 ? 0 : frame - 1, size() - window);
  std::vector<std::vector<double>> times(particles.size());
  std::vector<std::vector<Vec3>> places(particles.size());
  for (std::size_t k = first; k < first + window; ++k) {
    const InputFrame& near = inputs_[k];
    const std::vector<std::size_t> order = order_by_id(near.id);
    for (std::size_t i = 0, j = 0; i < particles.size() && j < order.size();) {
      const std::int64_t id = particles.id[i], other = near.id[order[j]];
      if (id == other) {
        times[i].push_back(time(k));
        places[i].push_back(near.position[order[j]]);
      }
      i += id <= other;
      j += other <= id;
    }
  }
  particles.velocity.resize(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.velocity[i] = derivative_at(time(frame), times[i], places[i]);
}

}  // namespace kappaflow
