#include "tools/pictures/page.h"

#include <fmt/format.h>
#include <vtk_jsoncpp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/errors.h"
#include "core/version.h"
#include "surface/tracker/surface_methods.h"
#include "tools/io/binary.h"
#include "tools/io/files.h"
#include "tools/io/surface_file.h"
#include "tools/pictures/embedded_files.h"
#include "tools/pictures/html_text.h"
#include "tools/pictures/page_surfaces.h"
#include "tools/runs/metrics.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/run_record.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

Json::Value numbers(std::span<const double> values) {
  Json::Value array(Json::arrayValue);
  for (const double value : values) array.append(value);
  return array;
}

Json::Value numbers(const Vec3& x) {
  return numbers(std::span(x.data(), 3));
}

Json::Value box_json(const Bounds& box) {
  Json::Value json;
  json["lower"] = numbers(box.lower);
  json["upper"] = numbers(box.upper);
  return json;
}

/// The colours of the table from its lower end to its upper one as red, green, blue.
std::string table_bytes(vtkLookupTable& table) {
  std::string bytes;
  for (vtkIdType k = 0; k < table.GetNumberOfTableValues(); ++k)
    for (int c = 0; c < 3; ++c)
      bytes += static_cast<char>(static_cast<unsigned char>(std::lround(255 * table.GetTableValue(k)[c])));
  return bytes;
}

Json::Value colours_json(const std::vector<Colouring>& colours) {
  Json::Value list(Json::arrayValue);
  for (const Colouring& colour : colours) {
    Json::Value json;
    json["array"] = colour.array;
    json["title"] = colour.title;
    json["range"] = numbers(std::span(colour.table->GetTableRange(), 2));
    json["labels"] = colour.labels;
    json["table"] = base64(table_bytes(*colour.table));
    list.append(json);
  }
  return list;
}

Json::Value framing_json(const std::vector<Framing>& framing, const View& view) {
  const Mat3 axes = view_axes(view);
  Json::Value list(Json::arrayValue);
  for (const Framing& frame : framing) {
    Json::Value json;
    json["centre"] = numbers(Vec3(axes.transpose() * frame.centre));
    json["half"] = numbers(frame.half);
    list.append(json);
  }
  return list;
}

std::string better_name(Better better) {
  switch (better) {
    case Better::lower:
      return "lower";
    case Better::higher:
      return "higher";
    case Better::nearer_to_one:
      return "nearer to 1";
    default:
      return "";
  }
}

/// The columns of numbers, and of each method the values of each frame in each; null where there is none.
Json::Value metrics_json(const RunFrames& frames) {
  const MetricsTable table = read_metrics_table(frames.folder() / kMetricsFile);
  Json::Value json, columns(Json::arrayValue);
  for (const MetricColumn* column : table.columns) {
    if (column->name == "method") continue;
    Json::Value& values = json["values"][std::string(column->name)];
    for (const MetricsRow& row : table.rows)
      if (row.frame.frame < frames.count()) values[row.method].append(column->number(row));
    Json::Value description;
    description["name"] = std::string(column->name);
    description["unit"] = std::string(column->unit);
    description["meaning"] = std::string(column->meaning);
    description["better"] = better_name(column->better);
    columns.append(description);
  }
  json["columns"] = columns;
  return json;
}

Json::Value methods_json(const std::vector<std::string>& methods) {
  Json::Value list(Json::arrayValue);
  for (const std::string& name : methods) {
    Json::Value json;
    json["name"] = name;
    for (const NamedSurfaceMethod& method : surface_methods())
      if (method.name == name) json["summary"] = std::string(method.summary);
    list.append(json);
  }
  return list;
}

std::string run_title(const Json::Value& record) {
  return record.isMember("sequence") ? record["sequence"]["name"].asString()
                                     : record["scene"]["title"].asString();
}

/// What the foot of the page says of how it was made.
Json::Value origin_json(const Json::Value& record) {
  Json::Value json;
  std::vector<std::string> words;
  for (const Json::Value& word : record["command"]) words.push_back(word.asString());
  json["command"] = fmt::format("{}", fmt::join(words, " "));
  json["run_version"] = record["version"];
  json["started"] = record["started"];
  json["source"] = record.isMember("sequence") ? record["sequence"]["first"] : record["scene"]["file"];
  json["hash"] = record.isMember("sequence") ? record["sequence"]["hash"] : record["scene"]["hash"];
  json["page_version"] = kVersion;
  json["made"] = time_now();
  return json;
}

/// A part of the page's data.
std::string data_element(const std::string& name, std::string_view bytes) {
  return fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", name,
                     base64(deflated(bytes)));
}

/// The text of an element: nothing in it ends the element.
std::string element_text(const Json::Value& json) {
  Json::StreamWriterBuilder writer;
  writer["indentation"] = "";
  writer["precision"] = 12;
  std::string text;
  for (const char c : Json::writeString(writer, json)) c == '<' ? text += "\\u003c" : text += c;
  return text;
}

Bounds walls_box(const RunFrames& frames, int count) {
  std::vector<Vec3> points;
  for (int frame = 0; frame < count; ++frame) {
    const auto walls = frames.walls(frame);
    for (vtkIdType v = 0; v < walls->GetNumberOfPoints(); ++v) points.emplace_back(walls->GetPoint(v));
  }
  return bounding_box(points);
}

/// Where walls are asked for what they hide from: along the axes, the diagonals of faces, those of a cube.
std::vector<Vec3> viewers() {
  std::vector<Vec3> directions;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) directions.push_back(Vec3(x, y, z).normalized());
  return directions;
}

std::string places_bytes(vtkPolyData& walls, const Bounds& box) {
  std::string bytes;
  for (vtkIdType v = 0; v < walls.GetNumberOfPoints(); ++v)
    for (int a = 0; a < 3; ++a) append(bytes, quantised(walls.GetPoint(v)[a], box.lower[a], box.upper[a]));
  return bytes;
}

std::string corner_bytes(vtkPolyData& walls) {
  std::string bytes;
  for (const Triangle& triangle : triangles_of(walls))
    for (const int corner : triangle) append(bytes, static_cast<std::uint32_t>(corner));
  return bytes;
}

/// The walls' data; what is to be known of them goes into the header.
std::string walls_elements(const RunFrames& frames, Json::Value& header) {
  if (!frames.walls(0)) return "";
  draw_status_line("walls");
  const int count = frames.walls_move() ? frames.count() : 1;
  const Bounds box = walls_box(frames, count);
  const std::vector<Vec3> directions = viewers();
  Json::Value& json = header["walls"];
  json = box_json(box);
  json["frames"] = count;
  for (const Vec3& direction : directions) json["viewers"].append(numbers(direction));
  std::string hides;
  const std::set looked_at{0, frames.count() / 2, frames.count() - 1};
  for (const std::uint32_t bits : hiding_triangles(frames, looked_at, directions)) append(hides, bits);
  std::string elements =
      data_element("walls-corners", corner_bytes(*frames.walls(0))) + data_element("walls-hides", hides);
  for (int frame = 0; frame < count; ++frame)
    elements += data_element(fmt::format("walls-{}", frame), places_bytes(*frames.walls(frame), box));
  return elements;
}

std::string surface_elements(const RunFrames& frames, const PageRanges& ranges) {
  std::string elements;
  std::vector<SurfacePacker> packers(frames.methods().size());
  WorkProgress progress("packing frame", frames.count());
  for (int frame = 0; frame < frames.count(); ++frame) {
    progress.show(frame);
    for (std::size_t m = 0; m < packers.size(); ++m) {
      const auto surface = page_surface(frames, ranges, frames.methods()[m], frame);
      elements +=
          data_element(fmt::format("surface-{}-{}", m, frame), packers[m].pack(quantised(*surface, ranges)));
    }
  }
  return elements;
}

Json::Value header_json(const RunFrames& frames, const PageRanges& ranges) {
  Json::Value json;
  json["title"] = run_title(frames.record());
  json["origin"] = origin_json(frames.record());
  json["methods"] = methods_json(frames.methods());
  json["times"] = numbers(ranges.times);
  json["box"] = box_json(ranges.box);
  json["rest"] = box_json(ranges.rest);
  json["checker"]["origin"] = numbers(ranges.checker.origin);
  json["checker"]["edge"] = ranges.checker.edge;
  json["view"]["from"] = numbers(frames.view().from);
  json["view"]["up"] = numbers(frames.view().up);
  json["framing"] = framing_json(ranges.framing, frames.view());
  json["colours"] = colours_json(ranges.colours);
  json["metrics"] = metrics_json(frames);
  return json;
}

/// The template with what belongs in the places of its {{names}}.
std::string filled(std::string_view text, const std::map<std::string_view, std::string_view>& parts) {
  std::string result;
  for (std::size_t begin = 0; (begin = text.find("{{")) != std::string_view::npos;) {
    const std::size_t end = text.find("}}", begin);
    result += text.substr(0, begin);
    result += parts.at(text.substr(begin + 2, end - begin - 2));
    text = text.substr(end + 2);
  }
  return result.append(text);
}

/// The address that browsers open a file by.
std::string address_of(const fs::path& file) {
  std::string address = "file://";
  for (const char c : fs::canonical(file).string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                       std::string_view("/-._~").find(c) != std::string_view::npos;
    address += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return address;
}

}  // namespace

std::string write_page(const PageOptions& options) {
  const fs::path out = options.out.empty() ? options.folder / "page.html" : options.out;
  if (out.extension() != ".html")
    throw InvalidInput(fmt::format("found \"{}\"; expected a file name that ends in .html", out.string()));
  const RunFrames frames(options.folder, options.methods);
  const PageRanges ranges = page_ranges(frames);
  Json::Value header = header_json(frames, ranges);
  const std::string data = walls_elements(frames, header) + surface_elements(frames, ranges),
                    run = element_text(header), title = html_text(run_title(frames.record()));
  const std::string page = filled(
      kPageTemplate,
      {{"title", title}, {"style", kPageStyle}, {"run", run}, {"data", data}, {"script", kPageScript}});
  write_file(out, page);
  return fmt::format("{}: {} frames of {}, {:.1f} MB\nOpen it in a browser: {}\n", out.string(),
                     frames.count(), fmt::join(frames.methods(), ", "),
                     1e-6 * static_cast<double>(page.size()), address_of(out));
}

}  // namespace kappaflow
