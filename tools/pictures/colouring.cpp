#include "tools/pictures/colouring.h"

#include <fmt/format.h>
#include <vtkColorSeries.h>
#include <vtkColorTransferFunction.h>
#include <vtkDataArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <vector>

#include "core/errors.h"
#include "core/quantile.h"
#include "core/suggestion.h"

namespace kappaflow {
namespace {

constexpr double kLeftOut = 0.01;  // share of the values at either end
constexpr int kColours = 256;
constexpr int kMostNames = 8;  // as many as the palette has colours

std::vector<std::string_view> names_of_arrays(vtkPolyData& surface) {
  std::vector<std::string_view> names;
  vtkPointData& arrays = *surface.GetPointData();
  for (int a = 0; a < arrays.GetNumberOfArrays(); ++a)
    if (arrays.GetArray(a) != nullptr) names.emplace_back(arrays.GetArrayName(a));
  std::ranges::sort(names);
  return names;
}

vtkDataArray& array_of(vtkPolyData& surface, const std::string& name) {
  vtkDataArray* const array = surface.GetPointData()->GetArray(name.c_str());
  if (array == nullptr) {
    const std::vector<std::string_view> names = names_of_arrays(surface);
    throw InvalidInput(fmt::format("the surface has no array \"{}\"; it has {}{}", name,
                                   fmt::join(names, ", "), suggestion(name, names)));
  }
  return *array;
}

bool has_names(vtkDataArray& array) {
  return vtkIntArray::SafeDownCast(&array) != nullptr && array.GetNumberOfComponents() == 1;
}

double length_at(vtkDataArray& array, vtkIdType vertex) {
  double squared = 0;
  for (int c = 0; c < array.GetNumberOfComponents(); ++c) {
    const double x = array.GetComponent(vertex, c);
    squared += x * x;
  }
  return std::sqrt(squared);
}

std::string title_of(const std::string& array, bool vectors) {
  struct Words {
    std::string_view text, unit;
  };
  static const std::map<std::string_view, Words> kWords{
      {"velocity", {"speed", "m/s"}},
      {"material_slip", {"slip against the liquid", "m/s"}},
      {"mean_curvature", {"mean curvature", "1/m"}},
      {"gaussian_curvature", {"Gaussian curvature", "1/m\u00b2"}},
      {"rest_position", {"distance of the rest position from the origin", "m"}},
      {"confidence", {"confidence in the tangential velocity", ""}},
      {"source", {"where the liquid comes from", ""}},
      {"temperature", {"temperature", "K"}},
      {"emission_time", {"when the liquid came", "s"}}};
  const auto known = kWords.find(array);
  if (known == kWords.end()) return fmt::format("{}{}", vectors ? "length of " : "", array);
  const auto& [text, unit] = known->second;
  return unit.empty() ? std::string(text) : fmt::format("{} [{}]", text, unit);
}

/// The step between labels: 1, 2, 2.5 or 5 times a power of ten, of which a range holds three to six.
double label_step(ValueRange range) {
  const double about = (range[1] - range[0]) / 4, power = std::pow(10, std::floor(std::log10(about)));
  for (const double digit : {1.0, 2.0, 2.5, 5.0})
    if (digit * power > 0.999999 * about) return digit * power;
  return 10 * power;
}

// Colours over a range that may be wider than what is shown of it.
vtkSmartPointer<vtkColorTransferFunction> colour_scale(ValueRange range, bool glows) {
  auto scale = vtkSmartPointer<vtkColorTransferFunction>::New();
  const auto [low, high] = range;
  if (low < 0 && high > 0) {
    const double end = std::max(-low, high);
    scale->SetColorSpaceToDiverging();
    scale->AddRGBPoint(-end, 0.230, 0.299, 0.754);
    scale->AddRGBPoint(end, 0.706, 0.016, 0.150);
    return scale;
  }
  constexpr double kViridis[][3] = {{0.267, 0.005, 0.329}, {0.254, 0.265, 0.530}, {0.164, 0.471, 0.558},
                                    {0.135, 0.659, 0.518}, {0.478, 0.821, 0.319}, {0.993, 0.906, 0.144}};
  constexpr double kInferno[][3] = {{0.001, 0.000, 0.014}, {0.258, 0.039, 0.406}, {0.578, 0.148, 0.404},
                                    {0.865, 0.317, 0.226}, {0.988, 0.645, 0.040}, {0.988, 0.998, 0.645}};
  const auto& colours = glows ? kInferno : kViridis;
  for (std::size_t k = 0; k < std::size(colours); ++k)
    scale->AddRGBPoint(
        low + (high - low) * static_cast<double>(k) / static_cast<double>(std::size(colours) - 1),
        colours[k][0], colours[k][1], colours[k][2]);
  return scale;
}

vtkSmartPointer<vtkLookupTable> colour_table(ValueRange range, bool glows) {
  const auto scale = colour_scale(range, glows);
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(kColours);
  table->SetTableRange(range.data());
  for (int k = 0; k < kColours; ++k) {
    const double value = range[0] + (range[1] - range[0]) * k / (kColours - 1);
    table->SetTableValue(k, scale->GetRedValue(value), scale->GetGreenValue(value),
                         scale->GetBlueValue(value));
  }
  return table;
}

/// A colour for each whole number in the range.
vtkSmartPointer<vtkLookupTable> name_table(ValueRange range) {
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  for (double name = std::ceil(range[0]); name <= range[1]; ++name)
    table->SetAnnotation(vtkVariant(name), fmt::format("{}", name));
  vtkNew<vtkColorSeries> palette;
  palette->SetColorScheme(vtkColorSeries::BREWER_QUALITATIVE_SET2);
  palette->BuildLookupTable(table, vtkColorSeries::CATEGORICAL);
  table->SetNanColor(0.6, 0.6, 0.6, 1);
  return table;
}

}  // namespace

ValueRange value_range(vtkPolyData& surface, const std::string& name) {
  vtkDataArray& array = array_of(surface, name);
  std::vector<double> values(static_cast<std::size_t>(array.GetNumberOfTuples()));
  for (std::size_t v = 0; v < values.size(); ++v) {
    const auto vertex = static_cast<vtkIdType>(v);
    values[v] = array.GetNumberOfComponents() == 1 ? array.GetComponent(vertex, 0) : length_at(array, vertex);
  }
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {0, 0};
  const double left_out = has_names(array) ? 0 : kLeftOut;
  return {quantile(values, left_out), quantile(values, 1 - left_out)};
}

bool holds_names(vtkPolyData& surface, const std::string& name) {
  return has_names(array_of(surface, name));
}

ValueRange rounded(ValueRange range) {
  if (!(range[1] > range[0])) return range;
  const double step = label_step(range);
  return {std::floor(range[0] / step) * step, std::ceil(range[1] / step) * step};
}

Colouring colouring(vtkPolyData& surface, const std::string& name, ValueRange range) {
  vtkDataArray& array = array_of(surface, name);
  const bool vectors = array.GetNumberOfComponents() > 1;
  if (has_names(array) && range[1] - range[0] < kMostNames)
    return {name, title_of(name, vectors), name_table(range)};
  if (!(range[1] > range[0])) range[1] = range[0] + 1;  // an array with one value throughout
  const double steps = (range[1] - range[0]) / label_step(range);
  const bool is_rounded = std::abs(steps - std::round(steps)) < 1e-6;
  Colouring result{name, title_of(name, vectors), colour_table(range, name == "temperature"),
                   is_rounded ? static_cast<int>(std::lround(steps)) + 1 : 2};
  if (vectors) result.table->SetVectorModeToMagnitude();
  return result;
}

}  // namespace kappaflow
