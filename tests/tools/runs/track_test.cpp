// Whole sequences tracked, against motions that are known.
#include <vtkCell.h>

#include <algorithm>
#include <limits>
#include <map>

#include "core/errors.h"
#include "scenes/mesh_file.h"
#include "scenes/scene.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "tests/tools/runs/track_case.h"
#include "tests/tools/text_table.h"
#include "tools/io/vtp_files.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// The same tracker in the exact motion, in as many steps as the sequence takes.
TriangleMesh directly_tracked(const std::string& method) {
  const Particles body = moved_block({}, 0);
  const std::size_t n = body.size();
  const FieldParticles at_rest{.position = body.position,
                               .velocity = body.velocity,
                               .sigma = std::vector<double>(n, kSigma),
                               .weight = std::vector<double>(n, 1.0),
                               .weight_rate = std::vector<double>(n, 0.0)};
  constexpr int kStepsAFrame = 1, kSteps = kStepsAFrame * (kFrames - 1);
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
