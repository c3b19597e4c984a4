// The particles of a frame that lie near the liquid's surface, read piece by piece.
#pragma once

#include <filesystem>
#include <span>

#include "solver/ranks.h"
#include "tools/io/input_frame.h"

namespace kappaflow {

/// Reads a frame twice, and keeps of its particles
///   those of the zones surface, middle and inner (see LiquidDepth): each of them;
///   of those in the depth one for each cube, which stands for the others there: the one nearest to its
///   middle; those whose ids are among `before` (ascending), the frame's before: to end where they went.
/// InputFrame::zone says which is which. Where particles are scattered so widely that none is deep, it is all
/// of them. sigma: support radius of the field [m]. Throws what read_input_frame() throws.
InputFrame read_near_surface(std::span<const std::filesystem::path> files, double sigma,
                             std::span<const std::int64_t> before);

/// The same of a liquid at hand, of which `own` may be the part of one of several ranks: all of them call it,
/// and the first gets what is kept of all, the others nothing. fast_speed is 0.
InputFrame near_surface_of(InputFrame own, double sigma, Ranks* ranks);

/// How many times the support radius of the others a particle has that stands for a cube.
double scale_of(Zone zone);

/// What a frame's files hold, of which nothing is kept.
struct FrameContent {
  std::size_t particles = 0;
  bool has_ids = false, has_velocities = false, has_several_radii = false;
};
FrameContent content_of(std::span<const std::filesystem::path> files);

/// The spacing of a frame's particles [m], to 10 %: from 20 thousand of each piece that lie together, and
/// from the sum of kernels inside.
double rough_spacing(std::span<const std::filesystem::path> files);

}  // namespace kappaflow
