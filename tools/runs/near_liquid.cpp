#include "tools/runs/near_liquid.h"

#include <algorithm>
#include <utility>

#include "core/errors.h"
#include "solver/broadcast_state.h"
#include "surface/field/particle_weights.h"
#include "tools/io/files.h"
#include "tools/io/near_surface.h"
#include "tools/io/ordered_particles.h"
#include "tools/io/vtp_files.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

double field_sigma(const Scene& scene) {
  return scene.surface.sigma * scene.fluid.spacing;
}

InputFrame input_frame(ParticleFrame own) {
  InputFrame frame;
  frame.position = std::move(own.particles.position);
  frame.id = std::move(own.particles.id);
  frame.velocity = std::move(own.particles.velocity);
  frame.density = std::move(own.density);
  frame.pressure = std::move(own.pressure);
  frame.temperature = std::move(own.temperature);
  frame.source = std::move(own.source);
  return frame;
}

}  // namespace

void LiquidPart::announce(const RankOrder& order) {
  if (ranks_ != nullptr && ranks_->rank() == 0) ranks_->announce(order);
}

LiquidRecord LiquidPart::near_surface(bool known) {
  announce({RankTask::find_near, known ? 1.0 : 0.0});
  ParticleFrame own =
      known ? particle_frame(fluid_, Whose::own) : ParticleFrame{fluid_.particles(Whose::own), {}, {}, {}};
  LiquidRecord record;
  if (known) measure(own, record);
  const InputFrame near = near_surface_of(input_frame(std::move(own)), field_sigma(scene_), ranks_);
  record.particles = ordered_frame(near, order_by_id(near.id), fluid_.time());
  record.count = near.all;
  record.bodies = fluid_.bodies();
  record.taken = fluid_.taken();
  if (ranks_ != nullptr) ranks_->finish();
  return record;
}

/// What is said of all particles: of the ranks' shares.
void LiquidPart::measure(const ParticleFrame& own, LiquidRecord& record) const {
  record.compression = compression(own.density, fluid_.fluids(Whose::own), scene_.fluid);
  record.temperature = temperature_range(own.temperature);
  record.pieces = 1;
  if (ranks_ == nullptr) return;
  record.pieces = std::max(1, ranks_->sum(own.particles.size() > 0 ? 1 : 0));
  struct Sums {
    double particles, compression, compression_max, temperature, temperature_min, temperature_max;
  };
  const double n = static_cast<double>(own.particles.size());
  const TemperatureRange range = record.temperature.value_or(TemperatureRange{kInfinity, 0, 0});
  const Sums all = ranks_->combined(
      Sums{n, n * record.compression.mean, record.compression.max, n * range.mean, range.min, range.max},
      [](const Sums& a, const Sums& b) {
        return Sums{a.particles + b.particles,
                    a.compression + b.compression,
                    std::max(a.compression_max, b.compression_max),
                    a.temperature + b.temperature,
                    std::min(a.temperature_min, b.temperature_min),
                    std::max(a.temperature_max, b.temperature_max)};
      });
  if (all.particles == 0) return;
  record.compression = {all.compression / all.particles, all.compression_max};
  if (scene_.fluid.heat)
    record.temperature = {all.temperature_min, all.temperature / all.particles, all.temperature_max};
}

void LiquidPart::write_particles(const std::filesystem::path& folder, int frame) {
  announce({RankTask::write_particles, static_cast<double>(frame)});
  std::string run = folder.string(), failure;
  if (ranks_ != nullptr) broadcast_state(*ranks_, run);
  try {
    write_own(run, frame);
  } catch (const IoError& error) {
    failure = error.what();
  }
  if (ranks_ != nullptr) {  // what came of it on any of them, once all are through
    const std::vector<std::size_t> sizes = ranks_->one_of_each(failure.size());
    const std::vector<char> all = ranks_->gathered(std::span<const char>(failure), sizes);
    const auto first = std::ranges::find_if(sizes, [](std::size_t size) { return size > 0; });
    failure = first == sizes.end() ? "" : std::string(all.data(), *first);
    ranks_->finish();
    if (ranks_->rank() > 0) return;
  }
  if (!failure.empty()) throw IoError(failure);
}

/// A rank without particles writes nothing, but the first one where there are none at all.
void LiquidPart::write_own(const std::filesystem::path& folder, int frame) const {
  const int rank = ranks_ != nullptr ? ranks_->rank() : 0;
  const std::filesystem::path file = folder / particle_piece(frame, rank);
  const ParticleFrame own = particle_frame(fluid_, Whose::own);
  if (own.particles.size() == 0 && !(rank == 0 && fluid_.size() == 0)) return remove_file(file);
  const double sigma = field_sigma(scene_);
  const std::vector<double> weight = field_weights(own.particles.position, sigma, WeightRule::uniform);
  make_folder(file.parent_path());
  write_vtp(file, *particle_data(own, weight, sigma));
  flush_to_disk(file);
}

void LiquidPart::follow(const RankOrder& order) {
  if (order.task == RankTask::find_near) near_surface(order.value != 0);
  if (order.task == RankTask::write_particles) write_particles({}, static_cast<int>(order.value));
}

}  // namespace kappaflow
