#include "tests/tools/vdb_writer.h"

namespace kappaflow {

bool write_vdb(const std::filesystem::path& /*file*/, const ImageFrame& /*frame*/) {
  return false;
}

}  // namespace kappaflow
