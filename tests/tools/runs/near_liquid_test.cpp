// Surfaces apart that are told of the particles near them, and particles in pieces; ranks are threads.
#include "tools/runs/near_liquid.h"

#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLPPolyDataReader.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <thread>

#include "tests/solver/thread_ranks.h"
#include "tests/tools/scratch.h"
#include "tests/vtk_reader.h"
#include "tools/io/parallel_vtk.h"
#include "tools/runs/run.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// A ball with its middle 14 spacings deep, that falls, and a hot drop. Nothing flat of a lattice, where
/// edges are of one length and rounding says which is edited.
constexpr const char* kScene = R"(
duration = 0.04
[fluid]
spacing = 0.05
kinematic_viscosity = 0.02
density = 1000
gravity = [0, -9.81, 0]
[[fluid.block]]
shape = "sphere"
center = [0.51, 0.9, 0.52]
radius = 0.72
velocity = [0.5, -2, 0]
[[fluid.block]]
shape = "sphere"
center = [1.9, 0.7, 0.6]
radius = 0.2
temperature = 350
[[wall]]
shape = "box"
lower = [-5, -1, -5]
upper = [5, 0, 5]
[heat]
temperature = 300
specific_heat = 1000
conductivity = 10
[surface]
methods = ["regional"]
threshold = 2.5
[output]
frames_per_second = 100
checkpoint_interval = 3
metrics_interval = 4
)";
constexpr int kLast = 4;  // frame

class NearLiquids : public Scratch {
 protected:
  RunOptions options(const char* name, std::size_t many) const {
    RunOptions o;
    o.scene = folder / "balls.toml";
    if (!fs::exists(o.scene)) std::ofstream(o.scene) << kScene;
    o.folder = folder / name;
    o.threads = 2;
    o.many = many;
    o.force = o.quiet = true;
    return o;
  }
};

constexpr std::size_t kAll = 1'000'000, kFew = 100;

/// Sends the program a signal when it has told the surfaces' rank so many things; 0: never.
class SignallingRanks final : public ThreadRanks {
 public:
  SignallingRanks(RankBoard& board, int rank, int signal_at) : ThreadRanks(board, rank), left_(signal_at) {}
  void exchange_asleep(std::span<const Parcel> sent, std::span<const Parcel> received) override {
    if (!sent.empty() && --left_ == 0) std::raise(SIGTERM);
    ThreadRanks::exchange_asleep(sent, received);
  }

 private:
  int left_;
};

/// On so many ranks; of one, alone. Returns the signal that ended it.
int run_on(int size, RunOptions options, int signal_at = 0) noexcept {
  if (size == 1) return run_scene(options).interrupted_by;
  RankBoard board(size);
  std::vector<std::jthread> others;
  for (int rank = 1; rank < size; ++rank)
    others.emplace_back([&board, rank, options, signal_at]() mutable {
      SignallingRanks ranks(board, rank, signal_at);
      options.ranks = &ranks;
      follow_run(options);
    });
  ThreadRanks ranks(board, 0);
  options.ranks = &ranks;
  const int signal = run_scene(options).interrupted_by;
  ranks.announce({RankTask::end});
  return signal;
}

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
  for (const int ranks : {1, 2, 4}) {
    ASSERT_EQ(run_on(3, options("run", kFew), 4), SIGTERM);
    ASSERT_TRUE(fs::exists(folder / "run" / particle_list(1)));
    ASSERT_FALSE(fs::exists(folder / "run" / surface_file("regional", kLast)));
    RunOptions rest = options("run", kFew);
    rest.resume = rest.folder;
    rest.scene.clear();
    EXPECT_EQ(run_on(ranks, rest), 0);
    EXPECT_EQ(fs::exists(folder / "run" / particle_list(kLast)), ranks > 1);
    const InputFrame expected = particles_in(folder / "one", kLast),
                     found = particles_in(folder / "run", kLast);
    ASSERT_EQ(expected.id, found.id);
    double farthest = 0;
    for (std::size_t i = 0; i < found.id.size(); ++i)
      farthest = std::max(farthest, (expected.position[i] - found.position[i]).norm());
    EXPECT_LT(farthest, 5e-5) << ranks;
  }
}

}  // namespace
}  // namespace kappaflow
