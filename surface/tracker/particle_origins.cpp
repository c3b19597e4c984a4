#include "surface/tracker/particle_origins.h"

#include <algorithm>

namespace kappaflow {

void ParticleOrigins::see(const Particles& particles) {
  if (std::ranges::includes(id_, particles.id)) return;
  std::vector<std::int64_t> id;
  std::vector<Vec3> origin;
  for (std::size_t i = 0, k = 0; i < particles.size() || k < id_.size();) {
    const bool is_known = k < id_.size() && (i == particles.size() || id_[k] <= particles.id[i]);
    id.push_back(is_known ? id_[k] : particles.id[i]);
    origin.push_back(is_known ? origin_[k] : particles.position[i]);
    if (i < particles.size() && particles.id[i] == id.back()) ++i;
    if (is_known) ++k;
  }
  id_ = std::move(id);
  origin_ = std::move(origin);
}

std::vector<Vec3> ParticleOrigins::of(const Particles& particles) const {
  std::vector<Vec3> result;
  result.reserve(particles.size());
  auto at = id_.begin();
  for (const std::int64_t id : particles.id) {
    at = std::lower_bound(at, id_.end(), id);
    result.push_back(origin_[at - id_.begin()]);
  }
  return result;
}

}  // namespace kappaflow
