// From where pictures of a scene are taken.
#pragma once

#include "core/types.h"

namespace kappaflow {

/// Directions without a length; how far away the viewer stands follows from what there is to see.
struct View {
  Vec3 from{0.9, 0.65, 1};  ///< from the subject to the viewer
  Vec3 up{0, 1, 0};         ///< what points up in the picture
};

/// The default view, turned so that `up`, which is not zero, points up in it.
View view_with(const Vec3& up);

/// Whether the directions are such that there is a picture: neither zero nor parallel.
bool is_view(const View& view);

}  // namespace kappaflow
