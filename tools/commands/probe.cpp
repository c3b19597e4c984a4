#include "tools/commands/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/errors.h"
#include "surface/field/curvature.h"
#include "surface/field/particle_motion.h"
#include "surface/motion/velocity_methods.h"
#include "tools/io/number_table.h"
#include "tools/io/particle_file.h"

namespace kappaflow {
namespace {

constexpr const char* kFieldHeader =
    "x,y,z,f,f_x,f_y,f_z,f_xx,f_xy,f_xz,f_yy,f_yz,f_zz,"
    "f_xxx,f_xxy,f_xxz,f_xyy,f_xyz,f_xzz,f_yyy,f_yyz,f_yzz,f_zzz,"
    "f_t,f_xt,f_yt,f_zt,f_xxt,f_xyt,f_xzt,f_yyt,f_yzt,f_zzt,"
    "K,H,K_x,K_y,K_z,H_x,H_y,H_z,K_t,H_t";

std::vector<Vec3> read_points(const std::filesystem::path& file) {
  std::vector<Vec3> points;
  for (const std::vector<double>& row : read_number_table(file, "x,y,z"))
    points.emplace_back(row[0], row[1], row[2]);
  return points;
}

void append(std::string& line, double value) {
  fmt::format_to(std::back_inserter(line), "{}{:.17g}", line.empty() ? "" : ",", value);
}
void append(std::string& line, const Vec3& v) {
  for (int a = 0; a < 3; ++a) append(line, v[a]);
}
void append_upper(std::string& line, const Mat3& m) {
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) append(line, m(a, b));
}

CurvatureJet curvature_or_nan(const Jet& jet) {
  if (jet.g != Vec3::Zero()) return curvature_jet(jet);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3 nans = Vec3::Constant(nan);
  return {nan, nan, nans, nans, nan, nan};
}

std::string field_columns(const Field& field, const Vec3& x) {
  const Jet jet = field.jet(x);
  const ThirdDerivatives& C = jet.C;
  std::string line;
  append(line, x);
  append(line, jet.f);
  append(line, jet.g);
  append_upper(line, jet.A);
  for (const double c : {C.xxx, C.xxy, C.xxz, C.xyy, C.xyz, C.xzz, C.yyy, C.yyz, C.yzz, C.zzz})
    append(line, c);
  append(line, jet.f_t);
  append(line, jet.g_t);
  append_upper(line, jet.A_t);
  const CurvatureJet curvature = curvature_or_nan(jet);
  append(line, curvature.K);
  append(line, curvature.H);
  append(line, curvature.grad_K);
  append(line, curvature.grad_H);
  append(line, curvature.K_t);
  append(line, curvature.H_t);
  return line;
}

SurfaceVelocities velocities(const Field& field, const std::string& method, std::span<const Vec3> points) {
  const std::vector<double> area(points.size(), 0);
  const VertexRings no_neighbours{std::vector<int>(points.size() + 1, 0), {}};
  SurfaceVelocities result;
  velocity_method(method).evaluate(field, {points, area, no_neighbours}, {}, result.sized(points.size()));
  return result;
}

}  // namespace

std::string probe(const ProbeOptions& options) {
  const std::shared_ptr<const Field> held =
      particle_field(read_particle_file(options.particles), options.kernels, options.threshold, 0);
  const Field& field = *held;
  const std::vector<Vec3> points = read_points(options.points);
  std::string header = kFieldHeader;
  std::vector<SurfaceVelocities> motions;
  for (const std::string& method : options.methods) {
    header += fmt::format(",v_{0}_x,v_{0}_y,v_{0}_z,confidence_{0}", method);
    motions.push_back(velocities(field, method, points));
  }
  std::string table = header + "\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::string line = field_columns(field, points[i]);
    for (const SurfaceVelocities& motion : motions) {
      append(line, motion.velocity[i]);
      append(line, motion.confidence[i]);
    }
    table += line + "\n";
  }
  return table;
}

}  // namespace kappaflow
