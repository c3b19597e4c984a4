// Solvers on ranks that are threads of one process.
#pragma once

#include <functional>
#include <thread>
#include <vector>

#include "solver/fluid_solver.h"
#include "tests/thread_ranks.h"

namespace kappaflow {

/// Makes a solver on each of `size` ranks, and calls `work` with the first one's; on one without any ranks.
/// Ends the program where one of them throws: the others would wait for it.
inline void on_ranks(int size, const std::function<FluidSolver(Ranks*)>& make,
                     const std::function<void(FluidSolver&)>& work) noexcept {
  if (size == 1) {
    FluidSolver fluid = make(nullptr);
    return work(fluid);
  }
  RankBoard board(size);
  std::vector<std::jthread> others;
  for (int rank = 1; rank < size; ++rank)
    others.emplace_back([&, rank] {
      ThreadRanks ranks(board, rank);
      if (ranks.next_order().task == RankTask::make) make(&ranks).follow();
    });
  ThreadRanks ranks(board, 0);
  FluidSolver fluid = make(&ranks);
  work(fluid);
  ranks.announce({RankTask::end});
}

}  // namespace kappaflow
