// What is measured of the surfaces in Enright's test, and the tables, files and pictures of it.
#pragma once

#include <string>
#include <vector>

#include "surface/measure/surface_state.h"
#include "surface/tracker/surface_tracker.h"
#include "tools/experiments/enright_body.h"
#include "tools/experiments/experiment.h"

namespace kappaflow {

/// A tracked mesh at one time.
struct EnrightSample {
  TriangleMesh mesh;
  SurfaceState state;
  ShapeError shape;
  VertexError vertex;
  double volume = 0;  ///< [m3]
  double mean_quality = 0, smallest_angle = 0, folded = 0;
  std::size_t unprojected = 0, self_intersections = 0;
};

/// One tracked surface over the whole test.
struct EnrightResult {
  std::string method;      ///< with "remeshed" or "anchored" and the edge length [m] where it is
  std::string velocity;    ///< the method's own name
  double edge_length = 0;  ///< [m]; 0: its connectivity is kept
  bool anchored = false;   ///< the particles correct its rest positions after each step
  std::size_t start_triangles = 0;
  double start_volume = 0;  ///< of the start mesh [m3]
  EnrightSample half, end;
  double seconds = 0;  ///< wall time, the fields that all share included
};

/// Of the tracked mesh, which the field at the shape's time is on.
EnrightSample measure(const SurfaceTracker& tracker, const Field& field, const EnrightShape& shape);

/// Two rows a result: at half time and at the end.
Table result_table(const std::vector<EnrightResult>& results);

/// Writes enright.csv; and the meshes as RESULT_half.vtp and RESULT_end.vtp with a picture of each time,
/// which the report then has.
void write_results(const std::vector<EnrightResult>& results, const ExperimentContext& context,
                   Report& report);

}  // namespace kappaflow
