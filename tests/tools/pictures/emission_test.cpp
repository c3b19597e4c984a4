#include "tools/pictures/emission.h"

#include <gtest/gtest.h>
#include <vtkPointData.h>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tools/io/vtp_files.h"
#include "tools/pictures/render.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

/// Folders of runs whose particles stand in a row, number i at x = i; the surface has a vertex beside each of
/// the first three.
class Emission : public Scratch {
 protected:
  void SetUp() override {
    Scratch::SetUp();
    file("run.json", R"({"methods": ["material"]})");
    for (const char* name : {"particles", "surface-material"})
      std::filesystem::create_directory(folder / name);
  }
  void add_frame(int frame, double time, int particles, const std::vector<int>& sources, bool ids = true) {
    ParticleFrame data;
    data.particles.time = time;
    for (int i = 0; i < particles; ++i) {
      data.particles.position.emplace_back(i, 0, 0);
      data.particles.velocity.emplace_back(0, 0, 0);
      data.particles.id.push_back(i);
    }
    const auto written = particle_data(data);
    if (!ids) written->GetPointData()->RemoveArray("id");
    write_vtp(folder / particle_file(frame), *written);
    TriangleMesh mesh = make_triangle_mesh({{0, 0.1, 0}, {1.1, 0, 0}, {2, 0.2, 0}}, {{0, 1, 2}});
    mesh.source = sources;
    SurfaceState state;
    state.normal.assign(3, Vec3::UnitZ());
    state.motion.velocity.assign(3, Vec3::Zero());
    state.motion.confidence = state.mean_curvature = state.gaussian_curvature = {0, 0, 0};
    write_vtp(folder / surface_file("material", frame), *surface_data({time, mesh, state}));
  }
  std::string chosen() const { return default_colour(RunFrames(folder, {})); }
};

TEST_F(Emission, IsBetweenTheFramesInTheOrderOfIds) {
  add_frame(0, 0.5, 1, {0, 0, 0});
  add_frame(1, 1.5, 1, {0, 0, 0});
  add_frame(2, 2.5, 3, {0, 0, 0});
  const RunFrames frames(folder, {});
  const EmissionTimes times(frames, 2);
  const auto surface = frames.surface("material", 2);
  times.add_to(*surface, 2);
  vtkDataArray& array = *surface->GetPointData()->GetArray("emission_time");
  EXPECT_EQ(array.GetTuple1(0), 0.5) << "there from the beginning";
  EXPECT_EQ(array.GetTuple1(1), 2) << "the first of two that came";
  EXPECT_EQ(array.GetTuple1(2), 2.5);
}

TEST_F(Emission, ChoosesWhatTellsMost) {
  add_frame(0, 0, 3, {0, 1, 1});
  add_frame(1, 1, 3, {0, 1, 1});
  EXPECT_EQ(chosen(), "checker") << "nothing flows in";
  add_frame(1, 1, 4, {0, 1, 1});
  EXPECT_EQ(chosen(), "source");
  add_frame(1, 1, 4, {1, 1, 1});
  EXPECT_EQ(chosen(), "emission_time") << "all from one";
  add_frame(1, 1, 4, {});
  EXPECT_EQ(chosen(), "emission_time") << "nobody knows from where";
  std::filesystem::remove_all(folder / "particles");
  EXPECT_EQ(chosen(), "checker") << "nobody knows";
}

TEST_F(Emission, NeedsIds) {
  add_frame(0, 0, 3, {}, false);
  EXPECT_EQ(chosen(), "checker");
  const RunFrames frames(folder, {});
  EXPECT_EQ(message_of<InvalidInput>([&] { EmissionTimes(frames, 0); }),
            folder.string() + " does not say which particle is which, so nobody knows when each came");
}

}  // namespace
}  // namespace kappaflow
