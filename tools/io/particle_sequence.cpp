#include "tools/io/particle_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <span>
#include <system_error>
#include <utility>

#include "core/errors.h"
#include "tools/io/near_surface.h"
#include "tools/io/ordered_particles.h"
#include "tools/io/parallel_vtk.h"
#include "tools/io/particle_survey.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// What is said about ids, velocities and particles that are left out.
std::vector<std::string> array_notes(const ParticleSurvey& s, ParticleSequence::Velocity velocity) {
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

std::optional<std::string> displacement_note(const ParticleSurvey& s, double frames_per_second) {
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
std::string rate_hint(const ParticleSurvey& s) {
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

ParticleSequence::ParticleSequence(FileSeries series, std::optional<double> frames_per_second,
                                   const std::function<void(std::size_t file)>& watch,
                                   const ParticleChoice& choice)
    : series_(std::move(series)), inputs_(series_) {
  if (!choice.all) choose(choice);
  const ParticleSurvey found = survey(inputs_, series_, watch);
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
  ParticleFrame result = ordered_frame(now, order, time(frame));
  Particles& particles = result.particles;
  if (radius_ > 0) {
    particles.scale.resize(order.size(), 1);
    for (std::size_t k = 0; k < order.size(); ++k) particles.scale[k] *= now.radius[order[k]] / radius_;
  }
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
