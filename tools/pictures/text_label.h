// Text in pictures.
#pragma once

#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include <string>

namespace kappaflow {

/// A line of text with its middle there and letters of that size, in pixels from the lower left.
vtkSmartPointer<vtkTextActor> text_label(const std::string& text, double x, double y, int size);

}  // namespace kappaflow
