// Runs of the small staircase from end to end.
#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtk_jsoncpp.h>

#include <cmath>
#include <csignal>
#include <map>
#include <set>

#include "core/text_hash.h"
#include "scenes/estimate.h"
#include "tests/tools/everything_scene.h"
#include "tests/tools/program.h"
#include "tests/tools/scratch.h"
#include "tests/tools/text_table.h"
#include "tests/vtk_reader.h"
#include "tools/io/exported_arrays.h"
#include "tools/runs/metrics.h"
#include "tools/runs/run_record.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

const std::string kSmallScene = KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml";
const std::vector<std::string> kMethods{"total", "curvature"};
constexpr int kFrames = 4;  // after the start, in 0.15 s at 25 a second: the last one is no multiple

class Run : public Scratch {
 protected:
  ProgramResult run_small(const std::string& name) const {
    return run_program({"run", kSmallScene, "--out", (folder / name).string(), "--threads", "1", "--duration",
                        "0.15", "--track", "total,curvature"});
  }
};

void expect_finite(vtkPolyData& data) {
  for (int a = 0; a < data.GetPointData()->GetNumberOfArrays(); ++a) {
    vtkDataArray& array = *data.GetPointData()->GetArray(a);
    EXPECT_EQ(array.GetNumberOfTuples(), data.GetNumberOfPoints()) << array.GetName();
    for (int c = 0; c < array.GetNumberOfComponents(); ++c) {
      double range[2];
      array.GetRange(range, c);
      EXPECT_TRUE(std::isfinite(range[0]) && std::isfinite(range[1])) << array.GetName();
    }
  }
}

void expect_files(const fs::path& run) {
  for (int frame = 0; frame <= kFrames; ++frame) {
    const std::string number = "000" + std::to_string(frame) + ".vtp";
    const auto particles = read_vtp(run / "particles" / ("particles_" + number));
    EXPECT_EQ(particles->GetNumberOfPoints(), 1000);
    EXPECT_NE(particles->GetPointData()->GetArray("source"), nullptr);
    expect_finite(*particles);
    for (const std::string& method : kMethods) {
      const auto surface = read_vtp(run / ("surface-" + method) / ("surface_" + number));
      EXPECT_GT(surface->GetNumberOfPolys(), 500);
      expect_finite(*surface);
    }
  }
  EXPECT_GT(read_vtp(run / "boundary.vtp")->GetNumberOfPolys(), 10);
  EXPECT_EQ(bytes_of(run / "run.toml"), bytes_of(kSmallScene));
  for (const char* name : {"run.pvd", "particles.pvd", "surface-total.pvd", "surface-curvature.pvd"})
    EXPECT_NE(bytes_of(run / name).find("timestep=\"0.15\""), std::string::npos) << name;
}

/// docs/outputs.md names every column, array and key that a run leaves.
void expect_documented(const fs::path& run) {
  const std::string page = bytes_of(KAPPAFLOW_SOURCE_DIR "/docs/outputs.md");
  const auto expect_name = [&](const std::string& name) {
    EXPECT_NE(page.find("`" + name + "`"), std::string::npos) << name;
  };
  for (const std::string& header : {metrics_header(), pieces_header(), timings_header()})
    for (const std::string& column : split(header.substr(0, header.size() - 1), ',')) expect_name(column);
  for (const char* file : {"particles/particles_0001.vtp", "surface-total/surface_0001.vtp"}) {
    const auto data = read_vtp(run / file);
    vtkPointData& arrays = *data->GetPointData();
    for (int a = 0; a < arrays.GetNumberOfArrays(); ++a) expect_name(arrays.GetArrayName(a));
  }
  Json::Value record;
  ASSERT_TRUE(Json::Reader().parse(bytes_of(run / "run.json"), record));
  for (const std::string& key : record.getMemberNames()) expect_name(key);
}

void expect_metrics(const fs::path& run) {
  const auto rows = read_table(run / "metrics.csv");
  ASSERT_EQ(rows.size(), (kFrames + 1) * kMethods.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto number = [&](const char* column) { return std::stod(rows[r].at(column)); };
    EXPECT_EQ(rows[r].at("frame"), std::to_string(r / 2));
    EXPECT_EQ(rows[r].at("method"), kMethods[r % 2]);
    for (const auto& [column, cell] : rows[r])
      EXPECT_TRUE(column == "method" || cell.empty() || std::isfinite(std::stod(cell))) << column;
    EXPECT_LT(number("penetration_max"), 0.5);
    EXPECT_LT(number("density_error_mean"), 1e-3);
    EXPECT_LT(number("density_error_max"), 0.05);
    EXPECT_LT(number("residual_max"), 0.01);
    EXPECT_GT(number("quality_min"), 0.1);
    EXPECT_NEAR(number("volume"), number("isosurface_volume"), 0.03 * number("isosurface_volume"));
    EXPECT_EQ(rows[r].at("components"), "1");
    EXPECT_EQ(rows[r].at("genus"), "0");
    EXPECT_EQ(rows[r].at("unprojected"), "0");
    EXPECT_GT(number("kept_fraction"), 0.5);
    EXPECT_GT(number("kept_since_frame"), 0.8);
    EXPECT_LT(number("angles_outside"), 1e-3);
    EXPECT_EQ(rows[r].at("self_intersections"), "0");
    EXPECT_LT(number("surface_without_mesh"), 0.2);
  }
  // The same material moves under both methods; the paper's method follows it better.
  const auto& total = rows[rows.size() - 2];
  const auto& curvature = rows[rows.size() - 1];
  EXPECT_LT(std::stod(curvature.at("slip")), std::stod(total.at("slip")));
  EXPECT_LT(std::stod(curvature.at("tracer_distance")), std::stod(total.at("tracer_distance")));
}

void expect_record(const fs::path& run) {
  Json::Value record;
  ASSERT_TRUE(Json::Reader().parse(bytes_of(run / "run.json"), record));
  EXPECT_EQ(record["scene"]["text"].asString(), bytes_of(kSmallScene));
  EXPECT_EQ(record["scene"]["hash"].asString(), text_hash(bytes_of(kSmallScene)));
  EXPECT_EQ(record["threads"].asInt(), 1);
  EXPECT_EQ(record["particles"].asInt(), 1000);
  EXPECT_EQ(record["texture"].asString(), "box");
  EXPECT_EQ(record["command"][1].asString(), "run");
  EXPECT_EQ(record["options"]["duration"].asDouble(), 0.15);
  EXPECT_EQ(record["methods"].size(), 2u);
  EXPECT_EQ(record["options"]["methods"].size(), 2u);
  EXPECT_GT(record["threshold"].asDouble(), 1);
  EXPECT_NEAR(record["sigma"].asDouble(), 0.16, 1e-12);
  EXPECT_TRUE(record["version"].isString());
}

TEST_F(Run, WritesEverythingAndStaysWithinItsLimits) {
  const ProgramResult result = run_small("one");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "") << "stderr is no terminal: no progress bar";
  EXPECT_NE(result.out.find("paraview " + (folder / "one" / "run.pvd").string()), std::string::npos)
      << result.out;
  expect_files(folder / "one");
  expect_metrics(folder / "one");
  expect_record(folder / "one");
  expect_documented(folder / "one");
  EXPECT_EQ(read_table(folder / "one" / "timings.csv").size(), 2u * (kFrames + 1));
}

// A short run is a part of the scene's, and its surface has not grown yet.
TEST_F(Run, TakesTheMemoryThatWasEstimated) {
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer holds memory of its own";
#endif
  const std::string scene = KAPPAFLOW_SOURCE_DIR "/scenes/staircase.toml";
  const ProgramResult result =
      run_program({"run", scene, "--out", (folder / "r").string(), "--duration", "0.04", "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const double estimated = static_cast<double>(estimate(prepare(load_scene(scene)), 1).memory_bytes),
               taken = static_cast<double>(result.peak_memory);
  EXPECT_LT(taken, 1.1 * estimated);
  EXPECT_GT(taken, 0.5 * estimated);
}

TEST_F(Run, QuietPrintsNothing) {
  const ProgramResult result = run_program({"run", kSmallScene, "--out", (folder / "r").string(),
                                            "--duration", "0.01", "--track", "normal", "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out + result.err, "");
}

TEST_F(Run, InterruptLeavesWholeFrames) {
  const ProgramResult result =
      run_program({"run", kSmallScene, "--out", folder.string(), "--duration", "60", "--track", "total"}, {},
                  {SIGINT, folder / "surface-total" / "surface_0001.vtp"});
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_TRUE(result.err.starts_with("kappaflow: interrupted at t = ")) << result.err;
  const auto rows = read_table(folder / "metrics.csv");
  ASSERT_GE(rows.size(), 2u);
  for (std::size_t frame = 0; frame < rows.size(); ++frame)
    expect_finite(*read_vtp(folder / "surface-total" / ("surface_000" + std::to_string(frame) + ".vtp")));
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    EXPECT_NE(entry.path().extension(), ".tmp");
}

/// Of the array temperature [K].
std::pair<double, double> temperatures_in(const fs::path& file) {
  const auto data = read_vtp(file);
  vtkDataArray* const array = data->GetPointData()->GetArray("temperature");
  EXPECT_NE(array, nullptr) << file;
  double range[2] = {0, 0};
  if (array != nullptr) array->GetRange(range);
  return {range[0], range[1]};
}

TEST_F(Run, TemperaturesReachFilesSurfacesAndMetrics) {
  const fs::path run = folder / "run", track = folder / "track";
  const std::string scene = file("hot.toml", kEverythingScene).string();
  ASSERT_EQ(run_program({"run", scene, "--out", run.string(), "--track", "regional,fresh-particles",
                         "--format", "usd"})
                .exit_code,
            0);
  ASSERT_EQ(run_program({"track", (run / "particles/particles_*.vtp").string(), "--velocity", "regional",
                         "--out", track.string()})
                .exit_code,
            0);
  for (const auto& row : read_table(run / "metrics.csv")) {
    const std::string frame = "000" + row.at("frame") + ".vtp";
    const double least = std::stod(row.at("temperature_min")), mean = std::stod(row.at("temperature_mean")),
                 most = std::stod(row.at("temperature_max"));
    EXPECT_GT(least, 290);
    EXPECT_LT(least, mean);
    EXPECT_LT(mean, most);
    EXPECT_LE(most, 500);
    const auto [coldest, hottest] = temperatures_in(run / "particles" / ("particles_" + frame));
    EXPECT_NEAR(coldest, least, 1e-3);
    EXPECT_NEAR(hottest, most, 1e-3);
    for (const fs::path& surface :
         {run / "surface-regional", run / "surface-fresh-particles", track / "surface-regional"}) {
      const auto [low, high] = temperatures_in(surface / ("surface_" + frame));
      EXPECT_GE(low, least - 1e-3) << surface;
      EXPECT_LE(high, most + 1e-3) << surface;
      EXPECT_GT(high, low + 20) << surface;
    }
  }
  EXPECT_NE(bytes_of(run / "surface-regional/surface.0002.usda").find("primvars:temperature"),
            std::string::npos);
}

/// Mean of the vertices of a wall of boundary_data().
Vec3 middle_of_wall(vtkPolyData& boundary, std::size_t wall) {
  const TriangleSurface surface = exported_walls(boundary).at(wall);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : surface.vertices) sum += x;
  return sum / static_cast<double>(surface.vertices.size());
}

// A ball falls beside the liquid, where nothing holds it: c0 + v0 t - g t^2 / 2, turning at a constant rate.
TEST_F(Run, BodiesFallAsTableWallsAndScenesSay) {
  const std::string scene = file("ball.toml", R"(
duration = 0.1
[fluid]
spacing = 0.05
kinematic_viscosity = 0.1
[[fluid.block]]
shape = "box"
lower = [-0.2, 0, -0.2]
upper = [0.2, 0.2, 0.2]
[[wall]]
shape = "box"
lower = [-2, -0.2, -2]
upper = [2, 0, 2]
[[body]]
shape = "box"
lower = [0.9, 0.9, -0.1]
upper = [1.1, 1.1, 0.1]
density = 3000
velocity = [0.5, 1, 0]
angular_velocity = [0, 0, 5]
[solver]
max_time_step = 0.001
[surface]
methods = ["normal"]
[output]
frames_per_second = 40
)")
                                .string();
  const fs::path run = folder / "run";
  ASSERT_EQ(run_program({"run", scene, "--out", run.string(), "--format", "usd"}).exit_code, 0);
  const std::vector<TextRow> rows = read_table(run / "bodies.csv");
  ASSERT_EQ(rows.size(), 5u);
  for (std::size_t frame = 0; frame < rows.size(); ++frame) {
    const auto number = [&](const char* column) { return std::stod(rows[frame].at(column)); };
    const double t = 0.025 * static_cast<double>(frame);
    EXPECT_EQ(number("frame"), frame);
    EXPECT_NEAR(number("time"), t, 1e-12);
    EXPECT_EQ(rows[frame].at("body"), "0");
    const Vec3 centre(number("x"), number("y"), number("z"));
    EXPECT_NEAR((centre - Vec3(1 + 0.5 * t, 1 + t - 0.5 * 9.81 * t * t, 0)).norm(), 0,
                1e-9 + 9.81 * t * 0.001);
    EXPECT_NEAR(number("vy"), 1 - 9.81 * t, 1e-6);
    EXPECT_NEAR(number("wz"), 5, 1e-6);
    EXPECT_NEAR(number("qz"), std::sin(2.5 * t), 1e-5);
    EXPECT_NEAR(number("qw"), std::cos(2.5 * t), 1e-5);
    const auto walls = read_vtp(run / fmt::format("boundary/boundary_{:04}.vtp", frame));
    EXPECT_NEAR((middle_of_wall(*walls, 1) - centre).norm(), 0, 1e-6);
    EXPECT_NEAR((middle_of_wall(*walls, 0) - Vec3(0, -0.1, 0)).norm(), 0, 1e-6);
    EXPECT_NE(bytes_of(run / fmt::format("boundary/boundary.{:04}.usda", frame)).find("wall_1"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace kappaflow
