// What a solver says of itself, and how it is saved; with several ranks, the first one asks the others.
#include <algorithm>
#include <bit>
#include <limits>

#include "core/parallel.h"
#include "core/quantile.h"
#include "core/state_bytes.h"
#include "solver/broadcast_state.h"
#include "solver/fluid_state.h"

namespace kappaflow {
namespace {

/// Where the particles are, by ascending id.
std::vector<std::uint32_t> order_by_id(const FluidParticles& particles) {
  constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(particles.made, kGone);
  for (std::size_t i = 0; i < particles.size(); ++i) place[particles.id[i]] = static_cast<std::uint32_t>(i);
  std::erase(place, kGone);
  return place;
}

/// value(i) of all particles by ascending id, or of a rank's own as they lie.
template <class T, class Value>
std::vector<T> values_of(const FluidParticles& particles, Whose whose, const Value& value) {
  std::vector<T> result(particles.size());
  if (whose == Whose::own) {
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = value(i);
  } else if (particles.size() == particles.made) {  // none is gone
    for (std::size_t i = 0; i < result.size(); ++i) result[particles.id[i]] = value(i);
  } else {
    const std::vector<std::uint32_t> order = order_by_id(particles);
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = value(order[k]);
  }
  return result;
}

}  // namespace

void FluidSolver::State::collect(bool motion) {
  halo->collect(particles, motion, whole);
}

const FluidParticles& FluidSolver::State::all_particles(bool motion) {
  if (ranks == nullptr) return particles;
  const Collected wanted = motion ? Collected::motion : Collected::all;
  if (collected < wanted) {
    together({motion ? RankTask::collect_motion : RankTask::collect_all}, [&] { collect(motion); });
    collected = wanted;
  }
  return whole;
}

/// Finds what follows from the state.
void FluidSolver::State::restart() {
  if (ranks != nullptr) share_restored();
  collected = Collected::nothing;
  walls.move_to(time);
  place_bodies();
  find_neighbours();
  sum_walls();
}

/// What the first rank has read: it keeps the particles until they go to where they belong, and tells the
/// others the rest.
void FluidSolver::State::share_restored() {
  broadcast_state(*ranks, time, steps, fastest, particles.made, emitters, outflows, bodies);
  if (ranks->rank() > 0) particles.keep({});
}

template <class Archive>
void FluidSolver::State::serialize(Archive& archive) {
  if constexpr (Archive::is_loading::value) {
    archive(time, steps, fastest, particles, emitters, outflows, bodies);
    together({RankTask::restore}, [this] { restart(); });
  } else if (ranks == nullptr) {
    archive(time, steps, fastest, particles, emitters, outflows, bodies);
  } else {
    all_particles(false);
    archive(time, steps, fastest, whole, emitters, outflows, bodies);
    whole = {};  // large
    collected = Collected::nothing;
  }
}

template <class Archive>
void FluidSolver::serialize(Archive& archive) {
  archive(*state_);
}
template void FluidSolver::serialize(StateWriter&);
template void FluidSolver::serialize(StateReader&);

template <class Archive>
SavedFluid FluidSolver::take_saved(Archive& archive, const FluidOptions& options,
                                   std::span<const RigidBody> bodies) {
  SavedFluid saved;
  double fastest = 0;
  FluidParticles particles;
  Emitters emitters(options);
  Outflows outflows(options);
  RigidBodies moved(bodies, options.density, options.spacing);
  archive(saved.time, saved.steps, fastest, particles, emitters, outflows, moved);
  saved.bytes = state_bytes(saved.time, saved.steps, fastest, particles, emitters, outflows, moved);
  return saved;
}
template SavedFluid FluidSolver::take_saved(StateReader&, const FluidOptions&, std::span<const RigidBody>);

RankOrder FluidSolver::follow() {
  State& s = *state_;
  for (;;) {
    const RankOrder order = s.ranks->next_order();
    switch (order.task) {
      case RankTask::step:
        s.together(order, [&] { s.step(order.value); });
        break;
      case RankTask::collect_motion:
      case RankTask::collect_all:
        s.collect(order.task == RankTask::collect_motion);
        break;
      case RankTask::restore:
        s.together(order, [&] { s.restart(); });
        break;
      case RankTask::collect_shares:
        s.shares();
        break;
      case RankTask::find_speed:
        s.together(order, [&] { s.fast_speed(order.value); });
        break;
      case RankTask::resume:
      case RankTask::make:
      case RankTask::serve:
      case RankTask::find_near:
      case RankTask::write_particles:
      case RankTask::go_to:
      case RankTask::hear:
      case RankTask::measure_field:
      case RankTask::measure_surface:
      case RankTask::restore_surfaces:
      case RankTask::end:
        return order;
    }
  }
}

bool FluidSolver::can_be_asked() const {
  return state_->ranks == nullptr || !state_->ranks->busy();
}

std::vector<RankShare> FluidSolver::State::shares() const {
  return ranks->one_of_each(
      RankShare{particles.size(), halo->ghost_count(), memory().fluid, own_seconds, ranks->traffic()});
}

std::vector<RankShare> FluidSolver::shares() const {
  std::vector<RankShare> result;
  if (state_->ranks != nullptr)
    state_->together({RankTask::collect_shares}, [&] { result = state_->shares(); });
  return result;
}

SolverMemory FluidSolver::State::memory() const {
  return {particles.bytes() + whole.bytes() + search.bytes() + neighbours.bytes() + wall_sums.bytes() +
              viscosity.bytes() + heat.bytes() + bodies.bytes() + (halo != nullptr ? halo->bytes() : 0),
          walls.bytes(), walls.size()};
}

SolverMemory FluidSolver::memory() const {
  return state_->memory();
}

double FluidSolver::time() const {
  return state_->time;
}
std::size_t FluidSolver::steps() const {
  return state_->steps;
}
std::size_t FluidSolver::size() const {
  return total_size(state_->particles);
}

std::vector<std::size_t> FluidSolver::taken() const {
  return state_->outflows.taken();
}

/// As quantile(): of several ranks eight by eight of the number's bits, which ascend with it.
double FluidSolver::State::fast_speed(double share) const {
  if (total_size(particles) == 0) return 0;
  std::vector<double> speed(particles.size());
  parallel_for(speed.size(),
               [&](std::size_t i) { speed[i] = particles.velocity[i].head<3>().cast<double>().norm(); });
  if (ranks == nullptr) return quantile(speed, share);
  auto left = static_cast<std::uint64_t>(share * static_cast<double>(total_size(particles) - 1));
  std::span<double> within(speed);  // what begins with the bits that are known
  std::uint64_t known = 0;
  for (int shift = 56; shift >= 0; shift -= 8) {
    const auto byte_of = [&](double v) { return std::bit_cast<std::uint64_t>(v) >> shift & 255; };
    std::vector<std::uint64_t> count(256);
    for (const double v : within) ++count[byte_of(v)];
    count = ranks->sum_each(count);
    std::uint64_t byte = 0;
    for (; left >= count[byte]; ++byte) left -= count[byte];
    known |= byte << shift;
    const auto end =
        std::partition(within.begin(), within.end(), [&](double v) { return byte_of(v) == byte; });
    within = within.first(static_cast<std::size_t>(end - within.begin()));
  }
  return std::bit_cast<double>(known);
}

double FluidSolver::fast_speed(double share) const {
  double speed = 0;
  state_->together({RankTask::find_speed, share}, [&] { speed = state_->fast_speed(share); });
  return speed;
}

std::vector<BodyState> FluidSolver::bodies() const {
  std::vector<BodyState> result;
  for (std::size_t b = 0; b < state_->bodies.size(); ++b) result.push_back(state_->bodies.state(b));
  return result;
}

Particles FluidSolver::particles(Whose whose) const {
  const FluidParticles& p = state_->particles_of(whose, true);
  const auto vector = [](const Vec4f& v) -> Vec3 { return v.head<3>().cast<double>(); };
  return {state_->time, values_of<std::int64_t>(p, whose, [&](std::size_t i) { return p.id[i]; }),
          values_of<Vec3>(p, whose, [&](std::size_t i) { return vector(p.position[i]); }),
          values_of<Vec3>(p, whose, [&](std::size_t i) { return vector(p.velocity[i]); })};
}

std::vector<float> FluidSolver::densities(Whose whose) const {
  const FluidParticles& p = state_->particles_of(whose, false);
  return values_of<float>(p, whose, [&](std::size_t i) {
    return static_cast<float>(state_->options.rest_density(p.fluid[i])) * p.density[i];
  });
}

std::vector<float> FluidSolver::pressures(Whose whose) const {
  const FluidParticles& p = state_->particles_of(whose, false);
  return values_of<float>(p, whose, [&](std::size_t i) {
    return static_cast<float>(state_->options.density) * p.density[i] * p.density[i] *
           (p.density_pressure[i] + p.divergence_pressure[i]);
  });
}

std::vector<std::uint8_t> FluidSolver::fluids(Whose whose) const {
  const FluidParticles& p = state_->particles_of(whose, false);
  return values_of<std::uint8_t>(p, whose, [&](std::size_t i) { return p.fluid[i]; });
}

std::vector<double> FluidSolver::temperatures(Whose whose) const {
  if (!state_->options.heat) return {};
  const FluidParticles& p = state_->particles_of(whose, false);
  return values_of<double>(p, whose, [&](std::size_t i) { return p.temperature[i]; });
}

std::vector<int> FluidSolver::sources(Whose whose) const {
  const FluidParticles& p = state_->particles_of(whose, false);
  return values_of<int>(p, whose, [&](std::size_t i) { return p.source[i]; });
}

}  // namespace kappaflow
