// A body in a known motion, as images of its distance and as meshes that another program might write.
#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <string>

#include "surface/field/distance_field.h"
#include "surface/remesh/initial_mesh.h"
#include "tests/tools/sequence_files.h"
#include "tools/io/image_file.h"

namespace kappaflow {

/// A box with round edges, 0.8 x 0.6 x 0.4 m, that turns about the z axis by one radian a second and moves.
struct TurningBox {
  static constexpr double kSpin = 1;
  static constexpr double kVolume = 0.1618;  ///< [m3], by Steiner's formula
  static Vec3 centre(double time) { return Vec3(0.2, -0.1, 0.15) * time; }
  static Vec3 position(const Vec3& start, double time) {
    return centre(time) + Eigen::AngleAxisd(kSpin * time, Vec3::UnitZ()) * start;
  }
  static Vec3 velocity(const Vec3& x, double time) {
    return centre(1) + kSpin * Vec3::UnitZ().cross(x - centre(time));
  }
  static double distance(const Vec3& x, double time) {
    const Vec3 y = Eigen::AngleAxisd(-kSpin * time, Vec3::UnitZ()) * (x - centre(time));
    const Vec3 beyond = y.cwiseAbs() - Vec3(0.25, 0.15, 0.05);
    return beyond.cwiseMax(0).norm() + std::min(beyond.maxCoeff(), 0.0) - 0.15;
  }
};

/// On 28 x 28 x 20 points, 0.05 m apart.
inline SignedDistances image_of_box(double time, bool with_velocities) {
  SignedDistances image{
      .grid = {.origin = {-0.65, -0.65, -0.45}, .spacing = Vec3::Constant(0.05), .dims = {28, 28, 20}},
      .value = {}};
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) {
        const Vec3 x = image.grid.point(i, j, k);
        image.value.push_back(static_cast<float>(TurningBox::distance(x, time)));
        if (with_velocities) image.velocity.push_back(TurningBox::velocity(x, time).cast<float>());
      }
  return image;
}

inline std::string vti_of(const SignedDistances& image, double time) {
  const RegularGrid& grid = image.grid;
  const auto array = [](const char* name, int components, const std::string& numbers) {
    return fmt::format(
        "<DataArray type=\"Float32\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">{}</DataArray>\n",
        name, components, numbers);
  };
  std::string arrays = array("phi", 1, fmt::format("{}", fmt::join(image.value, " ")));
  if (!image.velocity.empty()) {
    std::string numbers;
    for (const Eigen::Vector3f& v : image.velocity) numbers += fmt::format("{} {} {} ", v.x(), v.y(), v.z());
    arrays += array("velocity", 3, numbers);
  }
  const std::string extent =
      fmt::format("0 {} 0 {} 0 {}", grid.dims[0] - 1, grid.dims[1] - 1, grid.dims[2] - 1);
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<ImageData WholeExtent=\"{0}\" Origin=\"{1} {2} {3}\" Spacing=\"{4} {5} {6}\">\n"
      "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{7}</DataArray></FieldData>\n"
      "<Piece Extent=\"{0}\"><PointData>{8}</PointData></Piece></ImageData>\n</VTKFile>\n",
      extent, grid.origin.x(), grid.origin.y(), grid.origin.z(), grid.spacing.x(), grid.spacing.y(),
      grid.spacing.z(), time, arrays);
}

/// The same in legacy VTK, in binary.
inline std::string vtk_of(const SignedDistances& image, double time) {
  const RegularGrid& grid = image.grid;
  const auto triple = [](const char* name, const auto& xyz) {
    return fmt::format("{} {} {} {}\n", name, xyz[0], xyz[1], xyz[2]);
  };
  std::string text =
      "# vtk DataFile Version 3.0\nbox\nBINARY\nDATASET STRUCTURED_POINTS\n" +
      triple("DIMENSIONS", grid.dims) + triple("ORIGIN", grid.origin) + triple("SPACING", grid.spacing) +
      "FIELD FieldData 1\nTimeValue 1 1 double\n" + big_endian(time) +
      fmt::format("\nPOINT_DATA {}\nSCALARS phi float\nLOOKUP_TABLE default\n", image.value.size());
  for (const float d : image.value) text += big_endian(d);
  if (!image.velocity.empty()) text += "\nVECTORS velocity float\n";
  for (const Eigen::Vector3f& v : image.velocity)
    for (const float c : v) text += big_endian(c);
  return text + "\n";
}

/// An image of its distances as an OpenVDB file holds it, where the points of the grid may be any.
inline ImageFrame frame_of_box(double time) {
  SignedDistances image = image_of_box(time, false);
  return {.dims = image.grid.dims,
          .origin = image.grid.origin,
          .spacing = image.grid.spacing,
          .value = std::move(image.value),
          .time = time};
}

/// A closed mesh of the body whose vertices have nothing to do with those of other instants. edge: of its
/// triangles where it is flat [m].
inline std::string obj_of_box(double time, double edge = 0.02) {
  const auto image = [](double t) { return std::make_shared<DistanceImage>(image_of_box(t, false), t); };
  DistanceMotion motion(image(time), image(time + 1));
  const TriangleMesh mesh = initial_mesh(*motion.at(time), edge, {});
  std::string text;
  for (const Vec3& x : mesh.position) text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", x.x(), x.y(), x.z());
  for (const Triangle& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

}  // namespace kappaflow
