// How many processes were started together with this one.
#pragma once

namespace kappaflow {

/// As mpirun (Open MPI, MPICH, MVAPICH) and srun tell each of them; 1: it was started alone.
int started_processes();

}  // namespace kappaflow
