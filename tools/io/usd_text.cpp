#include "tools/io/usd_text.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <iterator>
#include <vector>

namespace kappaflow {
namespace {

/// Numbers, tuple by tuple, in brackets.
template <class Number>
std::string list_of(std::span<const Number> numbers, std::size_t components) {
  std::string text = "[";
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t c = i % components;
    if (i > 0) text += c == 0 && components > 1 ? "),(" : ",";
    if (i == 0 && components > 1) text += '(';
    fmt::format_to(out, FMT_COMPILE("{}"), numbers[i]);
  }
  return text + (components > 1 && !numbers.empty() ? ")]" : "]");
}

std::string indented(int blanks, std::string_view line) {
  return fmt::format("{:{}}{}\n", "", blanks, line);
}

}  // namespace

std::string usd_header(const UsdStage& stage, int frames, std::span<const std::string> sublayers) {
  std::string text = fmt::format(
      "#usda 1.0\n(\n    defaultPrim = \"World\"\n    metersPerUnit = 1\n    upAxis = \"{}\"\n"
      "    startTimeCode = 0\n    endTimeCode = {}\n    timeCodesPerSecond = {:.9g}\n    framesPerSecond = "
      "{:.9g}\n",
      stage.z_up ? "Z" : "Y", frames - 1, stage.frames_per_second, stage.frames_per_second);
  if (!sublayers.empty()) {
    text += "    subLayers = [\n";
    for (const std::string& file : sublayers) text += fmt::format("        @./{}@,\n", file);
    text += "    ]\n";
  }
  return text + ")\n";
}

std::string usd_declarations(std::span<const UsdAttribute> attributes, int indent) {
  std::string text;
  for (const UsdAttribute& attribute : attributes) {
    const std::string name = fmt::format("{} {}", attribute.type, attribute.name);
    if (attribute.interpolation.empty()) {
      text += indented(indent, name);
      continue;
    }
    text += indented(indent, name + " (");
    text += indented(indent + 4, fmt::format("interpolation = \"{}\"", attribute.interpolation));
    text += indented(indent, ")");
  }
  return text;
}

std::string usd_world(const UsdStage& stage, const std::string& prims) {
  std::string text = "\ndef Xform \"World\"\n{\n";
  if (!stage.origin.isZero(0))
    text += fmt::format(
        "    double3 xformOp:translate = ({}, {}, {})\n"
        "    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n\n",
        stage.origin[0], stage.origin[1], stage.origin[2]);
  return text + prims + "}\n";
}

std::string usd_manifest(std::string_view prim, std::span<const UsdAttribute> attributes) {
  return fmt::format("#usda 1.0\n\nover \"{}\"\n{{\n{}}}\n", prim, usd_declarations(attributes, 4));
}

std::string usd_clips(const std::string& stem, const std::string& manifest, std::string_view prim,
                      int frames) {
  std::string text = indented(8, "clips = {");
  text += indented(12, "dictionary default = {");
  text += indented(16, fmt::format("asset manifestAssetPath = @./{}@", manifest));
  text += indented(16, fmt::format("string primPath = \"/{}\"", prim));
  text += indented(16, fmt::format("string templateAssetPath = \"./{}.####.usda\"", stem));
  text += indented(16, "double templateStartTime = 0");
  text += indented(16, fmt::format("double templateEndTime = {}", frames - 1));
  text += indented(16, "double templateStride = 1");
  return text + indented(12, "}") + indented(8, "}");
}

std::string usd_name(std::string_view name) {
  std::string allowed(name);
  for (char& c : allowed)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return allowed;
}

std::string usd_list(std::span<const float> numbers, int components) {
  return list_of(numbers, static_cast<std::size_t>(components));
}

std::string usd_list(std::span<const std::int64_t> numbers) {
  return list_of(numbers, 1);
}

std::string usd_list(std::span<const Triangle> triangles) {
  std::vector<std::int64_t> corners;
  corners.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
  return usd_list(corners);
}

std::string usd_list(std::span<const Vec3> vectors, const Vec3& from, int decimals) {
  const double unit = std::pow(10, decimals);
  std::vector<float> numbers;
  numbers.reserve(3 * vectors.size());
  for (const Vec3& v : vectors)
    for (const double c : Vec3(v - from))
      numbers.push_back(static_cast<float>(decimals < 0 ? c : std::round(c * unit) / unit));
  return usd_list(numbers, 3);
}

std::string usd_sample(const UsdAttribute& attribute, int frame, std::string_view value, int indent) {
  return indented(indent, fmt::format("{} {}.timeSamples = {{", attribute.type, attribute.name)) +
         indented(indent + 4, fmt::format("{}: {},", frame, value)) + indented(indent, "}");
}

}  // namespace kappaflow
