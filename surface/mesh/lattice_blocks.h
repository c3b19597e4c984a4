// The parts of a lattice that a surface is in: what is far from it costs nothing.
#pragma once

#include <span>
#include <vector>

#include "surface/mesh/isosurface.h"

namespace kappaflow {

/// A cube of a lattice, kCubeCells cells wide, numbered from the lattice's first point.
using LatticeCube = std::array<int, 3>;
inline constexpr int kCubeCells = 32;

/// The number of points of the blocks, those that several share as often; 2^53 and more are rounded.
double points_in(std::span<const LatticeBlock> blocks);

/// All of the lattice's points.
LatticeBlock whole(const SampledField& lattice);

/// Makes samples of a lattice those at the points of the block; their values are not touched.
void restrict_to(const LatticeBlock& block, SampledField& samples);

/// The cubes that triangles reach into, or come within `reach` and a hundredth of a cell of.
std::vector<LatticeCube> cubes_of(const SampledField& lattice, std::span<const Vec3> position,
                                  std::span<const Triangle> triangles, double reach = 0);

/// The cubes as blocks of points, ascending by z, y, x: neighbours share the points of their sides. The whole
/// lattice, as one, where that has at most twice the points. Throws InvalidInput for more than 2^31 points.
std::vector<LatticeBlock> blocks_of(const SampledField& lattice, std::vector<LatticeCube> cubes);

/// The same of the cubes in which f may be positive, and some others.
std::vector<LatticeBlock> occupied_blocks(const Field& field, const SampledField& lattice,
                                          std::vector<LatticeCube> others = {});

/// Of each block the triangles, by number, that come within `reach` cells of it, and some more; ascending.
std::vector<std::vector<int>> triangles_near(const SampledField& lattice, std::span<const Vec3> position,
                                             std::span<const Triangle> triangles,
                                             std::span<const LatticeBlock> blocks, double reach);

}  // namespace kappaflow
