#include "tests/tools/vdb_writer.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

namespace kappaflow {

bool write_vdb(const std::filesystem::path& file, const ImageFrame& frame) {
  openvdb::initialize();
  const double voxel = frame.spacing[0];
  const auto band = static_cast<float>(3 * voxel);
  const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(band);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  grid->transform().postTranslate(openvdb::Vec3d(frame.origin[0], frame.origin[1], frame.origin[2]));
  auto accessor = grid->getAccessor();
  std::size_t p = 0;
  for (int k = 0; k < frame.dims[2]; ++k)
    for (int j = 0; j < frame.dims[1]; ++j)
      for (int i = 0; i < frame.dims[0]; ++i, ++p)
        if (std::abs(frame.value[p]) < band) accessor.setValue({i, j, k}, frame.value[p]);
  openvdb::tools::signedFloodFill(grid->tree());
  openvdb::MetaMap metadata;
  metadata.insertMeta("time", openvdb::DoubleMetadata(*frame.time));
  openvdb::io::File(file.string()).write({grid}, metadata);
  return true;
}

}  // namespace kappaflow
