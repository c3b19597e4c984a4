// What `track` is told, asks for and refuses, and what it leaves behind where it fails.
#include <cmath>

#include "core/errors.h"
#include "tests/tools/full_disk.h"
#include "tests/tools/runs/track_case.h"
#include "tests/tools/text_table.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

TEST_F(Track, OptionsOfTheMeshAndOfTheFilesAreFollowed) {
  write_sequence("csv", kBodyMotion, 0.1, [](const Particles& p, int) { return csv_text(p, true, true); });
  TrackOptions o = options("p_*.csv", {"material"});
  o.range = {6, 10, 2};
  o.edge_length.reset();
  ASSERT_EQ(track(o), 0);
  const vtkIdType vertices = surface("material", 0)->GetNumberOfPoints();
  EXPECT_FALSE(fs::exists(folder / "out/surface-material/surface_0003.vtp")) << "files 6, 8 and 10";
  const auto rows = read_table(folder / "out/metrics.csv");
  EXPECT_DOUBLE_EQ(std::stod(rows.back().at("time")), 0.4) << "the rate is that of all files";
  EXPECT_NE(rows.back().at("isosurface_volume"), "");

  o.edge_length = 0.125 * kSigma;  // half the default
  o.metrics_interval = 0;
  o.rest_interval = 1;
  o.checker_edge = 0.123;
  o.texture = TextureProjection::planar;
  ASSERT_EQ(track(o), 0);
  const auto fine = surface("material", 2);
  EXPECT_GT(fine->GetNumberOfPoints(), 3 * vertices);
  EXPECT_DOUBLE_EQ(fine->GetFieldData()->GetArray("checker_edge")->GetTuple1(0), 0.123);
  EXPECT_EQ(read_table(folder / "out/metrics.csv").back().at("isosurface_volume"), "");
  EXPECT_EQ(read_table(folder / "out/metrics.csv").back().at("tracer_distance"), "");
  for (const char* name : {"rest_1", "rest_2", "rest_2_weight", "texture_1", "texture_2"})
    EXPECT_TRUE(fine->GetPointData()->HasArray(name)) << name;
  vtkDataArray& rest = *fine->GetPointData()->GetArray("rest_1");  // reset in this frame
  for (vtkIdType v = 0; v < fine->GetNumberOfPoints(); ++v)
    EXPECT_LT((Vec3(rest.GetTuple3(v)) - Vec3(fine->GetPoint(v))).norm(), 1e-6);

  o.edge_length = 3 * kSigma;
  EXPECT_EQ(message_of<InvalidInput>([&] { track(o); }),
            "--edge: found 0.6 m; expected 0.01 to 0.4 m, which is 0.05 to 2 sigma");
}

/// Particles of a lattice in a ball that moves by 0.1 m from frame to frame.
Particles lattice_ball(int k) {
  constexpr double kRadius = 4.2 * kBodySpacing;
  Particles ball;
  for (int z = -4; z <= 4; ++z)
    for (int y = -4; y <= 4; ++y)
      for (int x = -4; x <= 4; ++x)
        if (const Vec3 at = kBodySpacing * Vec3(x, y, z); at.norm() < kRadius) {
          ball.id.push_back(static_cast<std::int64_t>(ball.id.size()));
          ball.position.push_back(at + 0.1 * k * Vec3::UnitX());
          ball.velocity.emplace_back(1, 0, 0);
        }
  return ball;
}

TEST_F(Track, AnisotropicKernelsMakeTheSurfaceSmooth) {
  for (int k = 0; k < 3; ++k) file(fmt::format("p_{}.csv", k), csv_text(lattice_ball(k), true, true));
  /// How much the radii of the last surface differ, as their standard deviation [m].
  const auto roughness = [&](Kernels kernels) {
    TrackOptions o = options("p_*.csv", {"material"});
    o.sigma.reset();
    o.threshold.reset();
    o.edge_length = 0.25 * kSigma;
    o.kernels = kernels;
    EXPECT_EQ(track(o), 0);
    const std::string expected = fmt::format("\"kernels\" : \"{}\"", name_of(kKernels, kernels));
    EXPECT_NE(bytes_of(folder / "out/run.json").find(expected), std::string::npos);
    const auto mesh = surface("material", 2);
    double sum = 0, squares = 0;
    for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v) {
      const double radius = (Vec3(mesh->GetPoint(v)) - 0.2 * Vec3::UnitX()).norm();
      sum += radius;
      squares += radius * radius;
    }
    const auto n = static_cast<double>(mesh->GetNumberOfPoints());
    return std::sqrt(squares / n - sum / n * (sum / n));
  };
  const double round = roughness(Kernels::round), anisotropic = roughness(Kernels::anisotropic);
  EXPECT_LT(anisotropic, 0.5 * round);
}

TEST_F(Track, ParticlesWithoutASurfaceAreCounted) {
  const auto outside = [&](bool with_stray) {
    write_sequence("csv", kBodyMotion, 0.1, [&](Particles p, int) {
      if (with_stray) {
        p.id.push_back(100000);
        p.position.emplace_back(0, 3, 0);
        p.velocity.push_back(Vec3::Zero());
      }
      return csv_text(p, true, true);
    });
    TrackOptions o = options("p_*.csv", {"material"});
    o.metrics_interval = 0;
    EXPECT_EQ(track(o), 0);
    return std::stoi(read_table(folder / "out/metrics.csv").back().at("particles_outside"));
  };
  const int of_the_block = outside(false);  // its corners
  EXPECT_EQ(outside(true), of_the_block + 1);
}

TEST_F(Track, WithIdsTexturesComeFromTheParticles) {
  write_sequence("csv", kBodyMotion, 0.1, [](const Particles& p, int) { return csv_text(p, true, true); });
  TrackOptions o = options("p_*.csv", {"normal", "fresh-nearest", "fresh-particles"});
  o.edge_length = 0.25 * kSigma;
  o.anchor = Anchor::particles;
  o.metrics_interval = 1;
  ASSERT_EQ(track(o), 0);
  const auto rows = read_table(folder / "out/metrics.csv");
  const auto last = [&](std::size_t method, const char* column) {
    return rows[rows.size() - 3 + method].at(column);
  };
  for (const std::size_t exact : {0, 2}) {
    EXPECT_LT(std::stod(last(exact, "texture_distance")), 0.02);
    EXPECT_LT(std::stod(last(exact, "texture_flicker")), 0.02);
  }
  EXPECT_GT(std::stod(last(1, "texture_distance")), 0.5) << "the body has turned";
  EXPECT_GT(std::stod(last(1, "texture_flicker")), 0.1);
  EXPECT_GT(std::stod(last(0, "kept_fraction")), 0.3);
  for (const std::size_t fresh : {1, 2}) {
    EXPECT_EQ(last(fresh, "kept_since_frame"), "0");
    for (const char* column : {"slip", "rotation_captured", "tracer_distance"})
      EXPECT_EQ(last(fresh, column), "") << column;
    EXPECT_EQ(last(fresh, "components"), "1");
  }
}

TEST_F(Track, TexturesFromParticlesAreRefusedWithoutIds) {
  write_sequence("csv", kBodyMotion, 0.1, [](const Particles& p, int) { return csv_text(p, false, true); });
  TrackOptions o = options("p_*.csv", {"regional", "fresh-particles"});
  EXPECT_EQ(message_of<InvalidInput>([&] { track(o); }),
            "p: the method \"fresh-particles\" takes particles with ids that say which is which");
  o.methods = {"regional"};
  o.anchor = Anchor::particles;
  EXPECT_EQ(message_of<InvalidInput>([&] { track(o); }),
            "p: --anchor particles takes particles with ids that say which is which");
  EXPECT_FALSE(fs::exists(folder / "out"));
}

/// Two blocks of which one is twice as coarse as the other: without radii it has no surface.
TEST_F(Track, ParticlesOfTwoSizesEachHaveTheirSurface) {
  const auto body = [](int k, bool radii) {
    Particles fine = moved_block({}, 0), coarse = fine;
    std::string text = radii ? "id,x,y,z,pscale\n" : "id,x,y,z\n";
    int id = 0;
    const auto add = [&](const Particles& block, double scale, const Vec3& at) {
      for (const Vec3& x : block.position)
        text += fmt::format("{},{},{},{}{}\n", id++, scale * x[0] + at[0] + 0.02 * k, scale * x[1] + at[1],
                            scale * x[2] + at[2], radii ? fmt::format(",{}", 7 * scale) : std::string());
    };
    add(fine, 1, Vec3::Zero());
    add(fine, 1, Vec3(0.62, 0, 0));  // a block of two, so that the median is theirs
    add(coarse, 2, Vec3(3, 0, 0));
    return text;
  };
  for (const bool radii : {true, false}) {
    for (const int k : {0, 1, 2}) file(fmt::format("p_{}.csv", k), body(k, radii));
    TrackOptions o = options("p_*.csv", {"material"});
    o.sigma.reset();
    o.threshold.reset();
    o.edge_length.reset();
    ASSERT_EQ(track(o), 0);
    const auto row = read_table(folder / "out/metrics.csv").back();
    EXPECT_EQ(row.at("components"), radii ? "2" : "1");
    const double fine = 2 * 0.6 * 0.5 * 0.4, coarse = 8 * 0.6 * 0.5 * 0.4;
    const double expected = radii ? fine + coarse : fine;
    EXPECT_NEAR(std::stod(row.at("volume")), expected, 0.2 * expected);
  }
}

TEST_F(Track, PointCloudsThatMoveTooFarAreSaidBeforeAnythingIsWritten) {
  const SteadyMotion fast{.velocity = {0.8, 0, 0}};
  write_sequence("csv", fast, 0.1, [](const Particles& p, int) { return csv_text(p, false, false); });
  const std::string message = message_of<InvalidInput>([&] { track(options("p_*.csv", {"regional"})); });
  EXPECT_TRUE(message.starts_with((folder / "p_7.csv").string() + ": the surface moves 0.")) << message;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

/// The block with each of its particles there twice, or one particle of it.
Particles doubled_block(double time) {
  Particles p = moved_block(kBodyMotion, time);
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    p.id.push_back(1000 + static_cast<std::int64_t>(i));
    p.position.push_back(p.position[i]);
    p.velocity.push_back(p.velocity[i]);
  }
  return p;
}
Particles lone_particle(double time) {
  return {time, {7}, {kBodyMotion.position(Vec3::Zero(), time)}, {kBodyMotion.velocity}};
}

TEST_F(Track, WithoutASpacingSigmaIsAskedForByFileAndParticles) {
  TrackOptions o = options("p_*.csv", {"material"});
  o.threshold.reset();
  o.sigma.reset();
  write_sequence("csv", kBodyMotion, 0.1,
                 [](const Particles& p, int) { return csv_text(doubled_block(p.time), true, true); });
  EXPECT_EQ(
      message_of<InvalidInput>([&] { track(o); }),
      (folder / "p_6.csv").string() +
          ": 120 of 240 particles are where others are, e.g. 5 and 1000, and have no spacing; keep one in a "
          "place, or say the radius of a particle's field by --sigma");
  write_sequence("csv", kBodyMotion, 0.1,
                 [](const Particles& p, int) { return csv_text(lone_particle(p.time), true, true); });
  EXPECT_EQ(
      message_of<InvalidInput>([&] { track(o); }),
      (folder / "p_6.csv").string() +
          ": holds one particle, which has no spacing; say the radius of a particle's field by --sigma");
}

TEST_F(Track, WithSigmaNoSpacingIsNeeded) {
  TrackOptions o = options("p_*.csv", {"material"});
  o.threshold = 2 * kThreshold;
  write_sequence("csv", kBodyMotion, 0.1,
                 [](const Particles& p, int) { return csv_text(doubled_block(p.time), true, true); });
  ASSERT_EQ(track(o), 0);
  EXPECT_LT(largest_error("material", kBodyMotion, 0.1 * (kFrames - 1)), 0.03)
      << "as that of the single block";
  o.threshold.reset();
  write_sequence("csv", kBodyMotion, 0.1,
                 [](const Particles& p, int) { return csv_text(lone_particle(p.time), true, true); });
  ASSERT_EQ(track(o), 0);
  // f = (1 - r^2/sigma^2)^3 has the threshold 1/2 at r = sigma sqrt(1 - 2^(-1/3)).
  const double radius = kSigma * std::sqrt(1 - std::cbrt(0.5));
  const auto mesh = surface("material", kFrames - 1);
  for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
    EXPECT_NEAR((Vec3(mesh->GetPoint(v)) - kBodyMotion.position(Vec3::Zero(), 0.1 * (kFrames - 1))).norm(),
                radius, 1e-3 * radius);
}

TEST_F(Track, ADamagedFrameLeavesNothingBehind) {
  write_sequence("vtk", kBodyMotion, 0.1, [](const Particles& p, int k) {
    const std::string text = splishsplash_text(p);
    return k == 4 ? text.substr(0, text.size() / 2) : text;
  });
  const std::string message = message_of<IoError>([&] { track(options("p_*.vtk", {"material"})); });
  EXPECT_TRUE(message.starts_with((folder / "p_10.vtk").string() + ": is damaged or not complete ("))
      << message;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST_F(Track, AFullDiskLeavesTheRunThatWasToBeReplaced) {
  write_sequence("csv", kBodyMotion, 0.1, [](const Particles& p, int) { return csv_text(p, true, true); });
  TrackOptions o = options("p_*.csv", {"material"});
  ASSERT_EQ(track(o), 0);
  fs::copy(folder / "out", folder / "before", fs::copy_options::recursive);
  o.methods = {"regional"};
  {
    const FullDisk full(4096);
    EXPECT_THROW(track(o), IoError);
  }
  for (const auto& entry : fs::recursive_directory_iterator(folder / "out")) {
    const fs::path before = folder / "before" / fs::relative(entry.path(), folder / "out");
    ASSERT_TRUE(fs::exists(before)) << before;
    EXPECT_TRUE(entry.is_directory() || bytes_of(entry.path()) == bytes_of(before)) << before;
  }
  EXPECT_TRUE(fs::exists(folder / "out/surface-material/surface_0005.vtp"));
  ASSERT_EQ(track(o), 0);
  EXPECT_FALSE(fs::exists(folder / "out/surface-material"));
}

}  // namespace
}  // namespace kappaflow
