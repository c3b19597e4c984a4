// Whole sequences tracked, against motions that are known.
#include "tools/runs/track.h"

#include <vtkCell.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <limits>
#include <map>

#include "core/errors.h"
#include "scenes/mesh_file.h"
#include "scenes/scene.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "tests/tools/full_disk.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tests/tools/text_table.h"
#include "tests/vtk_reader.h"
#include "tools/io/vtp_files.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 6;  // at 10 a second: the body moves 0.3 m, 3 of its spacings, and turns 0.67 rad
constexpr double kSigma = 0.2, kThreshold = 2.5;

class Track : public Scratch {
 protected:
  template <class Text>
  void write_sequence(const std::string& ending, const SteadyMotion& motion, double frame_time,
                      const Text& text, int frames = kFrames) {
    for (int k = 0; k < frames; ++k)
      file(fmt::format("p_{}.{}", k + 6, ending),
           text(moved_block(motion, frame_time * k), k));  // to 10 and 11
  }
  TrackOptions options(const std::string& pattern, std::vector<std::string> methods) const {
    TrackOptions o;
    o.inputs = {(folder / pattern).string()};
    o.folder = folder / "out";
    o.methods = std::move(methods);
    o.frames_per_second = 10;
    o.sigma = kSigma;
    o.threshold = kThreshold;
    o.edge_length = 0.5 * kSigma;
    o.force = o.quiet = true;
    return o;
  }
  vtkSmartPointer<vtkPolyData> surface(const std::string& method, int frame) const {
    return read_vtp(folder / "out" / fmt::format("surface-{}/surface_{:04}.vtp", method, frame));
  }
  /// The largest distance of a vertex from where the motion takes its rest position, in sigma. Vertices that
  /// edits of the mesh made have a blend for rest position, and no vote.
  double largest_error(const std::string& method, const SteadyMotion& motion, double time) const {
    const auto mesh = surface(method, kFrames - 1);
    const auto first_vertices = static_cast<double>(surface(method, 0)->GetNumberOfPoints());
    vtkDataArray& rest = *mesh->GetPointData()->GetArray("rest_position");
    vtkDataArray& id = *mesh->GetPointData()->GetArray("id");
    double largest = 0;
    for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v) {
      if (id.GetTuple1(v) >= first_vertices) continue;
      const Vec3 expected = motion.position(Vec3(rest.GetTuple3(v)), time);
      largest = std::max(largest, (Vec3(mesh->GetPoint(v)) - expected).norm());
    }
    return mesh->GetNumberOfPoints() > 200 ? largest / kSigma : 1e9;
  }
};

/// The same tracker in the exact motion, in as many steps as the sequence takes.
TriangleMesh directly_tracked(const std::string& method) {
  const Particles body = moved_block({}, 0);
  const std::size_t n = body.size();
  const FieldParticles at_rest{.position = body.position,
                               .velocity = body.velocity,
                               .sigma = std::vector<double>(n, kSigma),
                               .weight = std::vector<double>(n, 1.0),
                               .weight_rate = std::vector<double>(n, 0.0)};
  constexpr int kStepsAFrame = 3, kSteps = kStepsAFrame * (kFrames - 1);
  const double dt = 0.1 * (kFrames - 1) / kSteps;
  const SurfaceDescription description;
  TrackerOptions options = description.tracker;
  options.method = velocity_method(method).evaluate;
  options.remeshing.edge_length = description.edge_length * kSigma;
  options.topology.follows_field = description.topology;
  RigidParticles start(at_rest, kThreshold, kBodyMotion, 0, dt);
  const std::shared_ptr<const Field> field = start.at(0);
  const TriangleMesh mesh = initial_mesh(*field, description.edge_length * kSigma, {});
  SurfaceTracker tracker(SurfaceTracker::settled(*field, mesh, options), options);
  for (int s = 0; s < kSteps; ++s) {
    RigidParticles motion(at_rest, kThreshold, kBodyMotion, s * dt, (s + 1) * dt);
    tracker.step(motion);
    if ((s + 1) % kStepsAFrame == 0) tracker.settle(*motion.at(motion.t1()));
  }
  return tracker.mesh();
}

/// The largest distance between vertices of the first mesh with the same id, in sigma; infinite where fewer
/// than 90 % of them have a partner.
double largest_difference(vtkPolyData& surface, const TriangleMesh& mesh, vtkIdType first_vertices) {
  vtkDataArray& id = *surface.GetPointData()->GetArray("id");
  std::size_t partners = 0;
  double largest = 0;
  for (vtkIdType v = 0; v < surface.GetNumberOfPoints(); ++v) {
    const auto wanted = static_cast<std::int64_t>(id.GetTuple1(v));
    if (wanted >= first_vertices) continue;  // later ids follow the order of the edits
    const auto found = std::ranges::lower_bound(mesh.id, wanted);
    if (found == mesh.id.end() || *found != wanted) continue;
    ++partners;
    largest = std::max(largest, (Vec3(surface.GetPoint(v)) - mesh.position[found - mesh.id.begin()]).norm());
  }
  const bool enough = static_cast<double>(partners) >= 0.9 * static_cast<double>(first_vertices);
  return enough ? largest / kSigma : std::numeric_limits<double>::infinity();
}

TEST_F(Track, EveryFormatGivesTheMotionOfTheBody) {
  const auto vtp = [&](const Particles& p, int) {
    write_vtp(folder / "particles.vtp",
              *particle_data({p, {}, {}, {}}, std::vector<double>(p.size(), 1), kSigma));
    return bytes_of(folder / "particles.vtp");
  };
  write_sequence("vtp", kBodyMotion, 0.1, vtp);
  write_sequence("vtk", kBodyMotion, 0.1,
                 [](const Particles& p, int k) { return splishsplash_text(permuted(p, k)); });
  write_sequence("dual.vtk", kBodyMotion, 0.1,
                 [](const Particles& p, int k) { return dualsphysics_text(permuted(p, k)); });
  write_sequence("vtu", kBodyMotion, 0.1,
                 [](const Particles& p, int k) { return pysph_text(permuted(p, k)); });
  write_sequence("csv", kBodyMotion, 0.1,
                 [](const Particles& p, int k) { return csv_text(permuted(p, k), true, true); });
  write_sequence("est.csv", kBodyMotion, 0.1,
                 [](const Particles& p, int k) { return csv_text(permuted(p, k), true, false); });
  const std::map<std::string, TriangleMesh> direct{{"material", directly_tracked("material")},
                                                   {"regional", directly_tracked("regional")}};
  for (const std::string ending : {"vtp", "vtk", "dual.vtk", "vtu", "csv", "est.csv"}) {
    ASSERT_EQ(track(options(fmt::format("p_*[0-9].{}", ending), {"material", "regional"})), 0) << ending;
    const bool estimated = ending == "est.csv";  // differences of positions bend the paths a little
    for (const auto& [method, mesh] : direct) {
      const auto last = surface(method, kFrames - 1);
      const vtkIdType first = surface(method, 0)->GetNumberOfPoints();
      EXPECT_LT(largest_difference(*last, mesh, first), estimated ? 0.02 : 2e-3) << ending << " " << method;
      EXPECT_LT(largest_error(method, kBodyMotion, 0.1 * (kFrames - 1)), 0.03) << ending << " " << method;
    }
  }
}

TEST_F(Track, TheSameParticlesInAnotherOrderGiveTheSameBytes) {
  write_sequence("csv", kBodyMotion, 0.1, [](const Particles& p, int) { return csv_text(p, true, true); });
  ASSERT_EQ(track(options("p_*.csv", {"regional"})), 0);
  const std::string straight = bytes_of(folder / "out/surface-regional/surface_0005.vtp");
  write_sequence("csv", kBodyMotion, 0.1,
                 [](const Particles& p, int k) { return csv_text(permuted(p, 9 + k), true, true); });
  ASSERT_EQ(track(options("p_*.csv", {"regional"})), 0);
  EXPECT_EQ(bytes_of(folder / "out/surface-regional/surface_0005.vtp"), straight);
}

TEST_F(Track, SourcesOfTheParticlesStayWithTheVertices) {
  const Particles start = moved_block({}, 0);
  std::vector<int> source;
  for (const Vec3& x : start.position) source.push_back(x.x() + x.y() < 0.1 ? 3 : 8);
  for (int k = 0; k < kFrames; ++k)
    write_vtp(folder / fmt::format("p_{}.vtp", k),
              *particle_data({moved_block(kBodyMotion, 0.1 * k), {}, {}, source}));
  ASSERT_EQ(track(options("p_*.vtp", {"material"})), 0);

  const auto first = surface("material", 0), last = surface("material", kFrames - 1);
  const auto of_vertex = [](vtkPolyData& mesh, const char* array, vtkIdType v) {
    return static_cast<vtkIdType>(mesh.GetPointData()->GetArray(array)->GetTuple1(v));
  };
  std::map<vtkIdType, int> count;
  for (vtkIdType v = 0; v < first->GetNumberOfPoints(); ++v) {
    const auto distance = [&](const Vec3& x) { return (x - Vec3(first->GetPoint(v))).norm(); };
    const auto nearest = std::ranges::min_element(start.position, {}, distance);
    const vtkIdType found = of_vertex(*first, "source", v);
    EXPECT_EQ(found, source[nearest - start.position.begin()]);
    ++count[found];
  }
  EXPECT_EQ(count.size(), 2u);
  int kept = 0;
  for (vtkIdType v = 0; v < last->GetNumberOfPoints(); ++v) {
    const vtkIdType id = of_vertex(*last, "id", v);
    if (id < first->GetNumberOfPoints()) {
      EXPECT_EQ(of_vertex(*last, "source", v), of_vertex(*first, "source", id));
      ++kept;
    }
    EXPECT_EQ(count.count(of_vertex(*last, "source", v)), 1u);
  }
  EXPECT_GT(kept, first->GetNumberOfPoints() / 2);
}

TEST_F(Track, WithoutSourcesThereIsNoSuchArray) {
  write_sequence("csv", kBodyMotion, 0.1, [](const Particles& p, int) { return csv_text(p, true, true); });
  ASSERT_EQ(track(options("p_*.csv", {"material"})), 0);
  EXPECT_EQ(surface("material", 1)->GetPointData()->GetArray("source"), nullptr);
  EXPECT_EQ(read_vtp(folder / "out/particles/particles_0001.vtp")->GetPointData()->GetArray("source"),
            nullptr);
}

TEST_F(Track, PointCloudsAreTrackedByTheirField) {
  const SteadyMotion slow{.velocity = {0.08, 0.04, 0},
                          .angular_velocity = {0, 0, 0.2}};  // up to 0.08 sigma a frame
  write_sequence("csv", slow, 0.1,
                 [](const Particles& p, int k) { return csv_text(permuted(p, k), false, false); });
  TrackOptions o = options("p_*.csv", {});
  o.sigma.reset();
  o.threshold.reset();
  ASSERT_EQ(track(o), 0);
  EXPECT_LT(largest_error("regional", slow, 0.5), 0.12) << "after 0.38 sigma of motion";
  const auto rows = read_table(folder / "out/metrics.csv");
  EXPECT_EQ(rows.back().at("method"), "regional") << "the default where no velocity is known";
  EXPECT_EQ(rows.back().at("slip"), "") << "there is no material velocity to compare with";
  EXPECT_EQ(rows.back().at("penetration_max"), "");

  o.methods = {"material"};
  EXPECT_NE(message_of<InvalidInput>([&] { track(o); }).find("these have neither"), std::string::npos);
}

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

TEST_F(Track, VelocitiesWithoutIdsCarryTheSurfaceToo) {
  write_sequence("csv", kBodyMotion, 0.1,
                 [](const Particles& p, int k) { return csv_text(permuted(p, k), false, true); });
  ASSERT_EQ(track(options("p_*.csv", {})), 0);
  EXPECT_LT(largest_error("material", kBodyMotion, 0.5), 0.05);
}

TEST_F(Track, ParticlesMayAppearAndDisappear) {
  write_sequence("csv", kBodyMotion, 0.1, [](Particles p, int k) {
    const std::size_t gone = 60 + k;  // another one is missing in every frame
    for (auto* ids : {&p.id}) ids->erase(ids->begin() + gone);
    p.position.erase(p.position.begin() + gone);
    p.velocity.erase(p.velocity.begin() + gone);
    return csv_text(p, true, true);
  });
  ASSERT_EQ(track(options("p_*.csv", {"material"})), 0);
  const auto rows = read_table(folder / "out/metrics.csv");
  ASSERT_EQ(rows.size(), 1U * kFrames);
  for (const TextRow& row : rows) {
    EXPECT_EQ(row.at("particles"), "119");
    EXPECT_EQ(row.at("unprojected"), "0");
    EXPECT_LT(std::stod(row.at("residual_max")), 0.01);
  }
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

TEST_F(Track, SPlisHSPlasHFramesEndToEnd) {
  TrackOptions o = options("", {"material", "regional"});
  o.inputs = {KAPPAFLOW_SOURCE_DIR "/tests/data/splishsplash/*.vtk"};
  o.frames_per_second = 25;
  o.sigma.reset();
  o.threshold.reset();
  o.metrics_interval = 1;
  o.formats = {MeshFormat::obj, MeshFormat::ply};
  ASSERT_EQ(track(o), 0);
  const auto rows = read_table(folder / "out/metrics.csv");
  ASSERT_EQ(rows.size(), 6u);
  for (const TextRow& row : rows) {
    const auto number = [&](const char* column) { return std::stod(row.at(column)); };
    EXPECT_EQ(row.at("particles"), "2160");
    EXPECT_EQ(row.at("unprojected"), "0");
    EXPECT_EQ(row.at("components"), row.at("isosurface_components"));
    EXPECT_LT(number("residual_max"), 0.01);
    EXPECT_NEAR(number("volume"), number("isosurface_volume"), 0.02 * number("isosurface_volume"));
    EXPECT_LT(number("slip"), row.at("method") == "material" ? 1e-6 : 0.15);
  }
  // SPlisHSPlasH gives a particle 0.8 of the cube of the spacing that it starts with: at rest the block is
  // that much denser, and the surface lies half a spacing outside the outermost centres at most.
  const double volume = std::stod(rows[0].at("isosurface_volume")), cubes = 2160 * std::pow(0.0635, 3);
  EXPECT_GT(volume, 0.8 * cubes);
  EXPECT_LT(volume, cubes);

  // OBJ and PLY hold the same mesh, with texture coordinates.
  const auto mesh = surface("regional", 2);
  const fs::path stem = folder / "out/surface-regional/surface_0002";
  const auto n = static_cast<std::size_t>(mesh->GetNumberOfPoints());
  const TriangleSurface obj = read_closed_mesh(stem.string() + ".obj", {"test"}).surface,
                        ply = read_closed_mesh(stem.string() + ".ply", {"test"}).surface;
  ASSERT_EQ(obj.vertices.size(), n);
  ASSERT_EQ(ply.vertices.size(), n);
  ASSERT_EQ(obj.triangles.size(), static_cast<std::size_t>(mesh->GetNumberOfPolys()));
  ASSERT_EQ(ply.triangles.size(), obj.triangles.size());
  for (std::size_t t = 0; t < obj.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {  // the reader numbers vertices in its own way
      const Vec3 corner(mesh->GetPoint(mesh->GetCell(static_cast<vtkIdType>(t))->GetPointId(c)));
      EXPECT_LT((obj.vertices[obj.triangles[t][c]] - corner).norm(), 1e-7);
      EXPECT_LT((ply.vertices[ply.triangles[t][c]] - corner).norm(), 1e-6);
    }
  const std::string text = bytes_of(stem.string() + ".obj");
  std::size_t texture = 0, corner_texture = 0;
  for (const std::string& line : split(text, '\n')) {
    texture += line.starts_with("vt ");
    if (!line.starts_with("f ")) continue;
    for (const std::string& corner : split(line.substr(2), ' '))
      corner_texture = std::max(corner_texture, std::stoul(split(corner, '/')[1]));
  }
  EXPECT_EQ(corner_texture, texture) << "those of the vertices, and further ones at the seams";
  EXPECT_GT(texture, n);
  EXPECT_LT(texture, n + n / 4);
  const double* first = mesh->GetPointData()->GetTCoords()->GetTuple2(0);
  EXPECT_NE(text.find(fmt::format("\nvt {:.5}", first[0]).substr(0, 8)), std::string::npos);
}

}  // namespace
}  // namespace kappaflow
