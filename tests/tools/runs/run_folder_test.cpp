#include "tools/runs/run_folder.h"

#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include <sstream>

#include "core/errors.h"
#include "core/saved_state.h"
#include "tests/tools/scratch.h"
#include "tools/io/files.h"
#include "tools/runs/body_rows.h"
#include "tools/runs/metrics.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

class RunFolderFiles : public Scratch {
 protected:
  vtkSmartPointer<vtkPolyData> point() const {
    auto points = vtkSmartPointer<vtkPoints>::New();
    points->InsertNextPoint(1, 2, 3);
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    return data;
  }

  void write_frame(RunFolder& run, int frame) {
    run.write_particles(frame, point());
    for (const std::string method : {"total", "curvature"}) run.write_surface(frame, method, point());
    run.finish_frame(0.1 * frame, {.metrics = "m\n", .pieces = "p\n", .timings = "t\n"});
  }
};

TEST_F(RunFolderFiles, HasItsLayoutAfterEveryFrame) {
  const fs::path path = folder / "deep" / "run";
  RunFolder run(path, {"total", "curvature"}, false);
  run.write_record("{}");
  run.write_boundary(point());
  write_frame(run, 0);
  write_frame(run, 1);
  run.wait();
  for (const char* name : {"run.json", "boundary.vtp", "particles/particles_0001.vtp",
                           "surface-total/surface_0000.vtp", "surface-curvature/surface_0001.vtp"})
    EXPECT_TRUE(fs::is_regular_file(path / name)) << name;
  EXPECT_EQ(bytes_of(path / "metrics.csv"), metrics_header() + "m\nm\n");
  EXPECT_EQ(bytes_of(path / "pieces.csv"), pieces_header() + "p\np\n");
  EXPECT_EQ(bytes_of(path / "timings.csv"), timings_header() + "t\nt\n");
  for (const auto& entry : fs::recursive_directory_iterator(path))
    EXPECT_NE(entry.path().extension(), ".tmp");
}

TEST_F(RunFolderFiles, CollectionsNameFilesThatExist) {
  RunFolder run(folder / "run", {"total", "curvature"}, false);
  run.write_boundary(point());
  write_frame(run, 0);
  write_frame(run, 1);
  run.wait();
  const std::vector<std::pair<const char*, int>> entries{
      {"run.pvd", 8}, {"particles.pvd", 2}, {"surface-total.pvd", 2}, {"surface-curvature.pvd", 2}};
  for (const auto& [name, count] : entries) {
    int found = 0;
    for (const std::string& part : split(bytes_of(folder / "run" / name), '"'))
      if (part.ends_with(".vtp")) {
        ++found;
        EXPECT_TRUE(fs::exists(folder / "run" / part)) << part;
      }
    EXPECT_EQ(found, count) << name;
  }
}

TEST_F(RunFolderFiles, MovingWallsAreASeries) {
  {
    RunFolder run(folder / "run", {"total", "curvature"}, false);
    for (const int frame : {0, 1}) {
      run.write_boundary(frame, point());
      write_frame(run, frame);
    }
  }
  EXPECT_TRUE(fs::exists(folder / "run/boundary/boundary_0001.vtp"));
  EXPECT_FALSE(fs::exists(folder / "run/boundary.vtp"));
  for (const char* collection : {"run.pvd", "boundary.pvd"}) {
    const std::string text = bytes_of(folder / "run" / collection);
    EXPECT_NE(text.find("boundary/boundary_0000.vtp"), std::string::npos);
    EXPECT_NE(text.find("boundary/boundary_0001.vtp"), std::string::npos);
  }
  file("run/run.json", "{}");
  RunFolder again(folder / "run", {"total"}, true);
  again.take_place();
  EXPECT_FALSE(fs::exists(folder / "run/boundary"));
  EXPECT_FALSE(fs::exists(folder / "run/boundary.pvd"));
}

TEST_F(RunFolderFiles, BodiesHaveATableWhereThereAreSome) {
  const fs::path table = folder / "run/bodies.csv";
  std::stringstream state;
  {
    RunFolder run(folder / "run", {"total", "curvature"}, false);
    for (const int frame : {0, 1, 2}) {
      run.write_particles(frame, point());
      run.finish_frame(0.1 * frame,
                       {.metrics = "m\n", .pieces = "p\n", .timings = "t\n", .bodies = "b0\nb1\n"});
      run.wait();
      if (frame == 0) StateWriter(state, little_endian())(run);
    }
  }
  EXPECT_EQ(bytes_of(table), bodies_header() + "b0\nb1\nb0\nb1\nb0\nb1\n");
  {
    RunFolder resumed(folder / "run");
    StateReader archive(state);
    archive(resumed);
  }
  EXPECT_EQ(bytes_of(table), bodies_header() + "b0\nb1\n") << "cut back to what it was";
  file("run/run.json", "{}");
  RunFolder again(folder / "run", {"total"}, true);
  again.take_place();
  EXPECT_FALSE(fs::exists(table));
}

TEST_F(RunFolderFiles, RefusesAUsedFolderUnlessForced) {
  {
    RunFolder run(folder, {"total", "curvature"}, false);
    run.write_record("{}");
    write_frame(run, 0);
    write_frame(run, 1);
  }
  file("notes.txt", "mine");
  file("surface-total/mine.txt", "mine");
  EXPECT_EQ(message_of<InvalidInput>([&] { RunFolder(folder, {"total"}, false); }),
            folder.string() + " already holds a run; --force replaces it, --out DIR writes elsewhere");
  EXPECT_TRUE(fs::exists(folder / "run.json"));

  RunFolder again(folder, {"total"}, true);
  again.take_place();
  EXPECT_FALSE(fs::exists(folder / "run.json"));
  EXPECT_FALSE(fs::exists(folder / "run.pvd"));
  EXPECT_FALSE(fs::exists(folder / "surface-curvature"));
  EXPECT_FALSE(fs::exists(folder / "particles")) << "the new run has written none so far";
  EXPECT_EQ(bytes_of(folder / "metrics.csv"), metrics_header());
  EXPECT_EQ(bytes_of(folder / "notes.txt"), "mine") << "only the run's own files go";
  EXPECT_EQ(bytes_of(folder / "surface-total/mine.txt"), "mine");
}

TEST_F(RunFolderFiles, ARunStaysUntilTheOneThatReplacesItHasBegun) {
  const auto write_run = [&](RunFolder& run, const char* record) {
    run.write_record(record);
    write_frame(run, 0);
  };
  {
    RunFolder run(folder, {"total", "curvature"}, false);
    write_run(run, "old");
  }
  file("surface-total/mine.txt", "mine");
  const auto expect_old = [&] {
    EXPECT_EQ(bytes_of(folder / "run.json"), "old");
    EXPECT_EQ(bytes_of(folder / "metrics.csv"), metrics_header() + "m\n");
    EXPECT_TRUE(fs::exists(folder / "surface-total/surface_0000.vtp"));
  };
  {
    RunFolder failed(folder, {"total", "curvature"}, true);
    write_run(failed, "failed");
    failed.wait();
    expect_old();
  }
  expect_old();
  EXPECT_FALSE(fs::exists(folder / "beginning.tmp"));
  fs::create_directory(folder / "beginning.tmp");
  file("beginning.tmp/run.json", "killed");
  RunFolder run(folder, {"total", "curvature"}, true);
  write_run(run, "new");
  run.take_place();
  write_frame(run, 1);
  run.wait();
  EXPECT_EQ(bytes_of(folder / "run.json"), "new");
  EXPECT_EQ(bytes_of(folder / "metrics.csv"), metrics_header() + "m\nm\n");
  for (const char* name : {"surface-total/surface_0000.vtp", "surface-total/surface_0001.vtp",
                           "particles/particles_0000.vtp", "surface-total/mine.txt"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  EXPECT_FALSE(fs::exists(folder / "beginning.tmp"));
}

TEST_F(RunFolderFiles, FramesWithoutARecordAreNotOverwrittenEither) {
  fs::create_directories(folder / "particles");
  RunFolder(folder, {"total"}, false);  // empty folders are no results
  file("particles/particles_0000.vtp", "another program's");
  EXPECT_EQ(message_of<InvalidInput>([&] { RunFolder(folder, {"total"}, false); }),
            folder.string() + " already holds a run; --force replaces it, --out DIR writes elsewhere");
  EXPECT_EQ(bytes_of(folder / "particles/particles_0000.vtp"), "another program's");
}

TEST_F(RunFolderFiles, TwoRunsIntoOneFolderAreRefused) {
  {
    RunFolder run(folder, {"total"}, false);
    run.write_record("{}");
    run.wait();
    EXPECT_EQ(message_of<InvalidInput>([&] { RunFolder(folder, {"total"}, true); }),
              "another run is writing into " + folder.string() + "; --out DIR writes elsewhere");
    EXPECT_TRUE(fs::exists(folder / "run.json")) << "nothing of the first run is touched";
  }
  RunFolder(folder, {"total"}, true);  // once it has ended
}

// What is in the folder stays a whole run: the frame whose file failed is in no table, and nothing after it.
TEST_F(RunFolderFiles, NothingIsWrittenAfterWhatCouldNotBe) {
  RunFolder run(folder / "run", {"total", "curvature"}, false);
  write_frame(run, 0);
  run.wait();
  fs::remove_all(folder / "run/particles");
  write_frame(run, 1);
  run.write_checkpoint("state");
  EXPECT_THROW(run.wait(), IoError);
  write_frame(run, 2);
  EXPECT_THROW(run.wait(), IoError) << "nor later";
  EXPECT_EQ(bytes_of(folder / "run/metrics.csv"), metrics_header() + "m\n");
  for (const char* name :
       {"surface-total/surface_0001.vtp", "surface-total/surface_0002.vtp", "checkpoint.bin"})
    EXPECT_FALSE(fs::exists(folder / "run" / name)) << name;
}

TEST_F(RunFolderFiles, UnwritablePlaceIsAnIoError) {
  file("occupied", "a file");
  EXPECT_THROW(RunFolder(folder / "occupied", {}, false), IoError);
  EXPECT_THROW(RunFolder("/proc/kappaflow", {}, false), IoError);
}

}  // namespace
}  // namespace kappaflow
