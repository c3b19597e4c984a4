#include "tools/commands/ranks_of_program.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "core/errors.h"
#include "tools/runs/program_file.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModule = "kappaflow-mpi.so";

int started_processes() {
  int processes = 1;
  for (const char* const name :
       {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const char* const size = std::getenv(name); size != nullptr)
      processes = std::max(processes, std::atoi(size));
  return processes;
}

/// Beside the program where it was built, and where it was installed.
fs::path module_file() {
  const fs::path folder = program_file().parent_path();
  const fs::path beside = folder / kModule, installed = folder / KAPPAFLOW_MODULE_FOLDER / kModule;
  std::error_code ignored;  // a file that cannot be examined is not there
  return fs::exists(beside, ignored) ? beside : installed;
}

}  // namespace

std::unique_ptr<Ranks> ranks_of_program() {
  const int processes = started_processes();
  if (processes == 1) return nullptr;  // else each would run the whole scene, all into the same folder
  // MPI's own modules look for its functions among all that are loaded.
  void* const module = dlopen(module_file().c_str(), RTLD_NOW | RTLD_GLOBAL);
  void* const make = module != nullptr ? dlsym(module, "kappaflow_mpi_ranks") : nullptr;
  if (make == nullptr)
    throw InvalidInput(
        fmt::format("this kappaflow cannot run in {} processes: {}; docs/scaling.md says what to install",
                    processes, dlerror()));
  return std::unique_ptr<Ranks>(reinterpret_cast<Ranks* (*)()>(make)());
}

}  // namespace kappaflow
