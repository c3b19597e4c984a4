// `kappaflow convert`, and that a run with --format writes the same.
#include <fmt/format.h>

#include <map>

#include "tests/tools/program.h"
#include "tests/tools/scratch.h"
#include "tools/io/folder_lock.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

const std::string kSmallScene = KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml";
const std::string kMovingScene = KAPPAFLOW_SOURCE_DIR "/tests/tools/commands/usd_scene.toml";

class Convert : public Scratch {
 protected:
  ProgramResult run(const std::string& scene, const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> words{
        "run", scene, "--quiet", "--duration", "0.1", "--out", (folder / name).string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  /// The files that are not VTK's or tables, by their names relative to the folder.
  std::map<std::string, std::string> exported(const std::string& name) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder / name))
      for (const char* kind : {".obj", ".ply", ".glb", ".usda"})
        if (entry.path().extension() == kind)
          files[fs::relative(entry.path(), folder / name).string()] = bytes_of(entry.path());
    return files;
  }

  void expect_same(const std::map<std::string, std::string>& found,
                   const std::map<std::string, std::string>& wanted) const {
    for (const auto& [name, bytes] : wanted) {
      ASSERT_TRUE(found.contains(name)) << name;
      EXPECT_TRUE(found.at(name) == bytes) << name;
    }
    EXPECT_EQ(found.size(), wanted.size());
  }
};

TEST_F(Convert, WritesWhatTheRunWouldHaveWritten) {
  for (const std::string& scene : {kSmallScene, kMovingScene}) {
    const std::string formats = scene == kSmallScene ? "obj,ply,glb,usd" : "usd";
    ASSERT_EQ(run(scene, "written", {"--force", "--format", formats}).exit_code, 0);
    const auto wanted = exported("written");
    ASSERT_GT(wanted.size(), 15u);
    const std::string in = (folder / "written").string(), out = (folder / "converted").string();
    const ProgramResult result = run_program({"convert", in, "--format", formats, "--out", out});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find(out + "/run.usda"), std::string::npos) << result.out;
    expect_same(exported("converted"), wanted);
    fs::remove_all(folder / "converted");
  }
}

TEST_F(Convert, WritesIntoTheRunsFolderAndARunThatReplacesItTakesThemAway) {
  ASSERT_EQ(run(kSmallScene, "a", {"--track", "total,regional"}).exit_code, 0);
  ASSERT_EQ(run_program({"convert", (folder / "a").string(), "--methods", "regional"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "a/surface-regional.usda"));
  EXPECT_TRUE(fs::exists(folder / "a/surface-regional/surface.0000.usda"));
  EXPECT_FALSE(fs::exists(folder / "a/surface-total.usda"));
  EXPECT_EQ(bytes_of(folder / "a/run.usda").find("surface-total"), std::string::npos);
  ASSERT_EQ(run(kSmallScene, "a", {"--force"}).exit_code, 0);
  EXPECT_TRUE(exported("a").empty());
}

TEST_F(Convert, MistakesAreOneLine) {
  const auto refuses = [&](std::vector<std::string> words, int code, const std::string& what) {
    words.insert(words.begin(), "convert");
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.exit_code, code);
    EXPECT_NE(result.err.find(what), std::string::npos) << result.err;
    EXPECT_EQ(split(result.err, '\n').size(), 1u) << result.err;
  };
  refuses({}, 2, "DIR is required");
  refuses({folder.string()}, 5, "run.json: cannot be read");
  ASSERT_EQ(run(kSmallScene, "a", {"--track", "material"}).exit_code, 0);
  const std::string in = (folder / "a").string();
  refuses({in, "--methods", "total"}, 2, "has no surface tracked with \"total\"");
  refuses({in, "--format", "vtk"}, 2, "found \"vtk\"; expected one of obj, ply, glb, usd");
  refuses({in, "--up", "0,1"}, 2, "--up: found \"0,1\"; expected X,Y,Z");
  {
    const FolderLock lock(in);
    refuses({in}, 2, "is writing into");
  }
  file("a/surface-material/surface_0001.vtp", "nothing");
  refuses({in}, 5, "surface_0001.vtp: is damaged or not complete");
}

/// At every moment the roots list frames that are there.
TEST_F(Convert, AnInterruptedRunHasAnAssetThatOpens) {
  const std::vector<std::string> words{"run",     kSmallScene, "--out", (folder / "a").string(),
                                       "--quiet", "--format",  "usd",   "--track",
                                       "material"};
  EXPECT_EQ(run_program(words, {}, {9, folder / "a/surface-material/surface.0004.usda", 0}).exit_code, 137);
  const std::string root = bytes_of(folder / "a/run.usda"), end = "endTimeCode = ";
  const int last = std::stoi(root.substr(root.find(end) + end.size()));
  EXPECT_GE(last, 3);
  for (int frame = 0; frame <= last; ++frame)
    for (const std::string stem : {"surface-material/surface", "particles/particles"}) {
      const std::string text = bytes_of(folder / "a" / fmt::format("{}.{:04}.usda", stem, frame));
      EXPECT_TRUE(text.ends_with("\n}\n")) << stem << frame;
      EXPECT_NE(text.find(fmt::format("        {}: [", frame)), std::string::npos);
    }
  for (const char* file : {"surface-material.usda", "particles.usda", "boundary.usda", "boundary/walls.usda",
                           "surface-material/manifest.usda", "particles/manifest.usda"})
    EXPECT_TRUE(fs::exists(folder / "a" / file)) << file;
}

}  // namespace
}  // namespace kappaflow
