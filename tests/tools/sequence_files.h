// A body in a known motion, as the files of several simulators; written byte by byte, without VTK.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/particles.h"
#include "surface/field/rigid_particles.h"

namespace kappaflow {

constexpr double kBodySpacing = 0.1;  // [m]

/// A jittered block of particles about the origin, 6 x 5 x 4.
inline std::vector<Vec3> jittered_block() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> jitter(-0.1 * kBodySpacing, 0.1 * kBodySpacing);
  std::vector<Vec3> position;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 6; ++i)
        position.push_back(kBodySpacing * Vec3(i - 2.5, j - 2, k - 1.5) +
                           Vec3(jitter(random), jitter(random), jitter(random)));
  return position;
}

inline const SteadyMotion kBodyMotion{.velocity = {0.5, 0.25, -0.125}, .angular_velocity = {0.5, 1, -0.75}};

/// The block where the motion has taken it at `time`; ids are 5, 8, 11, ...
inline Particles moved_block(const SteadyMotion& motion, double time) {
  Particles particles;
  particles.time = time;
  const Mat3 R = motion.rotation(time);
  for (const Vec3& x0 : jittered_block()) {
    particles.id.push_back(5 + 3 * static_cast<std::int64_t>(particles.id.size()));
    particles.position.push_back(motion.position(x0, time));
    particles.velocity.push_back(motion.velocity + motion.angular_velocity.cross(R * x0));
  }
  return particles;
}

/// The same particles in a random order, another one for every seed.
inline Particles permuted(const Particles& particles, unsigned seed) {
  std::vector<std::size_t> order(particles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  Particles result;
  result.time = particles.time;
  for (const std::size_t i : order) {
    result.id.push_back(particles.id[i]);
    result.position.push_back(particles.position[i]);
    result.velocity.push_back(particles.velocity[i]);
  }
  return result;
}

template <class Number>
std::string big_endian(Number number) {
  std::string bytes(sizeof number, 0);
  std::memcpy(bytes.data(), &number, sizeof number);
  if constexpr (std::endian::native == std::endian::little) std::ranges::reverse(bytes);
  return bytes;
}

inline std::string big_endian_floats(const std::vector<Vec3>& vectors) {
  std::string bytes;
  for (const Vec3& v : vectors)
    for (const double c : v) bytes += big_endian(static_cast<float>(c));
  return bytes;
}

/// As SPlisHSPlasH's exporter writes it.
inline std::string splishsplash_text(const Particles& p) {
  const std::size_t n = p.size();
  std::string cells, types, ids, density;
  for (std::size_t i = 0; i < n; ++i) {
    cells += big_endian<std::int32_t>(1) + big_endian(static_cast<std::int32_t>(i));
    types += big_endian<std::int32_t>(1);
    ids += big_endian(static_cast<std::uint32_t>(p.id[i]));
    density += big_endian(1000.0F);
  }
  return fmt::format(
             "# vtk DataFile Version 4.1\nSPlisHSPlasH particle data\nBINARY\nDATASET UNSTRUCTURED_GRID\n"
             "POINTS {} float\n",
             n) +
         big_endian_floats(p.position) + fmt::format("\nCELLS {} {}\n", n, 2 * n) + cells +
         fmt::format("\nCELL_TYPES {}\n", n) + types +
         fmt::format("\nPOINT_DATA {}\nSCALARS id unsigned_int 1\nLOOKUP_TABLE id_table\n", n) + ids +
         fmt::format("\nFIELD FieldData 2\nvelocity 3 {} float\n", n) + big_endian_floats(p.velocity) +
         fmt::format("\ndensity 1 {} float\n", n) + density + "\n";
}

/// As DualSPHysics' PartVTK writes it, with two particles of a wall in front.
inline std::string dualsphysics_text(const Particles& p) {
  std::vector<Vec3> position{{9, 9, 9}, {9, 9, 8}}, velocity{Vec3::Zero(), Vec3::Zero()};
  position.insert(position.end(), p.position.begin(), p.position.end());
  velocity.insert(velocity.end(), p.velocity.begin(), p.velocity.end());
  const std::size_t n = position.size();
  std::string vertices, ids, types, density;
  for (std::size_t i = 0; i < n; ++i) {
    vertices += big_endian<std::int32_t>(1) + big_endian(static_cast<std::int32_t>(i));
    ids += big_endian(static_cast<std::uint32_t>(i < 2 ? i : p.id[i - 2]));
    types += static_cast<char>(i < 2 ? 0 : 3);
    density += big_endian(1000.0F);
  }
  return fmt::format("# vtk DataFile Version 3.0\nPartVTK\nBINARY\nDATASET POLYDATA\nPOINTS {} float\n", n) +
         big_endian_floats(position) + fmt::format("\nVERTICES {} {}\n", n, 2 * n) + vertices +
         fmt::format("\nPOINT_DATA {}\nSCALARS Idp unsigned_int\nLOOKUP_TABLE default\n", n) + ids +
         "\nVECTORS Vel float\n" + big_endian_floats(velocity) +
         "\nSCALARS Rhop float\nLOOKUP_TABLE default\n" + density +
         "\nSCALARS Type unsigned_char\nLOOKUP_TABLE default\n" + types + "\n";
}

/// As PySPH's dump_vtk writes it; the last particle is a ghost.
inline std::string pysph_text(const Particles& p) {
  const std::size_t n = p.size() + 1;
  std::string points, u, v, w, gid, tag, connectivity, offsets, types;
  for (std::size_t i = 0; i < n; ++i) {
    const bool ghost = i == p.size();
    const Vec3 x = ghost ? Vec3(9, 9, 9) : p.position[i], velocity = ghost ? Vec3::Zero() : p.velocity[i];
    points += fmt::format("{:.17g} {:.17g} {:.17g} ", x[0], x[1], x[2]);
    u += fmt::format("{:.17g} ", velocity[0]);
    v += fmt::format("{:.17g} ", velocity[1]);
    w += fmt::format("{:.17g} ", velocity[2]);
    gid += fmt::format("{} ", ghost ? 0 : p.id[i]);
    tag += ghost ? "2 " : "0 ";
    connectivity += fmt::format("{} ", i);
    offsets += fmt::format("{} ", i + 1);
    types += "1 ";
  }
  const auto array = [](const std::string& type, const std::string& name, const std::string& values) {
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"ascii\">{}</DataArray>\n", type, name,
                       values);
  };
  return fmt::format(
             "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
             "byte_order=\"LittleEndian\">\n<UnstructuredGrid><Piece NumberOfPoints=\"{0}\" "
             "NumberOfCells=\"{0}\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
             "format=\"ascii\">{1}</DataArray></Points>\n<Cells>\n",
             n, points) +
         array("Int32", "connectivity", connectivity) + array("Int32", "offsets", offsets) +
         array("UInt8", "types", types) + "</Cells>\n<PointData>\n" + array("Float64", "u", u) +
         array("Float64", "v", v) + array("Float64", "w", w) + array("UInt32", "gid", gid) +
         array("Int32", "tag", tag) + "</PointData>\n</Piece></UnstructuredGrid>\n</VTKFile>\n";
}

/// CSV with the columns that are asked for.
inline std::string csv_text(const Particles& p, bool ids, bool velocities) {
  std::string text = fmt::format("{}x,y,z{}\n", ids ? "id," : "", velocities ? ",vx,vy,vz" : "");
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 &x = p.position[i], &v = p.velocity[i];
    if (ids) text += fmt::format("{},", p.id[i]);
    text += fmt::format("{:.17g},{:.17g},{:.17g}", x[0], x[1], x[2]);
    if (velocities) text += fmt::format(",{:.17g},{:.17g},{:.17g}", v[0], v[1], v[2]);
    text += '\n';
  }
  return text;
}

}  // namespace kappaflow
