// Series of images and of meshes: what is told of them, and what must be the same in all.
#include "tools/io/frame_sequence.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "tests/tools/io/image_files.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class FrameSequences : public Scratch {
 protected:
  FileSeries series(const std::string& pattern) const {
    return file_series(std::vector<std::string>{(folder / pattern).string()});
  }
  void image(int k, const std::string& arrays, const std::string& lattice = kUnitLattice,
             const std::string& field_data = "") const {
    file(fmt::format("phi_{}.vti", k), vti_text(lattice, vti_points(arrays), field_data));
  }
  std::string image_error(std::optional<double> fps = 10) const {
    return message_of<InvalidInput>([&] { ImageSequence(series("phi_*.vti"), fps); });
  }
  std::string path(const char* name) const { return (folder / name).string(); }
};

TEST_F(FrameSequences, ImagesAreToldOf) {
  for (const int k : {2, 4, 6})
    image(k, vti_array("phi") + vti_array("velocity", 192, 3), kUnitLattice, vti_time(0.5 * k));
  std::size_t watched = 0;
  const ImageSequence sequence(series("phi_*.vti"), {}, [&](std::size_t file) { watched += file; });
  EXPECT_EQ(watched, 3u);
  EXPECT_EQ(sequence.name(), "phi");
  EXPECT_EQ(sequence.size(), 3u);
  EXPECT_EQ(sequence.file(2), folder / "phi_6.vti");
  EXPECT_EQ(sequence.time(1), 2);
  EXPECT_EQ(sequence.frame(1).value.size(), 64u);
  EXPECT_EQ(sequence.notes(),
            (std::vector<std::string>{"4 x 4 x 4 points, 1 m apart", "signed distances \"phi\"",
                                      "velocities from \"velocity\"", "times 1 to 3 s, from the files"}));
}

TEST_F(FrameSequences, TheHashIsOfAllThatIsRead) {
  const auto hash = [&] { return ImageSequence(series("phi_*.vti"), 10).hash(); };
  image(0, vti_array("phi"));
  image(1, vti_array("phi"));
  const std::string first = hash();
  EXPECT_EQ(hash(), first);
  image(1, vti_array("phi", 64, 1, "0.25", 63));
  EXPECT_NE(hash(), first);
}

TEST_F(FrameSequences, TimesMayComeFromFramesASecond) {
  for (int k = 0; k < 3; ++k) image(k, vti_array("phi"));
  const ImageSequence sequence(series("phi_*.vti"), 4);
  EXPECT_EQ(sequence.time(2), 0.5);
  EXPECT_EQ(sequence.notes()[2], "no velocities");
  EXPECT_EQ(sequence.notes()[3], "times 0 to 0.5 s, 4 frames a second");
  EXPECT_EQ(image_error({}), "phi: the files hold no times; say how many frames a second they are by --fps");
}

TEST_F(FrameSequences, OtherPointsThanTheFirstAreRefused) {
  image(0, vti_array("phi"));
  image(1, vti_array("phi"), "WholeExtent=\"0 3 0 3 0 3\" Origin=\"0 0 1\" Spacing=\"1 1 1\"");
  EXPECT_EQ(image_error(), path("phi_1.vti") + ": has 4 x 4 x 4 points from (0, 0, 1) on, (1, 1, 1) apart; " +
                               path("phi_0.vti") +
                               " has 4 x 4 x 4 points from (0, 0, 0) on, (1, 1, 1) apart: the points must "
                               "stay the same");
}

TEST_F(FrameSequences, VelocitiesAreInAllOrNone) {
  image(0, vti_array("phi"));
  image(1, vti_array("phi") + vti_array("u", 192, 3));
  EXPECT_EQ(image_error(),
            path("phi_0.vti") + ": has no velocities; " + path("phi_1.vti") + " has them (\"u\")");
  image(2, vti_array("phi"));
  image(0, vti_array("phi") + vti_array("u", 192, 3));
  EXPECT_EQ(image_error(),
            path("phi_2.vti") + ": has no velocities; " + path("phi_0.vti") + " has them (\"u\")");
}

TEST_F(FrameSequences, TimesAscend) {
  image(0, vti_array("phi"), kUnitLattice, vti_time(1));
  image(1, vti_array("phi"), kUnitLattice, vti_time(1));
  EXPECT_EQ(image_error(), path("phi_1.vti") + ": its time, 1 s, is not after that of the file before, 1 s");
  image(1, vti_array("phi"));
  EXPECT_EQ(image_error(), path("phi_1.vti") + ": lacks a time; " + path("phi_0.vti") + " does");
}

TEST_F(FrameSequences, BackwardTimeRunsFromTheLastFile) {
  const std::array<double, 3> times{1, 1.5, 3};
  for (int k = 0; k < 3; ++k)
    image(k, vti_array("phi") + vti_array("velocity", 192, 3, "-7", 0), kUnitLattice, vti_time(times[k]));
  const auto backward = [&] { return file_series(std::vector{path("phi_*.vti")}, {0, 9, 1, true}); };
  const ImageSequence sequence(backward(), {});
  EXPECT_EQ(sequence.file(0), folder / "phi_2.vti");
  EXPECT_EQ(sequence.time(0), 0);
  EXPECT_EQ(sequence.time(1), 1.5);
  EXPECT_EQ(sequence.time(2), 2);
  EXPECT_EQ(sequence.frame(0).velocity[0], Eigen::Vector3f(7, -0.5, -0.5));
  EXPECT_EQ(sequence.frame(0).value[0], 0.5);
  EXPECT_EQ(sequence.notes()[3], "times 0 to 2 s, from the files");
  EXPECT_EQ(sequence.notes()[4], "backward from " + path("phi_2.vti") + ", which is at 3 s");
  for (int k = 0; k < 3; ++k) image(k, vti_array("phi"));
  const ImageSequence without_times(backward(), 4);
  EXPECT_EQ(without_times.time(2), 0.5);
  EXPECT_EQ(without_times.notes().back(), "backward from " + path("phi_2.vti"));
}

TEST_F(FrameSequences, MeshesMayDiffer) {
  const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  file("m_0.obj", tetrahedron);
  file("m_1.obj", "v 0.25 0.25 -1\n" + tetrahedron.substr(0, 32) +
                      "f 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 5\nf 3 4 5\nf 4 2 5\n");
  const MeshSequence sequence(series("m_*.obj"), 10);
  EXPECT_EQ(sequence.frame(0).surface.triangles.size(), 4u);
  EXPECT_EQ(sequence.frame(1).surface.triangles.size(), 6u);
  EXPECT_EQ(sequence.notes(),
            (std::vector<std::string>{"4 to 6 triangles", "times 0 to 0.1 s, 10 frames a second"}));
  file("m_3.obj", tetrahedron);
  EXPECT_EQ(message_of<InvalidInput>([&] { MeshSequence(series("m_*.obj"), 10); }),
            "a file is missing: " + path("m_3.obj") + " comes after " + path("m_1.obj") +
                ", and elsewhere the number goes up by 1; files without times must be equally far apart");
}

}  // namespace
}  // namespace kappaflow
