// Which files belong together, by their names.
#include "tools/io/file_series.h"

#include <fmt/format.h>

#include <cstdlib>

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

class FileSeriesNames : public Scratch {
 protected:
  FileSeries series(const std::string& pattern) const {
    return file_series(std::vector<std::string>{(folder / pattern).string()});
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
};

TEST_F(FileSeriesNames, FilesSortByTheirNumber) {
  for (const char* name : {"p_10.csv", "p_9.csv", "p_11.csv", "p_8.csv"}) file(name, "");
  const FileSeries found = series("p_*.csv");
  std::vector<std::string> names;
  for (const fs::path& f : found.files) names.push_back(f.filename());
  EXPECT_EQ(names, (std::vector<std::string>{"p_8.csv", "p_9.csv", "p_10.csv", "p_11.csv"}));
  EXPECT_EQ(found.name, "p");
  EXPECT_EQ(found.gap, "");
  EXPECT_EQ(file_series(std::vector{path("p_9.csv"), path("p_8.csv")}).files.front(), path("p_8.csv"));
}

TEST_F(FileSeriesNames, FilesThatAreNoSeriesAreSaid) {
  for (const char* name : {"a_1.csv", "a_2.csv", "a_4.csv", "b_1.csv", "a_01.csv", "lone_1.csv"})
    file(name, "");
  EXPECT_EQ(series("a_[124].csv").gap, "a file is missing: " + path("a_4.csv") + " comes after " +
                                           path("a_2.csv") + ", and elsewhere the number goes up by 1");
  EXPECT_NE(message_of<InvalidInput>([&] { series("?_1.csv"); }).find(" belong to different series; "),
            std::string::npos);
  EXPECT_NE(message_of<InvalidInput>([&] { series("a_*1.csv"); }).find(" have the same number"),
            std::string::npos);
  EXPECT_EQ(message_of<InvalidInput>([&] { series("lone_*.csv"); }),
            path("lone_1.csv") + " is one file; a sequence takes two or more");
  EXPECT_EQ(message_of<IoError>([&] { series("none_*.csv"); }),
            path("none_*.csv") + ": there is no such file");
}

TEST_F(FileSeriesNames, AFolderStandsForTheFramesInIt) {
  for (const char* name : {"p_2.vtk", "p_10.vtk", "notes.txt", "p_2.png", "tank.stl"}) file(name, "");
  const FileSeries found = series("");
  ASSERT_EQ(found.files.size(), 2u);
  EXPECT_EQ(found.files.back().filename(), "p_10.vtk");
  file("q_1.vtk", "");
  EXPECT_NE(message_of<InvalidInput>([&] { series(""); }).find(" belong to different series; "),
            std::string::npos);
  std::filesystem::create_directory(folder / "empty");
  EXPECT_EQ(
      message_of<InvalidInput>([&] { series("empty"); }),
      path("empty") +
          ": there are no frames in this folder (expected .vtk, .vtp, .vtu, .pvtp, .pvtu, .bgeo, .hdf5 "
          "or .csv with "
          "particles, .vti, .pvti, .vtk or .vdb with distances, .obj, .ply, .stl, .vtp or .vtk with meshes)");
}

TEST_F(FileSeriesNames, ARangeTakesFilesByTheirNumbers) {
  for (int k = 95; k < 130; k += 5) file(fmt::format("p_{}.csv", k), "");
  const auto names = [](const FileSeries& series) {
    std::string text;
    for (const fs::path& f : series.files) text += f.stem().string() + " ";
    return text;
  };
  const std::vector<std::string> all{path("p_*.csv")};
  EXPECT_EQ(names(file_series(all, {100, 112})), "p_100 p_105 p_110 ");
  const FileSeries third = file_series(all, {95, 1000, 3});
  EXPECT_EQ(names(third), "p_95 p_110 p_125 ");
  EXPECT_EQ(third.stride, 3);
  EXPECT_EQ(third.step, 5) << "from file to file of the whole series";
  EXPECT_EQ(third.gap, "");
  EXPECT_EQ(message_of<InvalidInput>([&] {
              file_series(all, {121, 122});
            }),
            "--frames 121:122 leaves none of the files numbered 95 to 125; a sequence takes two or more");
  EXPECT_EQ(message_of<InvalidInput>([&] {
              file_series(all, {100, 119, 9});
            }),
            "--frames 100:119:9 leaves one of the files numbered 95 to 125; a sequence takes two or more");
}

TEST_F(FileSeriesNames, ARangeIsTakenBeforeItIsTurnedBackward) {
  std::string entries;
  for (int k = 0; k < 8; ++k) {
    file(fmt::format("p_{}.csv", k), "");
    entries += fmt::format("<DataSet timestep=\"{}\" file=\"p_{}.csv\"/>", 0.5 * k, k);
  }
  file("all.pvd", "<VTKFile type=\"Collection\"><Collection>" + entries + "</Collection></VTKFile>");
  const FileRange range{1, 6, 2, true};
  for (const char* pattern : {"p_*.csv", "all.pvd"}) {
    const FileSeries found = file_series(std::vector{path(pattern)}, range);
    EXPECT_TRUE(found.backward);
    EXPECT_EQ(found.files, (std::vector<fs::path>{path("p_5.csv"), path("p_3.csv"), path("p_1.csv")}));
    EXPECT_EQ(found.stride, 2);
    EXPECT_EQ(found.step, 1);
    EXPECT_EQ(found.gap, "");
  }
  EXPECT_EQ(file_series(std::vector{path("all.pvd")}, range).times, (std::vector<double>{2.5, 1.5, 0.5}));
}

TEST_F(FileSeriesNames, APvdListsFilesAndTimes) {
  const auto pvd = [&](const std::string& entries) {
    return file("all.pvd", "<VTKFile type=\"Collection\"><Collection>" + entries + "</Collection></VTKFile>");
  };
  pvd("<DataSet timestep=\"0.5\" part=\"0\" file=\"sub/first.vtp\"/><DataSet timestep=\"0.5\" part=\"1\" "
      "file=\"walls.vtp\"/><DataSet timestep=\"0.75\" file=\"then.vtp\"/><DataSet timestep=\"2\" "
      "file=\"last.vtp\"/>");
  const FileSeries found = series("all.pvd");
  EXPECT_EQ(found.times, (std::vector<double>{0.5, 0.75, 2}));
  EXPECT_EQ(found.name, "all");
  EXPECT_EQ(found.files.front(), folder / "sub/first.vtp");
  const FileSeries part = file_series(std::vector{path("all.pvd")}, {1, 9});
  EXPECT_EQ(part.times, (std::vector<double>{0.75, 2})) << "numbers count from 0";

  pvd("<DataSet timestep=\"0\" file=\"a.vtp\"/>");
  EXPECT_EQ(message_of<InvalidInput>([&] { series("all.pvd"); }),
            path("all.pvd") + " lists one file; a sequence takes two or more");
  pvd("<DataSet timestep=\"soon\" file=\"a.vtp\"/>");
  EXPECT_EQ(message_of<InvalidInput>([&] { series("all.pvd"); }),
            path("all.pvd") + ": the time of a.vtp: found \"soon\" where a number is needed");
  file("all.pvd", "<VTKFile type=\"PolyData\"/>");
  EXPECT_EQ(message_of<IoError>([&] { series("all.pvd"); }),
            path("all.pvd") + ": is not a ParaView collection (.pvd)");
  file("all.pvd", "<VTKFile\n<");
  EXPECT_TRUE(message_of<IoError>([&] { series("all.pvd"); }).starts_with(path("all.pvd") + ": line 2: "));
}

TEST_F(FileSeriesNames, AGapIsWhereTheStepIsNotTheMostFrequent) {
  const auto gap = [&](std::initializer_list<const char*> numbers) {
    std::vector<std::string> names;
    for (const char* number : numbers) names.push_back(file(fmt::format("p_{}.csv", number), ""));
    return file_series(names).gap;
  };
  const auto says = [&](const char* how, const char* after, const char* before, const char* step) {
    return fmt::format("{}: {} comes after {}, and elsewhere the number goes up by {}", how,
                       path(fmt::format("p_{}.csv", after)), path(fmt::format("p_{}.csv", before)), step);
  };
  const char *const missing = "a file is missing", *const uneven = "the frames are not equally far apart";
  EXPECT_EQ(gap({"0", "100", "200"}), "");
  EXPECT_EQ(gap({"0", "100", "187"}), says(uneven, "187", "100", "100")) << "PySPH's last step";
  EXPECT_EQ(gap({"0", "100", "200", "300", "350"}), says(uneven, "350", "300", "100"));
  EXPECT_EQ(gap({"1", "3", "4"}), says(missing, "3", "1", "1"));
  EXPECT_EQ(gap({"1", "2", "4"}), says(missing, "4", "2", "1"));
  EXPECT_EQ(gap({"0", "2", "3", "5", "7"}), says(uneven, "3", "2", "2"));
  EXPECT_EQ(gap({"0.00", "0.25", "0.5", "1.0"}), says(missing, "1.0", "0.5", "0.25"));
}

TEST_F(FileSeriesNames, DecimalNumbersInNamesSortByValue) {
  const auto order = [&](std::initializer_list<const char*> numbers) {
    std::vector<std::string> files, found;
    for (const char* number : numbers) files.push_back(file(fmt::format("run2_{}.csv", number), ""));
    for (const fs::path& f : file_series(files).files)
      found.push_back(f.stem().string().substr(std::string("run2_").size()));
    return found;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(order({"0.00", "0.5", "0.10"}), (Names{"0.00", "0.10", "0.5"}));
  EXPECT_EQ(order({"1.5", "0.5", "1.0", "10.0"}), (Names{"0.5", "1.0", "1.5", "10.0"}));
  EXPECT_EQ(order({"1.10", "1.9", "1.8"}), (Names{"1.8", "1.9", "1.10"})) << "counted after a point";
  EXPECT_EQ(order({"1.010", "1.009"}), (Names{"1.009", "1.010"}));
  EXPECT_EQ(order({"3.0", "1.0", "2.0"}), (Names{"1.0", "2.0", "3.0"}));
}

TEST_F(FileSeriesNames, FoldersMayHaveAnyCharactersAndATildeIsHome) {
  for (const char* name : {"br[1]", "a*b", "w?", "~", "back\\slash"}) {
    fs::create_directory(folder / name);
    for (const int k : {0, 1, 2}) file(fmt::format("{}/p_{}.csv", name, k), "");
    EXPECT_EQ(series(fmt::format("{}/p_[0-9].csv", name)).files.size(), 3u) << name;
    EXPECT_EQ(series(fmt::format("{}/p_[12].csv", name)).files[0], path(fmt::format("{}/p_1.csv", name)));
  }
  EXPECT_EQ(series("?r*/p_*.csv").files.size(), 3u) << "wildcards of folders that are not there";
  const std::string home = getenv("HOME") == nullptr ? "" : getenv("HOME");
  setenv("HOME", folder.c_str(), 1);
  EXPECT_EQ(file_series(std::vector<std::string>{"~/br[1]/p_*.csv"}).files[0], path("br[1]/p_0.csv"));
  setenv("HOME", home.c_str(), 1);
}

TEST_F(FileSeriesNames, NamesThatCannotBeExaminedAreSaid) {
  fs::create_symlink("loop_1.csv", folder / "loop_1.csv");
  const std::string too_long = path(std::string(300, 'x') + ".csv");
  EXPECT_EQ(message_of<IoError>([&] { file_series(std::vector{too_long}); }),
            too_long + ": there is no such file");
  EXPECT_THROW(series("loop_1.csv"), Error) << "no std::filesystem::filesystem_error";
}

}  // namespace
}  // namespace kappaflow
