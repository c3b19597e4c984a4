// What a file holds, by its name and by what is in it.
#include "tools/io/input_kind.h"

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;
using enum InputKind;

const std::string kLegacy = "# vtk DataFile Version 3.0\nPOLYGONS of a title\nASCII\nDATASET ";
const std::string kPoints = "POLYDATA\nPOINTS 1 float\n0 0 0\n";

class InputKinds : public Scratch {
 protected:
  InputKind kind(const std::string& name, const std::string& bytes) const {
    return input_kind(file(name, bytes));
  }
};

TEST_F(InputKinds, MostAreKnownByTheirEndings) {
  for (const char* name : {"a.vtu", "a.bgeo", "a.hdf5", "a.csv"}) EXPECT_EQ(input_kind(name), particles);
  for (const char* name : {"a.vti", "a.pvti", "a.VDB"}) EXPECT_EQ(input_kind(name), images);
  for (const char* name : {"a.obj", "a.ply", "a.STL"}) EXPECT_EQ(input_kind(name), meshes);
  for (const char* name : {"a.vti", "a.stl", "a.csv", "a.vtk", "a.vtp"}) EXPECT_TRUE(is_input_file(name));
  for (const char* name : {"a", "a.png", "a.vtr"}) {
    EXPECT_FALSE(is_input_file(name));
    EXPECT_EQ(message_of<InvalidInput>([&] { input_kind(name); }),
              std::string(name) +
                  ": unknown kind of file; expected .vtk, .vtp, .vtu, .pvtp, .pvtu, .bgeo, .hdf5 or .csv "
                  "with particles, "
                  ".vti, .pvti, .vtk or .vdb with distances, .obj, .ply, .stl, .vtp or .vtk with meshes");
  }
}

TEST_F(InputKinds, FilesOfVtkAreKnownByWhatTheyHold) {
  EXPECT_EQ(kind("a.vtk", kLegacy + "STRUCTURED_POINTS\nDIMENSIONS 4 4 4\n"), images);
  EXPECT_EQ(kind("a.vtk", kLegacy + "UNSTRUCTURED_GRID\n"), particles);
  EXPECT_EQ(kind("a.vtk", kLegacy + kPoints + "VERTICES 1 2\n1 0\n"), particles);
  EXPECT_EQ(kind("a.vtk", kLegacy + kPoints + "\nPOLYGONS 1 4\n3 0 0 0\n"), meshes);
  EXPECT_EQ(kind("a.vtk", kLegacy + kPoints + "\nPOLYGONS 0 0\n"), particles);
  EXPECT_EQ(kind("a.vtk", kLegacy + kPoints + "\nTRIANGLE_STRIPS 1 4\n3 0 0 0\n"), meshes);
  const std::string head = "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" ";
  EXPECT_EQ(kind("a.vtp", head + "NumberOfPolys=\"0\" NumberOfStrips=\"0\">"), particles);
  EXPECT_EQ(kind("a.vtp", head + "NumberOfStrips=\"0\" NumberOfPolys=\"12\">"), meshes);
  EXPECT_EQ(kind("a.vtp", head + "NumberOfStrips=\"1\" NumberOfPolys=\"0\">"), meshes);
  EXPECT_EQ(message_of<IoError>([&] { input_kind(folder / "none.vtk"); }).substr(0, folder.string().size()),
            folder.string());
}

}  // namespace
}  // namespace kappaflow
