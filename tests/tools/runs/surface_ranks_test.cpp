// Surfaces that several ranks follow together; ranks are threads.
#include <algorithm>
#include <csignal>

#include "tests/tools/runs/runs_on_ranks.h"
#include "tools/io/parallel_vtk.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

class SurfaceRanks : public RunsOnRanks {
 protected:
  /// As options(), of a ball that is soon through.
  RunOptions small(const char* name, int surface_ranks) const {
    return with("radius = 0.72", "radius = 0.4", options(name, kAll, surface_ranks));
  }
  static RunOptions with(const std::string& old, const std::string& text, RunOptions o) {
    std::string scene = kScene;
    std::ofstream(o.scene) << scene.replace(scene.find(old), old.size(), text);
    return o;
  }
  /// All that does not say how long it took, or on how many ranks.
  std::vector<fs::path> files_of(const char* run) const {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / run)) {
      const fs::path file = fs::relative(entry.path(), folder / run);
      if (entry.is_regular_file() && file != "run.json" && file != kTimingsFile && file != kCheckpointFile)
        files.push_back(file);
    }
    std::ranges::sort(files);
    return files;
  }
  void expect_same_files(const char* a, const char* b) const {
    const std::vector<fs::path> files = files_of(a);
    EXPECT_GT(files.size(), 10u);
    EXPECT_EQ(files, files_of(b));
    for (const fs::path& file : files)
      EXPECT_EQ(bytes_of(folder / a / file), bytes_of(folder / b / file)) << file;
  }
};

// One rank has the liquid, so that its particles are those of one process to the bit.
TEST_F(SurfaceRanks, LeaveTheFilesOfOneProcess) {
  run_on(1, small("one", 1));
  for (const int surfaces : {2, 3}) {
    ASSERT_EQ(run_on(surfaces + 1, small("several", surfaces)).error, "");
    expect_same_files("one", "several");
  }
}

TEST_F(SurfaceRanks, MayBeToldOfTheParticlesNearAlone) {
  ASSERT_EQ(run_on(3, options("one", kFew, 1)).error, "");
  ASSERT_EQ(run_on(4, options("several", kFew, 2)).error, "");
  expect_same_files("one", "several");
}

// The signal comes in the second frame, which has no checkpoint of its own.
TEST_F(SurfaceRanks, GoOnAsIfTheyHadNotStopped) {
  run_on(1, small("one", 1));
  ASSERT_EQ(run_on(3, small("run", 2), 4, [] { std::raise(SIGTERM); }).signal, SIGTERM);
  const std::vector<MetricsRow> stopped = read_metrics(folder / "run" / kMetricsFile);
  ASSERT_LE(std::ssize(stopped), kLast);
  RunOptions rest = small("run", 3);
  rest.resume = rest.folder;
  rest.scene.clear();
  ASSERT_EQ(run_on(4, rest).error, "");
  expect_same_files("one", "run");
}

TEST_F(SurfaceRanks, EndWithTheLiquidThatFails) {
  const fs::path in_the_way = folder / "run" / particle_piece(3, 0);
  const Outcome outcome =
      run_on(3, options("run", kFew, 2), 3, [&] { fs::create_directories(in_the_way / "x"); });
  EXPECT_TRUE(outcome.error.starts_with("5: " + in_the_way.string())) << outcome.error;
}

// All of them find it, and the first says so.
TEST_F(SurfaceRanks, EndWithASurfaceThatCannotBe) {
  const RunOptions o = with("threshold = 2.5", "threshold = 100", options("run", kAll, 2));
  EXPECT_NE(run_on(3, o).error.find("the surface is empty"), std::string::npos);
}

}  // namespace
}  // namespace kappaflow
