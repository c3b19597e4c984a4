// What explains the colours of a picture.
#pragma once

#include <vtkImageData.h>
#include <vtkRenderer.h>

#include "tools/pictures/colouring.h"

namespace kappaflow {

/// The title, above it the numbers along the band of colours, or of names one below each colour, in a part of
/// the picture of that size [pixels].
void add_bar_labels(vtkRenderer& renderer, const Colouring& colouring, int width, int height);

/// The band itself above them, painted into what was drawn of that part.
void paint_bar(vtkImageData& image, const Colouring& colouring);

}  // namespace kappaflow
