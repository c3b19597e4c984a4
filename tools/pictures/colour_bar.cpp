#include "tools/pictures/colour_bar.h"

#include <fmt/format.h>

#include <cmath>

#include "tools/pictures/text_label.h"

namespace kappaflow {
namespace {

// Of the part's width and height.
constexpr double kMargin = 0.06, kBelow = 0.72, kAbove = 0.94, kLabels = 0.51, kTitle = 0.17, kLetters = 0.29;
constexpr double kGap = 0.06;  // between the colours of names, of a colour's width

bool is_of_names(const Colouring& colouring) {
  return colouring.table->GetIndexedLookup() != 0;
}

/// The colour at a share of the band's length; none in the gaps between names.
const double* colour_at(const Colouring& colouring, double share) {
  vtkLookupTable& table = *colouring.table;
  if (!is_of_names(colouring))
    return table.GetTableValue(std::lround(share * static_cast<double>(table.GetNumberOfTableValues() - 1)));
  const double place = share * static_cast<double>(table.GetNumberOfAnnotatedValues());
  if (std::abs(place - std::round(place)) < kGap / 2) return nullptr;
  return table.GetTableValue(static_cast<vtkIdType>(place));
}

}  // namespace

void add_bar_labels(vtkRenderer& renderer, const Colouring& colouring, int width, int height) {
  const int size = static_cast<int>(kLetters * height);
  const auto add = [&](const std::string& text, double share, double y) {
    renderer.AddActor2D(text_label(text, (kMargin + share * (1 - 2 * kMargin)) * width, y * height, size));
  };
  add(colouring.title, 0.5, kTitle);
  vtkLookupTable& table = *colouring.table;
  const int names = is_of_names(colouring) ? static_cast<int>(table.GetNumberOfAnnotatedValues()) : 0;
  for (int k = 0; k < names; ++k) add(table.GetAnnotation(k), (k + 0.5) / names, kLabels);
  if (names > 0) return;
  const double* range = table.GetTableRange();
  for (int k = 0; k < colouring.labels; ++k) {
    const double share = k / (colouring.labels - 1.0);
    add(fmt::format("{:.4g}", range[0] + share * (range[1] - range[0])), share, kLabels);
  }
}

void paint_bar(vtkImageData& image, const Colouring& colouring) {
  const int width = image.GetDimensions()[0], height = image.GetDimensions()[1];
  for (int x = 0; x < width; ++x) {
    const double share = ((x + 0.5) / width - kMargin) / (1 - 2 * kMargin);
    const double* const colour = share < 0 || share > 1 ? nullptr : colour_at(colouring, share);
    for (int y = static_cast<int>(kBelow * height); colour != nullptr && y < kAbove * height; ++y)
      for (int c = 0; c < 3; ++c) image.SetScalarComponentFromDouble(x, y, 0, c, std::round(255 * colour[c]));
  }
}

}  // namespace kappaflow
