#include "tools/commands/started_processes.h"

#include <algorithm>
#include <cstdlib>

namespace kappaflow {

int started_processes() {
  int processes = 1;
  for (const char* const name :
       {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const char* const size = std::getenv(name); size != nullptr)
      processes = std::max(processes, std::atoi(size));
  return processes;
}

}  // namespace kappaflow
