// The surfaces of a run as a page holds them: as whole numbers across ranges that all frames share.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <optional>
#include <string>
#include <vector>

#include "surface/field/field.h"
#include "surface/measure/texture.h"
#include "tools/pictures/colouring.h"
#include "tools/pictures/emission.h"
#include "tools/pictures/framing.h"
#include "tools/pictures/run_frames.h"
#include "tools/pictures/surface_packer.h"

namespace kappaflow {

/// What the frames and methods of a run have in common.
struct PageRanges {
  Bounds box, rest;  ///< around all positions and rest positions [m]
  Checker checker;
  std::vector<double> times;              ///< of the frames [s]
  std::vector<Framing> framing;           ///< of the frames, as a camera follows them in the run's view
  std::optional<EmissionTimes> emission;  ///< of a run that liquid flows into
  std::vector<Colouring>
      colours;  ///< of slip, curvature, confidence and emission those that all surfaces have
};

/// Reads all surfaces. Throws InvalidInput, IoError.
PageRanges page_ranges(const RunFrames& frames);

/// A surface with all that the page shows of it. Throws IoError.
vtkSmartPointer<vtkPolyData> page_surface(const RunFrames& frames, const PageRanges& ranges,
                                          const std::string& method, int frame);

/// What walls and surfaces are drawn from: 0 at the box's lower faces, 65535 at its upper ones.
std::uint16_t quantised(double x, double lower, double upper);

/// Components: 3 of the position and 3 of the rest position with 2 bytes; with 1 byte 2 of the normal, which
/// is on the octahedron abs(x) + abs(y) + abs(z) = 1 unfolded to [-1, 1]^2 (0 to 254 stand for -1 to 1), and
/// one of each of the colours, 0 to 255 across their range.
QuantisedSurface quantised(vtkPolyData& surface, const PageRanges& ranges);

}  // namespace kappaflow
