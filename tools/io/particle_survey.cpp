#include "tools/io/particle_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "core/errors.h"
#include "core/hashed_bins.h"
#include "core/nearest_points.h"
#include "core/quantile.h"
#include "core/split_mix.h"
#include "tools/io/ordered_particles.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// An id that several particles have.
std::optional<std::int64_t> repeated_id(std::vector<std::int64_t> id) {
  std::ranges::sort(id);
  const auto found = std::ranges::adjacent_find(id);
  return found == id.end() ? std::nullopt : std::optional(*found);
}

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

void Displacements::add(const InputFrame& before, const InputFrame& after, IndexPairs pairs) {
  for (const auto& [p, q] : pairs) {
    const Vec3 displacement = after.position[q] - before.position[p];
    const Vec3 velocity = 0.5 * (before.velocity[p] + after.velocity[q]);
    along_velocity += displacement.dot(velocity);
    velocity2 += velocity.squaredNorm();
    displacement2 += displacement.squaredNorm();
  }
}

void ParticleSurvey::add_radii(std::vector<double> radii) {
  if (radii.empty()) return;
  const auto [least, most] = std::ranges::minmax(radii);
  smallest = radius > 0 ? std::min(smallest, least) : least;
  largest = std::max(largest, most);
  if (radius == 0) radius = upper_median(radii);
}

ParticleSurvey survey(InputFrames& frames, const FileSeries& series,
                      const std::function<void(std::size_t file)>& watch) {
  ParticleSurvey found(series);
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

}  // namespace kappaflow
