// Surfaces apart that are told of the particles near them, and particles in pieces; ranks are threads.
#include "tools/runs/near_liquid.h"

#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLPPolyDataReader.h>

#include <algorithm>
#include <csignal>
#include <fstream>

#include "tests/tools/runs/runs_on_ranks.h"
#include "tests/vtk_reader.h"
#include "tools/io/parallel_vtk.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

using NearLiquids = RunsOnRanks;

/// Sorted by id.
InputFrame particles_in(const fs::path& run, int frame) {
  const InputFrame read = read_input_frame(particles_of(run, frame));
  InputFrame sorted = read;
  std::vector<std::size_t> order(read.id.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::sort(order, {}, [&](std::size_t i) { return read.id[i]; });
  for_each_array(read, sorted, [&](const auto& from, auto& to) {
    for (std::size_t k = 0; k < from.size(); ++k) to[k] = from[order[k]];
  });
  return sorted;
}

void expect_same_particles(const InputFrame& a, const InputFrame& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.pressure, b.pressure);
  EXPECT_EQ(a.temperature, b.temperature);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.time, b.time);
}

/// The surfaces agree to a thousandth of a spacing, with all that they carry.
void expect_same_surface(const fs::path& a, const fs::path& b) {
  const auto x = read_vtp(a), y = read_vtp(b);
  ASSERT_EQ(x->GetNumberOfPoints(), y->GetNumberOfPoints()) << a;
  ASSERT_EQ(x->GetNumberOfPolys(), y->GetNumberOfPolys());
  double farthest = 0;
  for (vtkIdType v = 0; v < x->GetNumberOfPoints(); ++v)
    farthest = std::max(farthest, (Vec3(x->GetPoint(v)) - Vec3(y->GetPoint(v))).norm());
  EXPECT_LT(farthest, 5e-5);
}

// One rank has the liquid, so that the particles are those of one process to the bit.
TEST_F(NearLiquids, HasTheParticlesOfOneProcessAndItsSurface) {
  run_on(1, options("one", kAll));
  run_on(2, options("near", kFew));
  for (int frame = 0; frame <= kLast; ++frame) {
    EXPECT_EQ(particles_of(folder / "near", frame), folder / "near" / particle_list(frame));
    expect_same_particles(particles_in(folder / "one", frame), particles_in(folder / "near", frame));
    expect_same_surface(folder / "one" / surface_file("regional", frame),
                        folder / "near" / surface_file("regional", frame));
  }
  const auto expected = read_metrics(folder / "one" / kMetricsFile),
             found = read_metrics(folder / "near" / kMetricsFile);
  ASSERT_EQ(found.size(), kLast + 1u);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const FrameMetrics &a = expected[k].frame, &b = found[k].frame;
    EXPECT_EQ(a.particles, b.particles);
    EXPECT_EQ(a.particles_outside, b.particles_outside);
    EXPECT_NEAR(*a.penetration_max, *b.penetration_max, 1e-9);
    EXPECT_NEAR(*a.density_error_mean, *b.density_error_mean, 1e-9);
    EXPECT_NEAR(*a.density_error_max, *b.density_error_max, 1e-9);
    EXPECT_NEAR(*a.temperature_min, *b.temperature_min, 1e-9);
    EXPECT_NEAR(*a.temperature_mean, *b.temperature_mean, 1e-9);
    EXPECT_NEAR(*a.temperature_max, *b.temperature_max, 1e-9);
  }
}

TEST_F(NearLiquids, WritesAPieceARankWhateverTheirNumber) {
  run_on(4, options("near", kFew));
  run_on(4, options("all", kAll));
  for (int frame = 0; frame <= kLast; ++frame) {
    const std::vector<fs::path> pieces = pieces_of(particles_of(folder / "near", frame));
    ASSERT_EQ(pieces.size(), 3u);
    for (const fs::path& piece : pieces) EXPECT_GT(read_input_frame(piece).id.size(), 1000u);
    expect_same_particles(particles_in(folder / "all", frame), particles_in(folder / "near", frame));
    expect_same_surface(folder / "all" / surface_file("regional", frame),
                        folder / "near" / surface_file("regional", frame));
  }
  const vtkNew<vtkXMLPPolyDataReader> reader;
  reader->SetFileName((folder / "near" / particle_list(kLast)).c_str());
  reader->Update();
  const auto alone = read_vtp(folder / "all" / particle_file(kLast));
  EXPECT_EQ(reader->GetOutput()->GetNumberOfPoints(), alone->GetNumberOfPoints());
  EXPECT_EQ(reader->GetOutput()->GetPointData()->GetNumberOfArrays(),
            alone->GetPointData()->GetNumberOfArrays());
  EXPECT_EQ(reader->GetOutput()->GetPoints()->GetDataType(), VTK_DOUBLE);
  const std::string listed = bytes_of(folder / "near" / "particles.pvd");
  EXPECT_NE(listed.find("particles/particles_0004.pvtp"), std::string::npos);
}

// By other ranks, or by none. The signal comes in the second frame, which has no checkpoint of its own.
TEST_F(NearLiquids, GoesOnWithAnyNumberOfRanks) {
  run_on(1, options("one", kAll));
  for (const int ranks : {1, 4}) {
    ASSERT_EQ(run_on(3, options("run", kFew), 4, [] { std::raise(SIGTERM); }).signal, SIGTERM);
    ASSERT_TRUE(fs::exists(folder / "run" / particle_list(1)));
    const int done = static_cast<int>(read_metrics(folder / "run" / kMetricsFile).size());  // frames
    ASSERT_LE(done, kLast);
    RunOptions rest = options("run", kFew);
    rest.resume = rest.folder;
    rest.scene.clear();
    EXPECT_EQ(run_on(ranks, rest).error, "");
    for (int frame = 0; frame <= kLast; ++frame) {  // each has a list: one is enough for who reads the folder
      const std::size_t writers = frame < done ? 2 : static_cast<std::size_t>(std::max(1, ranks - 1));
      EXPECT_EQ(pieces_of(folder / "run" / particle_list(frame)).size(), writers) << frame;
    }
    const InputFrame expected = particles_in(folder / "one", kLast),
                     found = particles_in(folder / "run", kLast);
    ASSERT_EQ(expected.id, found.id);
    double farthest = 0;
    for (std::size_t i = 0; i < found.id.size(); ++i)
      farthest = std::max(farthest, (expected.position[i] - found.position[i]).norm());
    EXPECT_LT(farthest, 5e-5) << ranks;
  }
}

TEST_F(NearLiquids, APieceThatCannotBeWrittenEndsTheRun) {
  const fs::path in_the_way = folder / "run" / particle_piece(3, 1);
  const Outcome outcome =
      run_on(4, options("run", kFew), 3, [&] { fs::create_directories(in_the_way / "x"); });
  EXPECT_TRUE(outcome.error.starts_with("5: " + in_the_way.string())) << outcome.error;
  EXPECT_NE(outcome.error.find("--resume"), std::string::npos) << outcome.error;
  fs::remove_all(in_the_way);
  RunOptions rest = options("run", kFew);
  rest.resume = rest.folder;
  EXPECT_EQ(run_on(4, rest).error, "");
  EXPECT_EQ(read_metrics(folder / "run" / kMetricsFile).size(), kLast + 1u);
}

TEST_F(NearLiquids, APieceThatTheFirstRankDoesNotSeeEndsTheRun) {
  const fs::path piece = folder / "run" / particle_piece(2, 0);
  const Outcome outcome = run_on(3, options("run", kFew), 5, [&] { fs::remove(piece); });
  EXPECT_NE(outcome.error.find("of which 1 can be seen"), std::string::npos) << outcome.error;
}

// An emitter's first liquid is in few cells: of so many ranks most have none.
TEST_F(NearLiquids, RanksMayHaveNoParticles) {
  RunOptions o = options("jet", kFew);
  o.scene = folder / "jet.toml";
  std::ofstream(o.scene) << R"(
duration = 0.02
[fluid]
spacing = 0.05
kinematic_viscosity = 0.1
[[fluid.emitter]]
shape = "disc"
position = [0, 1, 0]
direction = [0, -1, 0]
radius = 0.15
speed = 2.0
[[outflow]]
shape = "box"
lower = [-1, 0, -1]
upper = [1, 0.95, 1]
[surface]
methods = ["material"]
[output]
frames_per_second = 100
)";
  ASSERT_EQ(run_on(6, o).error, "");
  for (int frame = 0; frame <= 2; ++frame) {
    const std::size_t pieces = pieces_of(particles_of(o.folder, frame)).size();
    EXPECT_LT(pieces, 5u);
    const InputFrame all = read_input_frame(particles_of(o.folder, frame));
    EXPECT_EQ(all.id.size(),
              read_metrics(o.folder / kMetricsFile)[static_cast<std::size_t>(frame)].frame.particles);
    EXPECT_EQ(all.density.size(), all.id.size());
  }
}

}  // namespace
}  // namespace kappaflow
