#include "solver/halo.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "core/bytes.h"
#include "solver/kernel.h"
#include "solver/neighbours.h"

namespace kappaflow {
namespace {

// Beyond the kernel's support, which rounding must not make a neighbour of a particle that is no ghost.
constexpr float kMargin = 0.01f;      // [spacings]
constexpr float kRounding = 1e-6f;    // of a position
constexpr std::size_t kChunk = 1024;  // particles that one task looks at
constexpr double kMostRoom = 1.5;     // times a rank's particles, that their arrays may have

template <class T>
void append(std::vector<std::byte>& bytes, const std::vector<T>& values,
            std::span<const std::uint32_t> index) {
  std::size_t at = bytes.size();
  bytes.resize(at + sizeof(T) * index.size());
  for (const std::uint32_t i : index) {
    std::memcpy(&bytes[at], static_cast<const void*>(&values[i]), sizeof(T));
    at += sizeof(T);
  }
}

/// Takes `count` values from the front of what is left.
template <class T>
void take(std::span<const std::byte>& bytes, std::size_t count, std::vector<T>& values) {
  const std::size_t before = values.size();
  resize_closely(values, before + count);
  if (count > 0) std::memcpy(static_cast<void*>(&values[before]), bytes.data(), sizeof(T) * count);
  bytes = bytes.subspan(sizeof(T) * count);
}

}  // namespace

std::size_t Halo::bytes() const {
  return grid_.bytes() + plan_.bytes() + exchange_.bytes() + bytes_of(beside_, of_rows_);
}

void Halo::migrate(FluidParticles& particles) {
  cut_.cut(particles.position, ranks_);
  const std::size_t n = particles.size();
  std::vector<int> owner(n);
  parallel_for(n, [&](std::size_t i) { owner[i] = cut_.owner_of(cut_.place_of(particles.position[i])); });
  std::vector<std::vector<std::uint32_t>> leaving(static_cast<std::size_t>(ranks_.size()));
  for (std::uint32_t i = 0; i < n; ++i) leaving[static_cast<std::size_t>(owner[i])].push_back(i);
  std::vector<std::uint32_t> kept;
  kept.swap(leaving[static_cast<std::size_t>(ranks_.rank())]);
  std::size_t width = 0;
  FluidParticles::for_state(heat_, [&](auto member) { width += sizeof((particles.*member)[0]); });
  std::vector<std::vector<std::byte>> packages(leaving.size());  // one a rank
  for (std::size_t r = 0; r < packages.size(); ++r) packages[r].reserve(width * leaving[r].size());
  FluidParticles::for_state(heat_, [&](auto member) {
    for (std::size_t r = 0; r < packages.size(); ++r) append(packages[r], particles.*member, leaving[r]);
  });
  packages = swapped(ranks_, std::move(packages));
  if (kept.size() < n) particles.keep(kept);
  for (const std::vector<std::byte>& package : packages) {
    std::span<const std::byte> left(package);
    const std::size_t count = package.size() / width;
    FluidParticles::for_state(heat_, [&](auto member) { take(left, count, particles.*member); });
  }
  if (static_cast<double>(particles.id.capacity()) > kMostRoom * static_cast<double>(particles.size()))
    particles.shrink();
  own_ = particles.size();
  counts_ = ranks_.one_of_each(own_);
  total_ = std::accumulate(counts_.begin(), counts_.end(), std::size_t{0});
}

/// Fills plan_.sent: a particle goes to every rank that owns a cell within the support of it.
void Halo::find_sent(const FluidParticles& particles) {
  struct Sent {
    std::uint32_t particle;
    int rank;
  };
  const std::size_t n = particles.size(), chunks = (n + kChunk - 1) / kChunk;
  std::vector<std::vector<Sent>> found(chunks);
  const int own = ranks_.rank();
  const auto is_inside = [&](const LiquidCut::Place& place) {
    for (std::int64_t z = place[2] - 1; z <= place[2] + 1; ++z)
      for (std::int64_t y = place[1] - 1; y <= place[1] + 1; ++y)
        for (std::int64_t x = place[0] - 1; x <= place[0] + 1; ++x)
          if (cut_.owner_of({x, y, z}) != own) return false;
    return true;
  };
  const auto look = [&](std::size_t i, std::vector<Sent>& sent) {
    const Vec4f& x = particles.position[i];
    const Vec4f reach = Vec4f::Constant((2 + kMargin) * spacing_) + kRounding * x.cwiseAbs();
    const auto low = cut_.place_of(x - reach), high = cut_.place_of(x + reach);
    const std::size_t before = sent.size();
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t cell = low[0]; cell <= high[0]; ++cell) {
          const int owner = cut_.owner_of({cell, y, z});
          if (owner == own) continue;
          if (std::any_of(sent.begin() + static_cast<std::ptrdiff_t>(before), sent.end(),
                          [&](const Sent& s) { return s.rank == owner; }))
            continue;
          sent.push_back({static_cast<std::uint32_t>(i), owner});
        }
  };
  parallel_for(
      chunks,
      [&](std::size_t chunk) {
        LiquidCut::Place last{};
        bool inside = false;
        for (std::size_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i) {
          const LiquidCut::Place place = cut_.place_of(particles.position[i]);
          if (place != last || i == chunk * kChunk) inside = is_inside(place);
          last = place;
          if (!inside) look(i, found[chunk]);
        }
      },
      1);
  std::vector<std::vector<std::uint32_t>> to(static_cast<std::size_t>(ranks_.size()));
  for (const std::vector<Sent>& sent : found)
    for (const Sent& s : sent) to[static_cast<std::size_t>(s.rank)].push_back(s.particle);
  plan_.sent.clear();
  for (std::size_t r = 0; r < to.size(); ++r) plan_.sent.add(static_cast<int>(r), to[r]);
}

void Halo::find_ghosts(FluidParticles& particles) {
  find_sent(particles);
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(ranks_.size()), 0);
  plan_.sent.for_parts([&](int rank, std::span<const std::uint32_t> of_rank) {
    counts[static_cast<std::size_t>(rank)] = of_rank.size();
  });
  counts = swapped_counts(ranks_, counts);
  // First as they come, then in the order of a grid of their own.
  RankIndices& ghosts = plan_.received;
  ghosts.clear();
  std::vector<std::uint32_t> of_rank;
  for (std::size_t r = 0; r < counts.size(); ++r) {
    of_rank.resize(counts[r]);
    std::iota(of_rank.begin(), of_rank.end(), static_cast<std::uint32_t>(ghosts.index.size()));
    ghosts.add(static_cast<int>(r), of_rank);
  }
  share(particles.position);
  grid_.build(std::span<const Vec4f>(particles.position).subspan(own_), static_cast<double>(2 * spacing_));
  for (std::uint32_t k = 0; k < ghost_count(); ++k) ghosts.index[grid_.order()[k]] = k;
  share(particles.position);
  share(particles.fluid);
  share(particles.led_by);
}

void Halo::find_beside(const NeighbourLists& lists) {
  beside_.resize(own_);
  parallel_for(own_, [&](std::size_t i) {
    const std::span<const PairBlock> blocks = lists.of(i);  // whose particles ascend
    beside_[i] =
        !blocks.empty() && blocks.back().base + *std::ranges::max_element(blocks.back().offset) >= own_;
  });
}

void Halo::collect(const FluidParticles& particles, bool motion, FluidParticles& whole) const {
  const auto collect_one = [&](auto member) {
    using T = typename std::decay_t<decltype(particles.*member)>::value_type;
    whole.*member = ranks_.gathered_to_first(std::span<const T>(particles.*member).first(own_), counts_);
  };
  if (motion) {
    collect_one(&FluidParticles::id);
    collect_one(&FluidParticles::position);
    collect_one(&FluidParticles::velocity);
  } else {
    FluidParticles::for_state(heat_, collect_one);
    collect_one(&FluidParticles::density);
  }
  whole.made = particles.made;
  whole.mass_of_fluid = particles.mass_of_fluid;
}

}  // namespace kappaflow
