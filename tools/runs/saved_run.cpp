#include "tools/runs/saved_run.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "tools/io/checkpoint.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

std::filesystem::path checkpoint_in(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / kCheckpointFile))
    throw IoError(folder.string(),
                  "holds no checkpoint to go on from; a run that ended before its first frame is begun anew");
  return folder / kCheckpointFile;
}

}  // namespace

SavedRun::SavedRun(const std::filesystem::path& folder, const std::string& command)
    : file_(checkpoint_in(folder)), bytes_(read_checkpoint(file_)), archive_(bytes_) {
  std::string writer;
  read(writer);
  if (writer != command)
    throw InvalidInput({folder.string()}, fmt::format("kappaflow {} --resume goes on with it", writer));
}

void SavedRun::require_end() {
  if (bytes_.peek() != std::istringstream::traits_type::eof()) bytes_.setstate(std::ios::failbit);
  check();
}

void SavedRun::check() const {
  if (bytes_.fail()) throw IoError(file_.string(), "does not hold what this version of kappaflow saves");
}

}  // namespace kappaflow
