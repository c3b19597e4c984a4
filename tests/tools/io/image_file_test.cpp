// Images: what VTK's own writers make, and what is wrong in a file.
#include "tools/io/image_file.h"

#include <fmt/format.h>
#include <vtkStructuredPointsWriter.h>
#include <vtkXMLImageDataWriter.h>

#include "core/errors.h"
#include "tests/tools/io/image_files.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class ImageFiles : public Scratch {
 protected:
  /// As XML in every way that VTK writes it, and in pieces.
  void write_xml(vtkImageData& image, int mode, int compressor, int pieces = 1) const {
    vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetFileName((folder / "a.vti").c_str());
    writer->SetInputData(&image);
    writer->SetDataMode(mode);
    writer->SetCompressorType(compressor);
    writer->SetNumberOfPieces(pieces);
    writer->Write();
  }
  ImageFrame read_text(const std::string& text) const { return read_image(file("a.vti", text)); }
  template <class ErrorType = InvalidInput>
  std::string error(const std::string& text) const {
    const std::string message = message_of<ErrorType>([&] { read_text(text); });
    const std::string begin = (folder / "a.vti").string() + ": ";
    EXPECT_TRUE(message.starts_with(begin)) << message;
    return message.substr(begin.size());
  }
};

void expect_lattice(const ImageFrame& frame) {
  EXPECT_EQ(frame.dims, (std::array{5, 6, 7}));
  EXPECT_EQ(frame.origin, Vec3(1, 2, 3));
  EXPECT_EQ(frame.spacing, Vec3(0.5, 0.25, 0.125));
  ASSERT_EQ(frame.value.size(), 210u);
  for (std::size_t i = 0; i < 210; ++i) ASSERT_EQ(frame.value[i], 0.25F * static_cast<float>(i) - 8) << i;
}

TEST_F(ImageFiles, XmlIsReadAsVtkWritesIt) {
  const auto image = small_image();
  add_array<vtkFloatArray>(*image->GetPointData(), "pressure", 210, 1);
  add_array<vtkDoubleArray>(*image->GetPointData(), "Phi", 210, 1);
  add_array<vtkFloatArray>(*image->GetPointData(), "Velocity", 210, 3);
  add_time(*image, 0.75);
  for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended})
    for (const int compressor : {vtkXMLWriter::NONE, vtkXMLWriter::ZLIB, vtkXMLWriter::LZ4})
      for (const int pieces : {1, 3}) {
        write_xml(*image, mode, compressor, pieces);
        const ImageFrame frame = read_image(folder / "a.vti");
        expect_lattice(frame);
        EXPECT_EQ(frame.name, "Phi");
        EXPECT_EQ(frame.velocity_name, "Velocity");
        ASSERT_EQ(frame.velocity.size(), 210u);
        EXPECT_EQ(frame.velocity[9], Eigen::Vector3f(-5.75F, -1005.75F, -2005.75F));
        EXPECT_EQ(frame.time, 0.75);
      }
}

TEST_F(ImageFiles, PiecesFillTheWhole) {
  const auto piece = [](int first, int last) {
    std::string values;
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = first; i <= last; ++i) values += fmt::format("{} ", i + 10 * j + 100 * k);
    return fmt::format(
        "<Piece Extent=\"{} {} 0 3 0 3\"><PointData><DataArray type=\"Float32\" Name=\"phi\" "
        "format=\"ascii\">{}</DataArray></PointData></Piece>",
        first, last, values);
  };
  const std::string head = "<VTKFile type=\"ImageData\"><ImageData " + kUnitLattice + ">",
                    tail = "</ImageData></VTKFile>";
  const ImageFrame frame = read_text(head + piece(0, 1) + piece(1, 3) + tail);
  ASSERT_EQ(frame.value.size(), 64u);
  for (std::size_t i = 0; i < 64; ++i)
    EXPECT_EQ(static_cast<std::size_t>(frame.value[i]), i % 4 + 10 * (i / 4 % 4) + 100 * (i / 16)) << i;
  EXPECT_EQ(error<IoError>(head + piece(0, 1) + piece(2, 3) + tail),
            "is damaged or not complete (has 18 cells in its pieces and 27 in all)");
}

// A plane of points at the image's end is counted as a layer of cells, which would be beyond it.
TEST_F(ImageFiles, PlanesWithCellsBeyondTheWholeAreSaid) {
  const auto piece = [](const char* extent, int cells) {
    std::string values;
    for (int i = 0; i < cells; ++i) values += "1 ";
    return fmt::format(
        "<Piece Extent=\"{}\"><CellData><DataArray type=\"Float32\" Name=\"phi\" "
        "format=\"ascii\">{}</DataArray></CellData></Piece>",
        extent, values);
  };
  const std::string head = "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 5 0 5 0 5\">",
                    tail = "</ImageData></VTKFile>";
  EXPECT_EQ(read_text(head + piece("0 5 0 5 0 5", 125) + tail).value.size(), 125u);
  for (const char* plane : {"0 5 0 5 5 5", "0 5 5 5 0 5", "5 5 0 5 0 5"})
    EXPECT_EQ(error<IoError>(head + piece("0 5 0 5 0 5", 125) + piece(plane, 25) + tail),
              "is damaged or not complete (a piece has cells beyond the whole extent)");
}

TEST_F(ImageFiles, LegacyFilesAreReadAsVtkWritesThem) {
  const auto image = small_image();
  add_array<vtkFloatArray>(*image->GetPointData(), "sdf", 210, 1);
  add_array<vtkFloatArray>(*image->GetPointData(), "vel", 210, 3);
  add_time(*image, 0.75);
  for (const int type : {VTK_ASCII, VTK_BINARY}) {
    vtkNew<vtkStructuredPointsWriter> writer;
    writer->SetFileName((folder / "a.vtk").c_str());
    writer->SetInputData(image);
    writer->SetFileType(type);
    writer->Write();
    const ImageFrame frame = read_image(folder / "a.vtk");
    expect_lattice(frame);
    EXPECT_EQ(frame.velocity[9], Eigen::Vector3f(-5.75F, -1005.75F, -2005.75F));
    EXPECT_EQ(frame.time, 0.75);
  }
}

TEST_F(ImageFiles, ValuesOfCellsAreAtTheirCentres) {
  const auto image = small_image();
  image->SetExtent(2, 6, 0, 5, -1, 5);  // 4 x 5 x 6 cells
  add_array<vtkFloatArray>(*image->GetCellData(), "levelset", 120, 1);
  add_array<vtkFloatArray>(*image->GetCellData(), "u", 120, 3);
  add_array<vtkFloatArray>(*image->GetPointData(), "velocity", 210, 3);  // of points: not beside it
  write_xml(*image, vtkXMLWriter::Appended, vtkXMLWriter::ZLIB, 2);
  const ImageFrame frame = read_image(folder / "a.vti");
  EXPECT_EQ(frame.dims, (std::array{4, 5, 6}));
  EXPECT_EQ(frame.origin, Vec3(2.25, 2.125, 2.9375));
  ASSERT_EQ(frame.value.size(), 120u);
  for (std::size_t i = 0; i < 120; ++i) ASSERT_EQ(frame.value[i], 0.25F * static_cast<float>(i) - 8) << i;
  EXPECT_EQ(frame.velocity_name, "u");
  EXPECT_EQ(frame.time, std::nullopt);
}

TEST_F(ImageFiles, TheOnlyArrayWillDoUnderAnyName) {
  const std::string vector = vti_array("velocity", 192, 3), mark = vti_array("vtkGhostType");
  const ImageFrame frame = read_text(vti_text(kUnitLattice, vti_points(vti_array("G") + vector + mark)));
  EXPECT_EQ(frame.name, "G");
  EXPECT_EQ(frame.velocity.size(), 64u);
  EXPECT_EQ(read_text(vti_text(kUnitLattice, vti_points(vti_array("p") + vti_array("LS")))).name, "LS");
}

TEST_F(ImageFiles, AnArrayThatIsNotClearIsSaid) {
  EXPECT_EQ(
      error(vti_text(kUnitLattice, vti_points(vti_array("p") + vti_array("T") + vti_array("v", 192, 3)))),
      "which of its arrays is the signed distance is not clear: p, T, v; expected one of the names phi, "
      "sdf, distance, signed_distance, levelset, level_set, surface, ls, or a single array of one "
      "component");
  EXPECT_NE(error(vti_text(kUnitLattice, "")).find("not clear: none;"), std::string::npos);
}

TEST_F(ImageFiles, ALatticeThatCannotBeUsedIsSaid) {
  const std::string phi = vti_points(vti_array("phi"));
  EXPECT_EQ(
      error(vti_text("WholeExtent=\"0 3 0 3 0 3\" Spacing=\"1 -1 1\"", phi)),
      "its origin is (0, 0, 0), its spacing (1, -1, 1); expected finite numbers, and a spacing above 0");
  EXPECT_EQ(error(vti_text(kUnitLattice + " Direction=\"0 1 0 1 0 0 0 0 1\"", phi)),
            "has a direction matrix; expected rows along x, y and z");
  EXPECT_EQ(read_text(vti_text(kUnitLattice + " Direction=\"1 0 0 0 1 0 0 0 1\"", phi)).value.size(), 64u);
  const auto flat = vtkSmartPointer<vtkImageData>::New();
  flat->SetDimensions(9, 9, 1);
  add_array<vtkFloatArray>(*flat->GetPointData(), "phi", 81, 1);
  write_xml(*flat, vtkXMLWriter::Ascii, vtkXMLWriter::NONE);
  EXPECT_EQ(message_of<InvalidInput>([&] { read_image(folder / "a.vti"); }),
            (folder / "a.vti").string() + ": has 9 x 9 x 1 values; expected at least 4 along each axis");
}

TEST_F(ImageFiles, NumbersThatAreNotFiniteAreSaid) {
  EXPECT_EQ(error(vti_text(kUnitLattice, vti_points(vti_array("phi", 64, 1, "nan", 27)))),
            "\"phi\" of point (3, 2, 1) is nan; it must be finite");
  EXPECT_EQ(error(vti_text(kUnitLattice, vti_points(vti_array("phi", 64, 1, "1e300", 0)))),
            "\"phi\" of point (0, 0, 0) is inf; it must be finite");
  EXPECT_EQ(error(vti_text(kUnitLattice, vti_points(vti_array("phi") + vti_array("vel", 192, 3, "-inf", 4)))),
            "\"vel\" of point (1, 0, 0) is (0.5, -inf, 0.5); it must be finite");
  EXPECT_EQ(error(vti_text(kUnitLattice, vti_points(vti_array("phi")), vti_time(std::nan("")))),
            "its time is nan s; it must be finite");
}

TEST_F(ImageFiles, DamagedFilesAreSaid) {
  const std::string phi = vti_points(vti_array("phi"));
  const auto damaged = [&](const std::string& text) { return error<IoError>(text); };
  EXPECT_EQ(damaged(vti_text(kUnitLattice, vti_points(vti_array("phi", 63)))),
            "is damaged or not complete (array \"phi\" has 63 numbers, and 64 points with 1 each need 64)");
  EXPECT_EQ(damaged(vti_text("WholeExtent=\"0 3 0 3 0 4\"", phi)),
            "is damaged or not complete (has 27 cells in its pieces and 36 in all)");
  EXPECT_EQ(damaged(vti_text("WholeExtent=\"0 3 0 3 0 2\"", phi)),
            "is damaged or not complete (has a piece outside of its whole extent)");
  EXPECT_EQ(damaged(vti_text("WholeExtent=\"0 3 0 3 1\"", phi)),
            "is damaged or not complete (WholeExtent is \"0 3 0 3 1\"; expected 6 numbers)");
  EXPECT_EQ(
      damaged(vti_text("WholeExtent=\"0 3 0 3 4 3\"", phi)),
      "is damaged or not complete (WholeExtent is \"0 3 0 3 4 3\"; expected the first and last of points "
      "along x, y, z)");
  EXPECT_EQ(damaged(vti_text("WholeExtent=\"0 99999 0 99999 0 99999\"", phi)),
            "is damaged or not complete (WholeExtent has 1e+15 points)");
  EXPECT_EQ(damaged("<VTKFile type=\"PolyData\"></VTKFile>"),
            "is damaged or not complete (holds \"PolyData\"; expected ImageData)");
  const std::string whole = vti_text(kUnitLattice, phi);
  EXPECT_NE(damaged(whole.substr(0, whole.size() / 2)).find("is damaged or not complete ("),
            std::string::npos);
  EXPECT_EQ(message_of<InvalidInput>([&] { read_image(folder / "a.png"); }),
            (folder / "a.png").string() + ": unknown kind of image; expected .vti, .pvti, .vtk or .vdb");
}

TEST_F(ImageFiles, WithoutOpenVdbItIsSaidHowToGetIt) {
  const std::string file = (folder / "a.vdb").string();
  const std::string message = message_of<IoError>([&] { read_image(file); });
  if (message == file + ": there is no such file")
    GTEST_SKIP() << "built with OpenVDB: see vdb_file_test.cpp";
  EXPECT_EQ(message,
            file +
                ": this program was built without OpenVDB; tools/setup --openvdb installs it (Debian: "
                "libopenvdb-dev), then run cmake --preset release and build again");
}

TEST_F(ImageFiles, DamagedLegacyFilesAreSaid) {
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\n";
  const auto damaged = [&](const std::string& text) {
    const std::string message = message_of<IoError>([&] { read_image(file("a.vtk", head + text)); });
    return message.substr((folder / "a.vtk").string().size() + 2);
  };
  const std::string begin = "is damaged or not complete (";
  EXPECT_EQ(damaged("DATASET POLYDATA\n"), begin + "holds polydata; expected STRUCTURED_POINTS)");
  EXPECT_EQ(damaged("DATASET STRUCTURED_POINTS\nDIMENSIONS 4 4 -4\n"),
            begin + "DIMENSIONS is \"-4\"; expected a whole number >= 0)");
  EXPECT_EQ(damaged("DATASET STRUCTURED_POINTS\nDIMENSIONS 4 4 0\n"), begin + "DIMENSIONS are 4 4 0)");
  EXPECT_EQ(damaged("DATASET STRUCTURED_POINTS\nDIMENSIONS 4 4 4\nPOINT_DATA 63\n"),
            begin + "POINT_DATA are of 63 points; there are 64)");
  EXPECT_EQ(damaged("DATASET STRUCTURED_POINTS\nDIMENSIONS 4 4 4\nORIGIN 0 0\n"),
            begin + "ends before ORIGIN)");
}

}  // namespace
}  // namespace kappaflow
