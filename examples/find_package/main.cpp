// Two drops meet and become one. Their surface is tracked from frame to frame; ParaView opens drops.pvd.
#include <kappaflow/core/errors.h>
#include <kappaflow/io/files.h>
#include <kappaflow/io/pvd.h>
#include <kappaflow/io/vtp_files.h>
#include <kappaflow/surface/tracker/tracked_surfaces.h>

#include <cstdio>

using namespace kappaflow;

/// What a simulation hands over at one instant: ids, positions and velocities.
Particles two_drops(double time) {
  Particles drops{time, {}, {}, {}};
  for (int k = 0; k < 2 * 729; ++k) {
    const Vec3 x = 0.1 * Vec3(k % 9 - 4, k / 9 % 9 - 4, k / 81 % 9 - 4), side(k < 729 ? -1 : 1, 0, 0);
    if (x.norm() > 0.4) continue;
    drops.id.push_back(k);
    drops.position.push_back(x + (0.7 - 0.5 * time) * side);
    drops.velocity.push_back(-0.5 * side);
  }
  return drops;
}

int main() try {
  TrackedSurfaces surface(two_drops(0));
  std::vector<PvdEntry> series;
  for (int frame = 0; frame <= 20; ++frame) {
    if (frame > 0) surface.advance(two_drops(0.04 * frame));
    const std::string file = "drops_" + std::to_string(frame) + ".vtp";
    write_vtp(file, *surface_data({surface.time(), surface.mesh(), surface.state()}));
    series.push_back({surface.time(), 0, "drops", file});
  }
  write_file("drops.pvd", pvd_text(series));
  std::printf("%zu vertices after %g s\n", surface.mesh().vertex_count(), surface.time());
} catch (const Error& error) {
  std::fprintf(stderr, "drops: error: %s\n", error.what());
  return error.exit_code();
}
