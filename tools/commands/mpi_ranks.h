// The processes that mpirun or srun has started together.
#pragma once

#include <memory>

#include "solver/ranks.h"

namespace kappaflow {

/// Of a program that was started by mpirun or srun in several processes (started_processes.h); else nullptr,
/// and MPI is not even begun. Ends MPI when it is destroyed. Throws InvalidInput where this program is built
/// without MPI.
std::unique_ptr<Ranks> ranks_of_program();

}  // namespace kappaflow
