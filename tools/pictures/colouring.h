// Surfaces of pictures coloured by the numbers of a point array.
#pragma once

#include <vtkLookupTable.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <string>

namespace kappaflow {

/// Numbers as colours, the same in all panels and frames.
struct Colouring {
  std::string array;                      ///< point array; of vectors the length counts
  std::string title;                      ///< of the colour bar
  vtkSmartPointer<vtkLookupTable> table;  ///< values outside of its range have the colours of its ends
  int labels = 0;                         ///< on the colour bar, equally far apart from end to end
};

/// The least and the greatest value to be told apart by colour.
using ValueRange = std::array<double, 2>;

/// The range that all but 2 % of the vertices lie in: from the 1st to the 99th percentile of the array's
/// values, or of the lengths of its vectors; of names (see colouring()) all. Throws InvalidInput that lists
/// the surface's arrays where it has none of that name.
ValueRange value_range(vtkPolyData& surface, const std::string& array);

/// Whether the array's whole numbers are names of something, such as sources: nothing lies between them.
bool holds_names(vtkPolyData& surface, const std::string& array);

/// The range, made wider until its ends and the labels between them are round.
ValueRange rounded(ValueRange range);

/// From blue over white at 0 to red where the range has both signs, else from dark blue to yellow, of
/// temperatures as what glows. Arrays of
/// type Int32 are names: up to 8 in the range have colours of their own, and those beyond it are grey. The
/// bar has labels at round values where the range is rounded(). surface: any that has the array. Throws
/// InvalidInput as value_range() does.
Colouring colouring(vtkPolyData& surface, const std::string& array, ValueRange range);

}  // namespace kappaflow
