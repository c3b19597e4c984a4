#include "tools/io/vtk_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/errors.h"
#include "core/text_scanner.h"
#include "tools/io/vtk_xml_reader.h"
#include "tools/io/xml_parser.h"

namespace kappaflow {
namespace {

/// The pieces of a file, one after the other.
class PieceReader : public VtkXmlReader {
 public:
  PieceReader(std::string_view kind, bool with_polygons)
      : VtkXmlReader(kind), with_polygons_(with_polygons) {}

  VtkPolygons result() {
    data_.check_sizes();
    return {std::move(data_), std::move(polygons_), std::move(cell_arrays_)};
  }

 protected:
  void begin_part(std::string_view element, Attributes attributes) override {
    if (element != "Piece") return;
    points_ = count_in(attributes, "NumberOfPoints");
    piece_ = {};
  }
  void end_part(std::string_view element) override {
    if (element == "Piece") end_piece();
  }
  std::vector<PointArray>* arrays_in(std::string_view element) override {
    if (element == "PointData") return &piece_.arrays;
    if (element == "Points") return &coordinates_;
    if (element == "FieldData") return &data_.fields;
    if (!with_polygons_) return nullptr;
    if (element == "Polys") return &polys_;
    if (element == "Strips") return &strips_;
    return element == "CellData" ? &piece_cell_arrays_ : nullptr;
  }

 private:
  void end_piece() {
    if (points_ == 0) coordinates_.resize(1, {{}, 3, {}});  // writers leave out what there is nothing of
    if (coordinates_.size() != 1 || coordinates_[0].components != 3)
      throw InvalidInput("has no one array of 3 components in Points");
    const std::vector<double>& x = coordinates_[0].values;
    if (x.size() % 3 != 0 || x.size() / 3 != points_)
      throw InvalidInput(fmt::format("has {} coordinates for {} points", x.size(), points_));
    for (std::size_t i = 0; i < x.size(); i += 3) piece_.position.emplace_back(x[i], x[i + 1], x[i + 2]);
    coordinates_.clear();
    piece_.check_sizes();
    if (with_polygons_) append_polygons();
    append_piece();
  }

  void append_polygons() {
    if (polys_.empty() && strips_.empty() && points_ == 0) return;
    if (polys_.empty()) throw InvalidInput("has no arrays connectivity and offsets in Polys");
    add_cells(polys_, [&](std::span<const int> polygon) {
      polygons_.corner.insert(polygons_.corner.end(), polygon.begin(), polygon.end());
      polygons_.end.push_back(polygons_.corner.size());
    });
    if (!strips_.empty())
      add_cells(strips_, [&](std::span<const int> strip) { add_strip(strip, polygons_); });
    polys_.clear();
    strips_.clear();
  }

  /// Calls add(points) for each of the cells, with the points' numbers in the whole file.
  template <class Add>
  void add_cells(const std::vector<PointArray>& cells, const Add& add) const {
    const PointArray *corners = find_array(cells, {"connectivity"}, 1),
                     *ends = find_array(cells, {"offsets"}, 1);
    if (corners == nullptr || ends == nullptr)
      throw InvalidInput("has no arrays connectivity and offsets in Polys");
    const int first = static_cast<int>(data_.position.size());
    std::vector<int> corner;
    for (const double number : corners->values) corner.push_back(first + checked_corner(number, points_));
    std::size_t begin = 0;
    for (const double end : ends->values) {
      if (!(end >= static_cast<double>(begin) && end <= static_cast<double>(corner.size())))
        throw InvalidInput(fmt::format("has a polygon that ends at {} of {} corners", end, corner.size()));
      add(std::span(corner).subspan(begin, static_cast<std::size_t>(end) - begin));
      begin = static_cast<std::size_t>(end);
    }
    if (begin != corner.size())
      throw InvalidInput(fmt::format("has {} corners, and polygons with {}", corner.size(), begin));
  }

  void append_piece() {
    data_.position.insert(data_.position.end(), piece_.position.begin(), piece_.position.end());
    append_arrays(piece_.arrays, data_.arrays);
    append_arrays(piece_cell_arrays_, cell_arrays_);
    piece_cell_arrays_.clear();
  }

  /// An array that some of the pieces lack comes out too short.
  static void append_arrays(std::vector<PointArray>& of_piece, std::vector<PointArray>& all) {
    for (PointArray& array : of_piece) {
      const auto same = std::ranges::find_if(
          all, [&](const PointArray& a) { return a.name == array.name && a.components == array.components; });
      if (same == all.end())
        all.push_back(std::move(array));
      else
        same->values.insert(same->values.end(), array.values.begin(), array.values.end());
    }
  }

  bool with_polygons_;
  PointData data_, piece_;
  std::size_t points_ = 0;                                                    // of the piece
  std::vector<PointArray> coordinates_, polys_, strips_, piece_cell_arrays_;  // likewise
  PolygonList polygons_;
  std::vector<PointArray> cell_arrays_;
};

/// What a parallel file says of its pieces.
class SourceReader : public VtkXmlReader {
 public:
  explicit SourceReader(std::string_view kind) : VtkXmlReader(kind) {}
  std::vector<std::string> sources;

 protected:
  void begin_part(std::string_view element, Attributes attributes) override {
    if (element == "Piece") sources.push_back(piece_source(attributes));
  }
  void end_part(std::string_view /*element*/) override {}
  std::vector<PointArray>* arrays_in(std::string_view /*element*/) override { return nullptr; }
};

VtkPolygons parse(std::string_view bytes, std::string_view kind, bool with_polygons) {
  PieceReader reader(kind, with_polygons);
  reader.read(bytes);
  return reader.result();
}

void check_cell_arrays(const VtkSurface& surface) {
  for (const PointArray& array : surface.cell_arrays)
    if (array.values.size() != array.components * surface.triangles.size())
      throw InvalidInput(fmt::format("array \"{}\" has {} numbers for {} triangles", one_line(array.name, 30),
                                     array.values.size(), surface.triangles.size()));
}

}  // namespace

PointData parse_vtk_xml(std::string_view bytes, std::string_view kind) {
  return parse(bytes, kind, false).points;
}

std::vector<std::string> parse_vtk_pieces(std::string_view bytes, std::string_view kind) {
  const std::string parallel = fmt::format("P{}", kind);
  SourceReader reader(parallel);
  reader.read(bytes);
  if (reader.sources.empty()) throw InvalidInput("has no pieces");
  return std::move(reader.sources);
}

VtkPolygons parse_vtk_polygons(std::string_view bytes) {
  return parse(bytes, "PolyData", true);
}

VtkSurface parse_vtk_surface(std::string_view bytes) {
  VtkPolygons data = parse_vtk_polygons(bytes);
  VtkSurface surface{std::move(data.points), {}, std::move(data.cell_arrays)};
  const auto& [corner, end] = data.polygons;
  for (std::size_t t = 0; t < end.size(); ++t) {
    if (end[t] != 3 * (t + 1)) throw InvalidInput(fmt::format("polygon {} is no triangle", t));
    surface.triangles.push_back({corner[3 * t], corner[3 * t + 1], corner[3 * t + 2]});
  }
  check_cell_arrays(surface);
  return surface;
}

}  // namespace kappaflow
