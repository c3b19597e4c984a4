#include <cstdlib>
#include <string>

#include "core/errors.h"
#include "tools/commands/mpi_ranks.h"

namespace kappaflow {

// Each process would else run the whole scene, all into the same folder.
std::unique_ptr<Ranks> ranks_of_program() {
  for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* const size = std::getenv(name); size != nullptr && std::atoi(size) > 1)
      throw InvalidInput("this kappaflow is built without MPI and cannot run in " + std::string(size) +
                         " processes; docs/scaling.md says what to install");
  return nullptr;
}

}  // namespace kappaflow
