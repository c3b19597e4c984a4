// Large frames, of which only the particles near the surface are kept, beside the same ones with all
// particles.
#include <fmt/format.h>

#include <utility>

#include "core/errors.h"
#include "tests/tools/runs/track_case.h"
#include "tests/tools/text_table.h"
#include "tools/io/particle_sequence.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kSpacing = 0.05;
constexpr int kSide = 44, kPieces = 3, kFrameCount = 3;
constexpr double kFrameTime = 0.0625;  // [s]

/// A jittered cube that moves by 8 spacings a frame, turns and is drawn out: x -> stretched, then moved as
/// the block.
Particles cube_at(double time, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.2 * kSpacing, 0.2 * kSpacing);
  const SteadyMotion motion{.velocity = {6, 2, -1}, .angular_velocity = {0.5, 1, -0.75}};
  const Vec3 rate(1, -0.5, -0.5);  // [1/s]
  const Mat3 R = motion.rotation(time);
  Particles particles;
  particles.time = time;
  for (int k = 0; k < kSide; ++k)
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const Vec3 jittered(jitter(random), jitter(random), jitter(random));
        const Vec3 x0 = kSpacing * (Vec3(i, j, k) - Vec3::Constant(0.5 * kSide)) + jittered;
        const Vec3 stretched = (rate * time).array().exp() * x0.array();
        particles.id.push_back(1 + static_cast<std::int64_t>(particles.id.size()));
        particles.position.push_back(motion.position(stretched, time));
        particles.velocity.push_back(motion.velocity + motion.angular_velocity.cross(R * stretched) +
                                     R * Vec3(rate.array() * stretched.array()));
      }
  return particles;
}

class TrackNearSurface : public Track {
 protected:
  void write_frames(bool ids, bool velocities) {
    for (int k = 0; k < kFrameCount; ++k) {
      const Particles all = cube_at(kFrameTime * k);
      for (std::size_t rank = 0; rank < kPieces; ++rank) {
        Particles piece;
        for (std::size_t i = rank * all.size() / kPieces; i < (rank + 1) * all.size() / kPieces; ++i) {
          piece.id.push_back(all.id[i]);
          piece.position.push_back(all.position[i]);
          piece.velocity.push_back(all.velocity[i]);
        }
        file(fmt::format("p_{}_rank{}.csv", k, rank), csv_text(piece, ids, velocities));
      }
    }
  }
  /// The fresh isosurface may have its triangles in another order, and its volume another rounding.
  void expect_same_metrics() const {
    const auto all = read_table(folder / "all/metrics.csv"), near = read_table(folder / "near/metrics.csv");
    ASSERT_EQ(all.size(), near.size());
    for (std::size_t row = 0; row < all.size(); ++row)
      for (const auto& [column, text] : all[row])
        if (column == "isosurface_volume" && !text.empty())
          EXPECT_NEAR(std::stod(text), std::stod(near[row].at(column)), 1e-9);
        else
          EXPECT_EQ(text, near[row].at(column)) << column;
  }
  TrackOptions cube_options(const char* out, std::size_t many) const {
    TrackOptions o = options_for("p_*.csv", {"material", "regional"});
    o.frames_per_second = 1 / kFrameTime;
    o.sigma = 2 * kSpacing;
    o.threshold = 2.5;
    o.edge_length = 2 * kSpacing;
    o.metrics_interval = 2;
    o.many_particles = many;
    o.folder = folder / out;
    return o;
  }
};

// Of the particles' own files only those that are kept are there.
TEST_F(TrackNearSurface, GivesTheSameSurfacesToTheBit) {
  for (const auto& [ids, backward] :
       {std::pair(true, false), std::pair(false, false), std::pair(true, true)}) {
    write_frames(ids, true);
    for (const auto& [out, many] : {std::pair("all", 1'000'000), std::pair("near", 1000)}) {
      TrackOptions o = cube_options(out, many);
      o.range.backward = backward;
      ASSERT_EQ(track(o), 0);
    }
    int compared = 0;
    for (const fs::path& name : results_in(folder / "all")) {
      if (name.string().starts_with("particles/") || name == "metrics.csv") continue;
      EXPECT_TRUE(bytes_of(folder / "all" / name) == bytes_of(folder / "near" / name)) << ids << name;
      ++compared;
    }
    EXPECT_GE(compared, 2 * kFrameCount);
    expect_same_metrics();
    const auto kept = read_vtp(folder / "near/particles/particles_0002.vtp")->GetNumberOfPoints();
    EXPECT_LT(kept, 0.92 * kSide * kSide * kSide);
    EXPECT_GT(kept, 0.5 * kSide * kSide * kSide);
  }
}

}  // namespace
}  // namespace kappaflow
