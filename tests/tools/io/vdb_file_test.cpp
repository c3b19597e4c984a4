// Level sets that OpenVDB writes. C++17, as vdb_file.h says.
#include "tools/io/vdb_file.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

using openvdb::FloatGrid;
constexpr float kRadius = 0.5F, kVoxel = 0.03125F;
const openvdb::Vec3f kCentre(0.25F, -1, 2);

class VdbFiles : public Scratch {
 protected:
  void SetUp() override {
    Scratch::SetUp();
    openvdb::initialize();
  }
  /// A sphere with the narrow band that OpenVDB gives it.
  static FloatGrid::Ptr sphere(const char* name) {
    FloatGrid::Ptr grid = openvdb::tools::createLevelSetSphere<FloatGrid>(kRadius, kCentre, kVoxel);
    grid->setName(name);
    return grid;
  }
  std::filesystem::path written(const openvdb::GridPtrVec& grids, double time = -1) const {
    openvdb::io::File file((folder / "a.vdb").string());
    openvdb::MetaMap metadata;
    if (time >= 0) metadata.insertMeta("Time", openvdb::DoubleMetadata(time));
    file.write(grids, metadata);
    return folder / "a.vdb";
  }
  std::string error(const openvdb::GridPtrVec& grids) const {
    const std::filesystem::path file = written(grids);
    return message_of<InvalidInput>([&] { read_vdb(file); }).substr(file.string().size() + 2);
  }
};

TEST_F(VdbFiles, DistancesReachTenVoxelsFromTheSurface) {
  const ImageFrame frame = read_image(written({sphere("surface")}, 1.5));
  EXPECT_EQ(frame.name, "surface");
  EXPECT_EQ(frame.time, 1.5);
  EXPECT_TRUE(frame.velocity.empty());
  const auto [nx, ny, nz] = frame.dims;
  ASSERT_EQ(frame.value.size(), static_cast<std::size_t>(nx) * ny * nz);
  double near = 0, far = 0;  // largest error in OpenVDB's band, and beyond it
  std::size_t i = 0;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x, ++i) {
        const Vec3 at = frame.origin + Vec3(x, y, z).cwiseProduct(frame.spacing);
        const double distance = (at - Vec3(kCentre[0], kCentre[1], kCentre[2])).norm() - kRadius;
        double& largest = std::abs(distance) < 2.5 * kVoxel ? near : far;
        if (std::abs(distance) < kVdbReach * kVoxel)
          largest = std::max(largest, std::abs(distance - frame.value[i]));
        EXPECT_EQ(frame.value[i] < 0, distance < 0);
        if (x == 0 || y == 0 || z == 0) {
          EXPECT_GE(distance, kVdbReach * kVoxel);
        }
      }
  EXPECT_LT(near, 1e-3 * kVoxel);
  EXPECT_LT(far, 0.5 * kVoxel);  // by first-order sweeping
}

TEST_F(VdbFiles, AGridIsFoundByItsNameOrItsClass) {
  const FloatGrid::Ptr density = FloatGrid::create();
  density->setName("density");
  EXPECT_EQ(read_vdb(written({density, sphere("liquid")})).name, "liquid");
  EXPECT_EQ(read_vdb(written({sphere("liquid"), sphere("SDF")})).name, "SDF");
  EXPECT_EQ(
      error({sphere("a"), sphere("b")}),
      "which of its grids is the signed distance is not clear: a, b; expected one of the names surface, "
      "phi, sdf, or a single grid of floats");
  EXPECT_EQ(error({}).find("which of its grids is the signed distance is not clear: none;"), 0u);
}

TEST_F(VdbFiles, GridsThatCannotBeUsedAreSaid) {
  const FloatGrid::Ptr turned = sphere("phi");
  turned->transform().postRotate(0.5);
  EXPECT_EQ(error({turned}),
            "the transform of its grid \"phi\" is none of a uniform scale and a translation");
  const FloatGrid::Ptr stretched = sphere("phi");
  stretched->transform().postScale(openvdb::Vec3d(1, 2, 1));
  EXPECT_EQ(error({stretched}),
            "the transform of its grid \"phi\" is none of a uniform scale and a translation");
  const FloatGrid::Ptr empty = FloatGrid::create(1);
  empty->setName("phi");
  empty->setGridClass(openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(error({empty}), "its grid \"phi\" has no surface");
}

TEST_F(VdbFiles, DamagedFilesAreSaid) {
  const auto path = file("b.vdb", "no grid");
  EXPECT_EQ(
      message_of<IoError>([&] { read_vdb(path); }).find(path.string() + ": is damaged or not complete ("),
      0u);
  const std::string whole = bytes_of(written({sphere("phi")}));
  const auto half = file("c.vdb", whole.substr(0, whole.size() / 2));
  EXPECT_EQ(
      message_of<IoError>([&] { read_vdb(half); }).find(half.string() + ": is damaged or not complete ("),
      0u);
  EXPECT_EQ(message_of<IoError>([&] { read_vdb(folder / "none.vdb"); }),
            (folder / "none.vdb").string() + ": there is no such file");
}

}  // namespace
}  // namespace kappaflow
