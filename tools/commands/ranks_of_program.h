// The processes that mpirun or srun has started together.
#pragma once

#include <memory>

#include "solver/ranks.h"

namespace kappaflow {

/// Of a program that was started by mpirun (Open MPI, MPICH, MVAPICH) or srun in several processes; else
/// nullptr. What knows of MPI is a module of its own, which is loaded only then: MPI's libraries take memory
/// and time, and may talk, wherever they are loaded. Ends MPI when it is destroyed. Throws InvalidInput where
/// the module is missing or cannot be loaded, IoError as program_file() does.
std::unique_ptr<Ranks> ranks_of_program();

}  // namespace kappaflow
