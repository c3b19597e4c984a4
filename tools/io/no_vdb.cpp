// In place of vdb_file.cpp where there is no OpenVDB.
#include "core/errors.h"
#include "tools/io/vdb_file.h"

namespace kappaflow {

ImageFrame read_vdb(const std::filesystem::path& file) {
  throw IoError(file.string(),
                "this program was built without OpenVDB; tools/setup --openvdb installs it (Debian: "
                "libopenvdb-dev), then run cmake --preset release and build again");
}

}  // namespace kappaflow
