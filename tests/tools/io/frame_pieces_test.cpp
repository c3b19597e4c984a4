// Frames whose particles lie in several files.
#include <fmt/format.h>

#include <map>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tools/io/file_series.h"
#include "tools/io/input_frame.h"
#include "tools/io/input_kind.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

const fs::path kByVtk = KAPPAFLOW_SOURCE_DIR "/tests/data/pieces";

class FramePieces : public Scratch {
 protected:
  std::string path(const std::string& name) const { return (folder / name).string(); }
  fs::path list(const std::vector<std::string>& sources) const {
    std::string text = "<VTKFile type=\"PPolyData\"><PPolyData GhostLevel=\"0\">";
    for (const std::string& source : sources) text += fmt::format("<Piece Source=\"{}\"/>", source);
    return file("list.pvtp", text + "</PPolyData></VTKFile>");
  }
  std::string failure(const std::vector<std::string>& sources) const {
    return message_of<Error>([&] { read_input_frame(list(sources)); });
  }
  FileSeries series_of(const std::vector<std::string>& names) const {
    std::vector<std::string> files;
    for (const std::string& name : names) {
      fs::create_directories((folder / name).parent_path());
      files.push_back(file(name, ""));
    }
    return file_series(files);
  }
};

/// 6 x 5 x 4 particles, 0.1 m apart, that have moved by 0.05 m a frame: see write.py there.
void expect_block(const InputFrame& frame, int k) {
  ASSERT_EQ(frame.position.size(), 120u);
  std::map<std::int64_t, Vec3> by_id;
  for (std::size_t p = 0; p < frame.position.size(); ++p) {
    by_id[frame.id[p]] = frame.position[p];
    EXPECT_EQ(frame.velocity[p], Vec3(0.5, 0, 0));
  }
  ASSERT_EQ(by_id.size(), 120u) << "each particle once";
  for (const auto& [id, x] : by_id) {
    const std::int64_t p = (id - 5) / 3;
    const Vec3 place(static_cast<double>(p % 6), static_cast<double>(p / 6 % 5), static_cast<double>(p / 30));
    EXPECT_LT((x - 0.1 * place - Vec3(0.05 * k, 0, 0)).norm(), 1e-12);
  }
  EXPECT_DOUBLE_EQ(frame.time.value(), 0.1 * k);
}

TEST_F(FramePieces, OfVtksParallelWritersHoldEachParticleOnce) {
  for (const char* ending : {"pvtp", "pvtu"})
    for (int k = 0; k < 2; ++k) {
      const InputFrame frame = read_input_frame(kByVtk / fmt::format("frames_{}.{}", k, ending));
      expect_block(frame, k);
      EXPECT_EQ(frame.left_out, k == 0 ? 40u : 80u) << "a column of 20 ghosts on either side of a border";
    }
}

TEST_F(FramePieces, MayHaveNoPoints) {
  const auto of_vtk = [](const char* name) { return (kByVtk / name).string(); };
  for (const auto& sources : std::vector<std::vector<std::string>>{
           {of_vtk("empty.vtp"), of_vtk("frames_0_0.vtp"), of_vtk("frames_0_1.vtp")},
           {of_vtk("frames_0_0.vtp"), of_vtk("empty.vtp"), of_vtk("frames_0_1.vtp")}})
    expect_block(read_input_frame(list(sources)), 0);
  EXPECT_EQ(failure({of_vtk("empty.vtp"), of_vtk("empty.vtp")}), path("list.pvtp") + ": holds no particles");
}

TEST_F(FramePieces, MayBeNamedAsWindowsDoes) {
  fs::create_directory(folder / "parts");
  for (const char* name : {"frames_0_0.vtp", "frames_0_1.vtp"})
    fs::copy(kByVtk / name, folder / "parts" / name);
  expect_block(read_input_frame(list({"parts\\frames_0_0.vtp", "parts\\frames_0_1.vtp"})), 0);
}

TEST_F(FramePieces, ThatDoNotFitAreSaid) {
  const auto csv = [&](const char* name, bool ids, bool velocities) {
    file(name, csv_text(moved_block({}, 0), ids, velocities));
    return folder / name;
  };
  const fs::path all = csv("all.csv", true, true), no_ids = csv("no_ids.csv", false, true),
                 no_velocities = csv("no_velocities.csv", true, false);
  const auto pieces = [&](std::initializer_list<fs::path> files) {
    const std::vector<fs::path> list(files);
    return message_of<InvalidInput>([&] { read_input_frame(list); });
  };
  const std::string has = ", a piece of the same frame, has";
  EXPECT_EQ(pieces({all, all, no_velocities}),
            path("no_velocities.csv") + ": has no velocities; " + path("all.csv") + has);
  EXPECT_EQ(pieces({no_ids, all}), path("no_ids.csv") + ": has no ids; " + path("all.csv") + has);

  EXPECT_EQ(failure({"none.vtp"}), path("list.pvtp") + ": its piece " + path("none.vtp") + " is not there");
  EXPECT_EQ(failure({"/none/of/these.vtp"}),
            path("list.pvtp") + ": its piece /none/of/these.vtp is not there");
  EXPECT_EQ(failure({"list.pvtp"}), path("list.pvtp") + ": its piece list.pvtp is no .vtp");
  EXPECT_EQ(failure({""}), path("list.pvtp") + ": is damaged or not complete (has a piece without a Source)");
  EXPECT_EQ(failure({}), path("list.pvtp") + ": is damaged or not complete (has no pieces)");
  EXPECT_EQ(failure({(kByVtk / "frames_0_0.vtp").string(), (kByVtk / "frames_1_1.vtp").string()}),
            (kByVtk / "frames_1_1.vtp").string() + ": its time is 0.1 s; that of " +
                (kByVtk / "frames_0_0.vtp").string() + ", a piece of the same frame, is 0 s");
  fs::copy(kByVtk / "frames_0.pvtu", folder / "grid.pvtp");
  EXPECT_EQ(
      message_of<IoError>([&] { read_input_frame(folder / "grid.pvtp"); }),
      path("grid.pvtp") + ": is damaged or not complete (holds \"PUnstructuredGrid\"; expected PPolyData)");
}

TEST_F(FramePieces, ThatAreCutOffAreNamed) {
  const auto expect_named = [&](const std::vector<fs::path>& pieces, const std::string& text) {
    const fs::path last = folder / ("cut" + pieces.front().extension().string());
    std::vector<fs::path> files = pieces;
    files.push_back(last);
    for (const std::size_t length : {text.size() / 2, std::size_t{0}}) {
      file(last.filename().string(), text.substr(0, length));
      const std::string message = message_of<Error>([&] { read_input_frame(files); });
      EXPECT_TRUE(message.starts_with(last.string() + ":")) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  };
  for (const char* ending : {"vtp", "vtu"}) {
    const auto piece = [&](int k) { return kByVtk / fmt::format("frames_1_{}.{}", k, ending); };
    expect_named({piece(0), piece(1)}, bytes_of(piece(2)));
  }
  const Particles block = moved_block({}, 0);
  const auto written = [&](const char* name, std::string text) {
    text.pop_back();  // the end of the last line, which may be missing
    const fs::path path = file(name, text);
    expect_named({path, path}, text);
  };
  written("whole.vtk", splishsplash_text(block));
  written("whole.csv", csv_text(block, true, true));
  file("cut.vtp", bytes_of(kByVtk / "frames_1_2.vtp").substr(0, 1000));
  const std::string message = failure({(kByVtk / "frames_1_0.vtp").string(), "cut.vtp"});
  EXPECT_TRUE(message.starts_with(path("cut.vtp") + ": is damaged or not complete (")) << message;
}

// Whichever of the pieces it is: of a mesh not all need have polygons.
TEST_F(FramePieces, OfMeshesAreSaid) {
  const std::string head = "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=";
  file("mesh.vtp", head + "\"1\">");
  file("mesh.vtk",
       "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOLYGONS 1 4\n3 0 0 "
       "0\n");
  const std::string points = (kByVtk / "frames_0_0.vtp").string();
  const auto failure_of = [](const std::vector<fs::path>& files) {
    return message_of<InvalidInput>([&] { input_kind(files); });
  };
  const std::string message = ": is a piece of a frame; meshes are read from one file a frame";
  EXPECT_EQ(failure_of({list({"mesh.vtp"})}), path("mesh.vtp") + message);
  EXPECT_EQ(failure_of({list({points, points, "mesh.vtp"})}), path("mesh.vtp") + message);
  EXPECT_EQ(failure_of({points, folder / "mesh.vtp"}), path("mesh.vtp") + message);
  EXPECT_EQ(failure_of({points, folder / "mesh.vtk"}), path("mesh.vtk") + message);
  EXPECT_EQ(failure_of({"a_rank0.obj", "a_rank1.obj"}), "a_rank0.obj" + message);
  EXPECT_EQ(input_kind(std::vector{list({points, points})}), InputKind::particles);
  EXPECT_EQ(input_kind(std::vector<fs::path>{folder / "mesh.vtp"}), InputKind::meshes);
}

TEST_F(FramePieces, AreToldApartByTheirRank) {
  const auto expect_pieces = [&](const std::string& first, const std::string& second,
                                 const std::vector<std::string>& next_frame) {
    std::vector<std::string> names{second, first};
    names.insert(names.begin() + 1, next_frame.begin(), next_frame.end());
    const FileSeries series = series_of(names);
    ASSERT_EQ(series.files.size(), 2u) << first;
    ASSERT_EQ(series.pieces.size(), 2u) << first;
    EXPECT_EQ(series.files[0], folder / first);
    EXPECT_EQ(series.pieces[0], (std::vector<fs::path>{folder / first, folder / second}));
    EXPECT_EQ(series.files_of(1).size(), 2u);
  };
  expect_pieces("a_0009_rank0.vtk", "a_0009_rank1.vtk", {"a_0010_rank0.vtk", "a_0010_rank1.vtk"});
  expect_pieces("b_100_rank2.hdf5", "b_100_rank10.hdf5", {"b_200_rank2.hdf5", "b_200_rank10.hdf5"});
  expect_pieces("rank0/f_1.vtp", "rank1/f_1.vtp", {"rank0/f_2.vtp", "rank1/f_2.vtp"});
  expect_pieces("processor0/0.5.csv", "processor1/0.5.csv", {"processor0/1.0.csv", "processor1/1.0.csv"});
  expect_pieces("c-mpi_0-t5.vtu", "c-mpi_1-t5.vtu", {"c-mpi_0-t6.vtu", "c-mpi_1-t6.vtu"});
  EXPECT_EQ(series_of({"d_1.csv", "d_2.csv"}).pieces.size(), 0u);
  EXPECT_EQ(series_of({"d_rank3_1.csv", "d_rank3_2.csv"}).pieces.size(), 0u) << "one rank";
  EXPECT_EQ(series_of({"domain_0.csv", "domain_1.csv"}).files.size(), 2u) << "the number of a frame";
}

TEST_F(FramePieces, WithNamesThatSayNoRankAreSaid) {
  const auto failure_of = [&](const std::vector<std::string>& names) {
    return message_of<InvalidInput>([&] { series_of(names); });
  };
  EXPECT_EQ(failure_of({"a_1_1.vtk", "a_1_2.vtk", "a_2_1.vtk"}),
            path("a_1_1.vtk") + " and " + path("a_2_1.vtk") +
                " belong to different series; name the files of one, whose names differ in one number, or "
                "beside it in that of a rank (rank0, proc0, piece0, ...)");
  EXPECT_EQ(failure_of({"a_1_rank0.vtk", "a_1_rank1.vtk", "a_2_rank0.vtk"}),
            "the frame of " + path("a_2_rank0.vtk") + " has no piece of rank 1, and that of " +
                path("a_1_rank0.vtk") + " has one");
  EXPECT_EQ(failure_of({"a_1_rank1.vtk", "a_2_rank0.vtk", "a_2_rank1.vtk"}),
            "the frame of " + path("a_2_rank0.vtk") + " has a piece of rank 0, and that of " +
                path("a_1_rank1.vtk") + " has none");
  EXPECT_NE(failure_of({"a_1_rank0.vtk", "a_01_rank0.vtk", "a_2_rank0.vtk"}).find(" have the same number"),
            std::string::npos);
}

TEST_F(FramePieces, OfAPvdAreThePartsOfTheSameName) {
  const auto part = [](double time, int number, const char* name, const char* file) {
    return fmt::format("<DataSet timestep=\"{}\" part=\"{}\" name=\"{}\" file=\"{}\"/>", time, number, name,
                       file);
  };
  const auto pvd = [&](const std::string& entries) {
    file("all.pvd", "<VTKFile type=\"Collection\"><Collection>" + entries + "</Collection></VTKFile>");
  };
  const std::string walls = part(0, 2, "", "walls_0.vtp") + part(0, 3, "planes", "a_0_3.vtp");
  const std::string a = part(0, 0, "", "a_0_0.vtp"), b = part(0, 1, "", "a_0_1.vtp"),
                    c = part(1, 0, "", "a_1_0.vtp"), d = part(1, 1, "", "a_1_1.vtp");
  for (const std::string& order : {a + b + walls + c + d, a + c + b + d + walls, d + b + walls + a + c}) {
    pvd(order);
    const FileSeries series = file_series(std::vector{path("all.pvd")}, {.backward = true});
    ASSERT_EQ(series.pieces.size(), 2u);
    EXPECT_EQ(series.files[1], folder / "a_0_0.vtp");
    EXPECT_EQ(series.pieces[1], (std::vector<fs::path>{folder / "a_0_0.vtp", folder / "a_0_1.vtp"}));
    EXPECT_EQ(series.pieces[0], (std::vector<fs::path>{folder / "a_1_0.vtp", folder / "a_1_1.vtp"}));
  }
  pvd(a + b + walls + c);
  EXPECT_EQ(message_of<InvalidInput>([&] { file_series(std::vector{path("all.pvd")}, {}); }),
            path("all.pvd") + ": lists 2 files at 0 s, a_0_0.vtp, but 1 at 1 s");
}

TEST_F(FramePieces, OfAFolderAreThoseThatAreListed) {
  for (const char* name : {"f_0.pvtp", "f_1.pvtp", "f_0_0.vtp", "f_0_1.vtp", "f_1_0.vtp", "walls.stl"})
    file(name, "");
  const FileSeries series = file_series(std::vector{folder.string()});
  EXPECT_EQ(series.files, (std::vector<fs::path>{folder / "f_0.pvtp", folder / "f_1.pvtp"}));
}

TEST_F(FramePieces, OfImagesInAFolderAreThoseThatAreListed) {
  for (const char* name : {"f_0.pvti", "f_1.pvti", "f_0_0.vti", "f_0_1.vti", "f_1_0.vti", "walls.stl"})
    file(name, "");
  const FileSeries series = file_series(std::vector{folder.string()});
  EXPECT_EQ(series.files, (std::vector<fs::path>{folder / "f_0.pvti", folder / "f_1.pvti"}));
}

}  // namespace
}  // namespace kappaflow
