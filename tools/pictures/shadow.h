// Soft shadows in a picture, found from the depths that the camera and the light see.
#pragma once

#include <vtkImageData.h>

#include <Eigen/Core>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// How far away what a camera sees is, pixel by pixel from below.
struct DepthImage {
  int width = 0, height = 0;
  std::vector<float> depth;  ///< 0 at the near plane, 1 at the far one or where there is nothing
  Eigen::Matrix4d to_image;  ///< from places [m] to the box [-1, 1]^3: right, up, away
};

/// What surfaces are lit by: everywhere alike, and from two directions; what they add at right angles.
struct Lighting {
  Vec3 key, fill;  ///< directions towards them, of length 1
  double ambient, from_key, from_fill;
};

/// Takes from each pixel's colour the share that the key light has in it, as far as what the light sees
/// stands before the pixel's place. The light is a disc: shadows are sharp where they begin and softer with
/// the distance from what casts them. seen: of the picture, with its size; from_key: by a camera without
/// perspective that looks along the key light, with what casts shadows between its planes.
void cast_shadows(vtkImageData& picture, const DepthImage& seen, const DepthImage& from_key,
                  const Lighting& lighting);

}  // namespace kappaflow
