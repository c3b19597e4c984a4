#include <fmt/format.h>

#include "core/errors.h"
#include "tools/commands/mpi_ranks.h"
#include "tools/commands/started_processes.h"

namespace kappaflow {

// Each process would else run the whole scene, all into the same folder.
std::unique_ptr<Ranks> ranks_of_program() {
  if (const int processes = started_processes(); processes > 1)
    throw InvalidInput(fmt::format(
        "this kappaflow is built without MPI and cannot run in {} processes; docs/scaling.md says "
        "what to install",
        processes));
  return nullptr;
}

}  // namespace kappaflow
