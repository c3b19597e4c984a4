#include "tools/commands/probe.h"

#include <map>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tools/io/vtp_files.h"

namespace kappaflow {
namespace {

class Probe : public Scratch {
 protected:
  /// The columns of each row by name.
  std::vector<std::map<std::string, double>> table(const ProbeOptions& options) const {
    const std::vector<std::string> lines = split(probe(options), '\n');
    const std::vector<std::string> names = split(lines.at(0), ',');
    std::vector<std::map<std::string, double>> rows;
    for (std::size_t l = 1; l < lines.size(); ++l) {
      const std::vector<std::string> cells = split(lines[l], ',');
      EXPECT_EQ(cells.size(), names.size());
      auto& row = rows.emplace_back();
      for (std::size_t c = 0; c < names.size(); ++c) row[names[c]] = std::stod(cells.at(c));
    }
    return rows;
  }
};

// One particle, w = 2, sigma = 2, v = (1, 0, 0) at the origin, probed at (1, 0, 0): with s = x^2/4,
// f = 2 (1 - s)^3 - T, and its surface there is a sphere about the origin.
TEST_F(Probe, OneParticleExactly) {
  const auto particles = file("particles.csv", "x,y,z,vx,vy,vz,weight,sigma\n0,0,0,1,0,0,2,2\n");
  const auto points = file("points.csv", "x,y,z\n1,0,0\n");
  const auto rows = table({particles, points, 0.5, {"normal", "total", "curvature"}});
  ASSERT_EQ(rows.size(), 1u);
  auto row = rows[0];
  const double u = 0.75;                                              // 1 - s
  const double k = 0.5, w = 2, p1 = -3 * u * u, p2 = 6 * u, p3 = -6;  // phi', phi'', phi'''; s_a = k x_a
  const std::map<std::string, double> expected{
      {"x", 1},
      {"y", 0},
      {"z", 0},
      {"f", w * u * u * u - 0.5},
      {"f_x", w * p1 * k},
      {"f_y", 0},
      {"f_z", 0},
      {"f_xx", w * (p2 * k * k + p1 * k)},
      {"f_yy", w * p1 * k},
      {"f_zz", w * p1 * k},
      {"f_xy", 0},
      {"f_xz", 0},
      {"f_yz", 0},
      {"f_xxx", w * (p3 * k * k * k + 3 * p2 * k * k)},
      {"f_xyy", w * p2 * k * k},
      {"f_xzz", w * p2 * k * k},
      {"f_xxy", 0},
      {"f_xxz", 0},
      {"f_xyz", 0},
      {"f_yyy", 0},
      {"f_yyz", 0},
      {"f_yzz", 0},
      {"f_zzz", 0},
      // A rigid translation: every rate is minus the derivative along v.
      {"f_t", -w * p1 * k},
      {"f_xt", -w * (p2 * k * k + p1 * k)},
      {"f_yt", 0},
      {"f_zt", 0},
      {"f_xxt", -w * (p3 * k * k * k + 3 * p2 * k * k)},
      {"f_yyt", -w * p2 * k * k},
      {"f_zzt", -w * p2 * k * k},
      {"f_xyt", 0},
      {"f_xzt", 0},
      {"f_yzt", 0},
      {"K", 1},
      {"H", 1},
      {"K_x", -2},
      {"K_y", 0},
      {"K_z", 0},
      {"H_x", -1},
      {"H_y", 0},
      {"H_z", 0},
      {"K_t", 2},
      {"H_t", 1}};
  for (const auto& [name, value] : expected)
    EXPECT_NEAR(row.at(name), value, 4e-15 * std::max(1.0, std::abs(value))) << name;
  EXPECT_EQ(row.size(), expected.size() + 3 * 4);
  for (const std::string method : {"normal", "total", "curvature"}) {
    EXPECT_NEAR(row.at("v_" + method + "_x"), 1, 1e-14)
        << method;  // the normal component is the whole velocity
    EXPECT_NEAR(row.at("v_" + method + "_y"), 0, 1e-14);
    EXPECT_GE(row.at("confidence_" + method), 0);
  }
}

TEST_F(Probe, CsvAndVtpAgree) {
  const auto csv =
      file("a.csv", "x,y,z,vx,vy,vz,weight,sigma\n0,0.125,0,1,0.5,0,1,0.75\n0.25,0,0.5,0,-1,0.25,0.5,0.75\n");
  const Particles particles{0, {0, 1}, {{0, 0.125, 0}, {0.25, 0, 0.5}}, {{1, 0.5, 0}, {0, -1, 0.25}}};
  const std::vector<float> none(2, 0);
  const std::vector<double> weight{1, 0.5};
  write_vtp(folder / "a.vtp", *particle_data({particles, none, none, {}}, weight, 0.75));
  const auto points = file("points.csv", "x,y,z\n0.1,0.2,0.3\n0.3,0.1,0.2\n");
  EXPECT_EQ(probe({csv, points, 0.1, {"material"}}), probe({folder / "a.vtp", points, 0.1, {"material"}}));
}

TEST_F(Probe, OutOfReachHasNoCurvature) {
  const auto particles = file("particles.csv", "x,y,z,vx,vy,vz,weight,sigma\n0,0,0,1,0,0,1,1\n");
  auto row = table({particles, file("points.csv", "x,y,z\n5,0,0\n"), 0.5, {"total"}}).at(0);
  EXPECT_EQ(row.at("f"), -0.5);
  EXPECT_TRUE(std::isnan(row.at("K")));
  EXPECT_TRUE(std::isnan(row.at("H_t")));
  EXPECT_EQ(row.at("v_total_x"), 0);
}

TEST_F(Probe, WrongFilesAreSaidInOneLine) {
  const auto points = file("points.csv", "x,y,z\n0,0,0\n");
  const auto odd = file("particles.txt", "");
  EXPECT_EQ(message_of<InvalidInput>([&] {
              probe({odd, points, 1, {}});
            }),
            odd.string() + ": unknown kind of particle file; expected .vtp or .csv");
  write_vtp(folder / "bare.vtp", *boundary_data(std::vector<TriangleSurface>{{{{0, 0, 0}}, {}}}));
  EXPECT_EQ(
      message_of<InvalidInput>([&] {
        probe({folder / "bare.vtp", points, 1, {}});
      }),
      (folder / "bare.vtp").string() +
          ": no point array \"velocity\" with 3 components; expected velocity (3), weight (1), sigma (1)");
  const auto negative = file("negative.csv", "x,y,z,vx,vy,vz,weight,sigma\n0,0,0,1,0,0,1,-1\n");
  EXPECT_THROW(probe({negative, points, 1, {}}), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
