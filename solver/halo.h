// Liquid that several ranks share: its particles on their way between them, and copies of those beside a
// rank's own.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/cell_grid.h"
#include "core/parallel.h"
#include "solver/fluid_particles.h"
#include "solver/liquid_cut.h"
#include "solver/rank_exchange.h"

namespace kappaflow {

/// With a sixteenth of room, not the double that growing by a few would take.
template <class T>
void resize_closely(std::vector<T>& values, std::size_t n) {
  if (values.capacity() < n) values.reserve(n + n / 16);
  values.resize(n);
}

/// The kappa of particles, which is in their position[].w.
struct KappaOf {
  std::vector<Vec4f>& position;
};

struct NeighbourLists;

/// Each particle belongs to the rank that owns its cell. The arrays of FluidParticles hold a rank's own
/// particles first and, where loops over pairs read neighbours' values, copies of the other ranks' particles
/// within the kernel's support behind them, the ghosts, which share() fills. Neighbours' lists have rows for
/// own particles only, so loops over FluidParticles::size() and sums over them are those of one rank's share.
class Halo {
 public:
  /// heat: whether particles have temperatures.
  Halo(Ranks& ranks, double spacing, bool heat)
      : ranks_(ranks), cut_(spacing), spacing_(static_cast<float>(spacing)), heat_(heat), exchange_(ranks) {}

  Ranks& ranks() const { return ranks_; }
  const LiquidCut& cut() const { return cut_; }
  std::size_t total() const { return total_; }  ///< particles of all ranks
  std::size_t ghost_count() const { return plan_.received.index.size(); }
  const CellGrid& ghosts() const { return grid_; }  ///< in its order they stand behind the own particles

  /// Cuts the liquid anew and brings every particle to its rank. Precondition: no ghosts.
  void migrate(FluidParticles& particles);
  /// Finds the ghosts for the particles where they are, and fills position, fluid and led_by.
  void find_ghosts(FluidParticles& particles);
  /// The state of all ranks' particles on rank 0, rank by rank; densities too. motion: only id, position and
  /// velocity.
  void collect(const FluidParticles& particles, bool motion, FluidParticles& whole) const;

  /// Finds which particles have ghosts among their neighbours.
  void find_beside(const NeighbourLists& lists);

  /// Fills the ghosts' entries of an array that has one entry a particle. Until they come: meanwhile().
  template <class T>
  void share(
      std::vector<T>& values, const std::function<void()>& meanwhile = [] {}) {
    const std::size_t own = own_;
    resize_closely(values, own + ghost_count());
    exchange<T>([&](std::size_t i) -> const T& { return values[i]; },
                [&](std::size_t ghost, const T& value) { values[own + ghost] = value; }, meanwhile);
  }
  void share(
      const KappaOf& kappa, const std::function<void()>& meanwhile = [] {}) {
    std::vector<Vec4f>& position = kappa.position;
    exchange<float>([&](std::size_t i) { return position[i][3]; },
                    [&](std::size_t ghost, float k) { position[own_ + ghost][3] = k; }, meanwhile);
  }

  /// Calls row(i) for own particles: while the ghosts' entries of `values` are on their way for those without
  /// ghosts among their neighbours.
  template <class Values, class Row>
  void for_rows(Values& values, const Row& row) {
    const auto pass = [&](char beside) {
      parallel_for(own_, [&](std::size_t i) {
        if (beside_[i] == beside) row(i);
      });
    };
    share(values, [&] { pass(0); });
    pass(1);
  }
  /// The same; returns what row(i) returns for each of them.
  template <class Values, class Row>
  const std::vector<float>& of_rows(Values& values, const Row& row) {
    resize_closely(of_rows_, own_);
    for_rows(values, [&](std::size_t i) { of_rows_[i] = row(i); });
    return of_rows_;
  }

  std::size_t bytes() const;

 private:
  void find_sent(const FluidParticles& particles);
  template <class T, class Read, class Write>
  void exchange(const Read& read, const Write& write, const std::function<void()>& meanwhile) {
    const std::span<const T> in = exchange_.swap<T>(plan_.sent, plan_.received, read, meanwhile);
    parallel_for(in.size(), [&](std::size_t k) { write(plan_.received.index[k], in[k]); });
  }

  Ranks& ranks_;
  LiquidCut cut_;
  float spacing_;
  bool heat_;
  std::vector<std::size_t> counts_;
  std::size_t total_ = 0, own_ = 0;
  CellGrid grid_;
  std::vector<char> beside_;    // 1 for an own particle that has ghosts among its neighbours
  std::vector<float> of_rows_;  // of each own particle
  ExchangePlan plan_;           // from own particles that are ghosts elsewhere to the ghosts here
  RankExchange exchange_;
};

/// Fills the ghosts' entries, where there are any.
template <class T>
void fill_ghosts(const FluidParticles& particles, std::vector<T>& values) {
  if (particles.halo != nullptr) particles.halo->share(values);
}

/// The same of kappa, in position[].w.
inline void fill_kappa_of_ghosts(FluidParticles& particles) {
  if (particles.halo != nullptr) particles.halo->share(KappaOf{particles.position});
}

/// Calls row(i) for every particle, where the ghosts' entries of `values` are filled if it has ghosts among
/// its neighbours.
template <class Values, class Row>
void for_rows(const FluidParticles& particles, Values& values, const Row& row) {
  if (particles.halo == nullptr) return parallel_for(particles.size(), row);
  particles.halo->for_rows(values, row);
}

/// Sum of term(i, row(i)), row(i) a number, over a rank's particles in their order; row as in for_rows().
template <class Values, class T, class Row, class Term>
T sum_over_rows(const FluidParticles& particles, Values& values, const T& zero, const Row& row,
                const Term& term) {
  const std::size_t n = particles.size();
  if (particles.halo == nullptr)
    return parallel_sum(n, zero, [&](std::size_t i) -> T { return term(i, row(i)); });
  const std::vector<float>& of_rows = particles.halo->of_rows(values, row);
  return parallel_sum(n, zero, [&](std::size_t i) -> T { return term(i, of_rows[i]); });
}

/// Of what each rank has found for its own particles.
template <class T>
T sum_of_ranks(const FluidParticles& particles, const T& own) {
  return particles.halo != nullptr ? particles.halo->ranks().sum(own) : own;
}
template <class T>
T max_of_ranks(const FluidParticles& particles, const T& own) {
  return particles.halo != nullptr ? particles.halo->ranks().max(own) : own;
}

/// The same of each value.
template <class T>
void sum_each_of_ranks(const FluidParticles& particles, std::vector<T>& values) {
  if (particles.halo == nullptr || values.empty()) return;
  values = particles.halo->ranks().sum_each(values);
}

inline bool is_first_rank(const FluidParticles& particles) {
  return particles.halo == nullptr || particles.halo->ranks().rank() == 0;
}

/// Particles of all ranks.
inline std::size_t total_size(const FluidParticles& particles) {
  return particles.halo != nullptr ? particles.halo->total() : particles.size();
}

}  // namespace kappaflow
