#include "tools/particle_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "core/errors.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// Indices of the particles in ascending order of their ids.
std::vector<std::size_t> order_by_id(std::span<const std::int64_t> id) {
  std::vector<std::size_t> order(id.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return id[i]; });
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

/// How far particles move between frames, beside what their velocities say.
struct Displacements {
  double along_velocity = 0;  // sum of displacement . velocity [m2/s]
  double velocity2 = 0;       // sum of |velocity|^2 [m2/s2]
  double displacement2 = 0;   // sum of |displacement|^2 [m2]

  void add(const InputFrame& before, const InputFrame& after) {
    const std::vector<std::size_t> a = order_by_id(before.id), b = order_by_id(after.id);
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
      const std::size_t p = a[i], q = b[j];
      if (before.id[p] == after.id[q]) {
        const Vec3 displacement = after.position[q] - before.position[p];
        const Vec3 velocity = 0.5 * (before.velocity[p] + after.velocity[q]);
        along_velocity += displacement.dot(velocity);
        velocity2 += velocity.squaredNorm();
        displacement2 += displacement.squaredNorm();
      }
      i += before.id[p] <= after.id[q];
      j += after.id[q] <= before.id[p];
    }
  }

  bool any_motion() const { return along_velocity > 0; }
  double frames_per_second() const { return velocity2 / along_velocity; }  // by least squares
  /// Share of the displacements that velocities account for, in [0, 1].
  double agreement() const { return along_velocity * along_velocity / (velocity2 * displacement2); }
};

/// What the first reading of all files finds out.
struct Survey {
  std::vector<std::optional<double>> time;
  std::vector<std::size_t> particles;
  Displacements displacements;
  std::string repeated;  // where an id is used twice; empty: nowhere
  std::string id_name, velocity_name;
  std::size_t left_out = 0;
};

void check_same_array(const char* what, const std::string& first_name, const std::string& name,
                      const fs::path& first, const fs::path& file) {
  if (first_name.empty() == name.empty()) return;
  const bool missing = name.empty();
  throw InvalidInput({(missing ? file : first).string()},
                     fmt::format("has no {}; {} has them (\"{}\")", what, (missing ? first : file).string(),
                                 missing ? first_name : name));
}

Survey survey(const std::vector<fs::path>& files) {
  Survey found;
  InputFrame before;
  for (const fs::path& file : files) {
    InputFrame frame = read_input_frame(file);
    const bool is_first = found.time.empty();
    if (is_first) found.id_name = frame.id_name, found.velocity_name = frame.velocity_name;
    check_same_array("ids", found.id_name, frame.id_name, files.front(), file);
    check_same_array("velocities", found.velocity_name, frame.velocity_name, files.front(), file);
    if (!is_first && frame.time.has_value() != found.time.front().has_value())
      throw InvalidInput({file.string()},
                         fmt::format("{} a time; {} {}", frame.time ? "holds" : "lacks",
                                     files.front().string(), frame.time ? "does not" : "does"));
    if (!is_first && frame.time && !(*frame.time > *found.time.back()))
      throw InvalidInput({file.string()},
                         fmt::format("its time, {} s, is not after that of the file before, {} s",
                                     *frame.time, *found.time.back()));
    if (const auto id = repeated_id(frame.id); id && found.repeated.empty())
      found.repeated = fmt::format("{} has several particles with the id {}", file.string(), *id);
    if (!is_first && found.repeated.empty() && !frame.id.empty() && !frame.velocity.empty())
      found.displacements.add(before, frame);
    found.time.push_back(frame.time);
    found.particles.push_back(frame.position.size());
    found.left_out += frame.left_out;
    before = std::move(frame);
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

std::vector<double> frame_times(const Survey& s, std::optional<double> frames_per_second,
                                const std::string& series) {
  std::vector<double> time;
  for (std::size_t k = 0; k < s.time.size(); ++k) {
    if (!s.time[k] && !frames_per_second)
      throw InvalidInput(fmt::format(
          "{}: the files hold no times; say how many frames a second they are by --fps{}", series,
          s.displacements.any_motion()
              ? fmt::format(" (velocities and displacements fit {:.3g})", s.displacements.frames_per_second())
              : std::string()));
    time.push_back(s.time[k] ? *s.time[k] : static_cast<double>(k) / *frames_per_second);
  }
  return time;
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

ParticleSequence::ParticleSequence(FileSeries series, std::optional<double> frames_per_second)
    : series_(std::move(series)) {
  const Survey found = survey(series_.files);
  if (!found.time.front() && !series_.gap.empty()) throw InvalidInput(series_.gap);
  time_ = frame_times(found, frames_per_second, series_.name);
  matched_ = !found.id_name.empty() && found.repeated.empty();
  using enum Velocity;
  velocity_ = !found.velocity_name.empty() ? given : matched_ ? estimated : unknown;
  first_id_.resize(size());
  std::exclusive_scan(found.particles.begin(), found.particles.end(), first_id_.begin(), std::size_t{0});

  notes_ = array_notes(found, velocity_);
  const double mean_rate = static_cast<double>(size() - 1) / (time_.back() - time_.front());
  notes_.push_back(fmt::format("times {} to {:.6g} s, {}", time_.front(), time_.back(),
                               found.time.front() ? std::string("from the files")
                                                  : fmt::format("{} frames a second", *frames_per_second)));
  if (found.time.front() && frames_per_second) notes_.emplace_back("--fps is not used: the files hold times");
  if (!series_.gap.empty()) notes_.push_back(series_.gap);
  if (const auto note = displacement_note(found, mean_rate)) notes_.push_back(*note);
}

const InputFrame& ParticleSequence::input(std::size_t frame) {
  if (const auto found = inputs_.find(frame); found != inputs_.end()) return found->second;
  constexpr std::size_t kKept = 3;
  if (inputs_.size() == kKept) inputs_.erase(inputs_.begin());
  return inputs_.emplace(frame, read_input_frame(file(frame))).first->second;
}

SequenceFrame ParticleSequence::frame(std::size_t frame) {
  const InputFrame& now = input(frame);
  std::vector<std::size_t> order(now.position.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (matched_) order = order_by_id(now.id);
  SequenceFrame result{{time(frame), {}, ordered(now.position, order), ordered(now.velocity, order)},
                       ordered(now.density, order),
                       ordered(now.pressure, order),
                       ordered(now.source, order)};
  Particles& particles = result.particles;
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
    const InputFrame& near = input(k);
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
