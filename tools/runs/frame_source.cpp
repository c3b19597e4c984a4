#include "tools/runs/frame_source.h"

namespace kappaflow {

FieldMeasures FrameSource::measure_field(bool is_judged, std::span<const Vec3> particles) {
  const SurfaceGroup& of = surfaces();
  FieldMeasures measures{.particles_outside = points_outside(of.field(), particles), .isosurface = {}};
  if (is_judged) measures.isosurface = fresh_isosurface(of.field(), of.length_scale());
  return measures;
}

SurfaceMeasures FrameSource::measure_surface(std::size_t surface, const FieldMeasures& field) {
  const SurfaceGroup& of = surfaces();
  SurfaceMeasures measures{.state = of.state(surface), .judgement = {}};
  if (field.isosurface)
    measures.judgement = judge_surface(of.field(), field.isosurface->mesh, of.mesh(surface));
  return measures;
}

}  // namespace kappaflow
