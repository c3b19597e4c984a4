#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/errors.h"
#include "core/text_scanner.h"
#include "tools/io/vtk_xml.h"
#include "tools/io/vtk_xml_reader.h"
#include "tools/io/xml_parser.h"

namespace kappaflow {
namespace {

using Index = std::array<std::size_t, 3>;

/// Of the points of a box, none empty.
Index cells_of(const LatticeBox& box) {
  return LatticeData{.points = box.points()}.cells();
}

std::size_t product(const Index& size) {
  return size[0] * size[1] * size[2];
}

template <std::size_t N>
std::array<double, N> numbers_of(VtkXmlReader::Attributes attributes, std::string_view name,
                                 const std::array<double, N>& fallback) {
  const std::string_view text = xml_attribute(attributes, name);
  if (text.empty()) return fallback;
  const std::vector<double> values = numbers_in(text);
  if (values.size() != N)
    throw InvalidInput(fmt::format("{} is \"{}\"; expected {} numbers", name, one_line(text, 60), N));
  std::array<double, N> result;
  std::ranges::copy(values, result.begin());
  return result;
}

LatticeBox extent_of(VtkXmlReader::Attributes attributes, std::string_view name) {
  constexpr double kFarthest = 1e9, kMostPoints = 1e12;
  constexpr std::array<double, 6> kNone{0, -1, 0, -1, 0, -1};
  const std::array<double, 6> numbers = numbers_of(attributes, name, kNone);
  LatticeBox extent;
  double points = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const double first = numbers[2 * c], last = numbers[2 * c + 1];
    if (first != std::floor(first) || last != std::floor(last) || !(std::abs(first) < kFarthest) ||
        !(std::abs(last) < kFarthest) || last < first)
      throw InvalidInput(fmt::format("{} is \"{}\"; expected the first and last of points along x, y, z",
                                     name, one_line(xml_attribute(attributes, name), 60)));
    extent.first[c] = static_cast<std::int64_t>(first);
    extent.last[c] = static_cast<std::int64_t>(last);
    points *= last - first + 1;
  }
  if (points > kMostPoints) throw InvalidInput(fmt::format("{} has {:.3g} points", name, points));
  return extent;
}

/// What the element says of the image's lattice, with the origin as it is there. Returns the points.
LatticeBox take_lattice(VtkXmlReader::Attributes attributes, LatticeData& image) {
  constexpr std::array<double, 9> kUnturned{1, 0, 0, 0, 1, 0, 0, 0, 1};
  image.origin = Vec3(numbers_of<3>(attributes, "Origin", {0, 0, 0}).data());
  image.spacing = Vec3(numbers_of<3>(attributes, "Spacing", {1, 1, 1}).data());
  image.turned = numbers_of(attributes, "Direction", kUnturned) != kUnturned;
  return extent_of(attributes, "WholeExtent");
}

/// A part of the image.
struct Piece {
  LatticeBox extent;
  LatticeData data;
};

/// The array of that name and size; null where the piece has none.
const PointArray* like(const PointArray& array, const std::vector<PointArray>& others) {
  const auto found = std::ranges::find_if(others, [&](const PointArray& other) {
    return other.name == array.name && other.components == array.components;
  });
  return found == others.end() ? nullptr : &*found;
}

/// Copies the rows of a piece to their places in the whole.
void place(const PointArray& part, const Index& size, const Index& at, const Index& whole,
           std::vector<double>& values) {
  const std::size_t row = size[0] * part.components;
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      std::copy_n(
          part.values.begin() + static_cast<std::ptrdiff_t>((k * size[1] + j) * row), row,
          values.begin() + static_cast<std::ptrdiff_t>(
                               (((k + at[2]) * whole[1] + j + at[1]) * whole[0] + at[0]) * part.components));
}

class ImageReader : public VtkXmlReader {
 public:
  ImageReader() : VtkXmlReader("ImageData") {}

  LatticeData result() {
    std::size_t cells = 0;
    for (const Piece& piece : pieces_) {
      if (!whole_.contains(piece.extent)) throw InvalidInput("has a piece outside of its whole extent");
      cells += product(cells_of(piece.extent));
    }
    if (pieces_.empty() || cells < product(cells_of(whole_)))  // they may overlap
      throw InvalidInput(
          fmt::format("has {} cells in its pieces and {} in all", cells, product(cells_of(whole_))));
    image_.points = whole_.points();
    for (std::size_t c = 0; c < 3; ++c)
      image_.origin[c] += static_cast<double>(whole_.first[c]) * image_.spacing[c];
    join(&LatticeData::arrays, [](const LatticeBox& box) { return box.points(); });
    join(&LatticeData::cell_arrays, cells_of);
    image_.check_sizes();
    return std::move(image_);
  }

 protected:
  void begin_part(std::string_view element, Attributes attributes) override {
    if (element == "ImageData") whole_ = take_lattice(attributes, image_);
    if (element == "Piece") pieces_.push_back({extent_of(attributes, "Extent"), {}});
  }
  void end_part(std::string_view element) override {
    if (element != "Piece") return;
    pieces_.back().data.points = pieces_.back().extent.points();
    pieces_.back().data.check_sizes();
  }
  std::vector<PointArray>* arrays_in(std::string_view element) override {
    if (element == "FieldData") return &image_.fields;
    if (pieces_.empty()) return nullptr;
    if (element == "PointData") return &pieces_.back().data.arrays;
    return element == "CellData" ? &pieces_.back().data.cell_arrays : nullptr;
  }

 private:
  /// The arrays of all pieces; those that a piece lacks are left out. Where no piece is, there is no number.
  void join(std::vector<PointArray> LatticeData::*arrays, Index (*size)(const LatticeBox&)) {
    if (pieces_.size() == 1 && pieces_[0].extent == whole_) {
      image_.*arrays = std::move(pieces_[0].data.*arrays);
      return;
    }
    const Index whole = size(whole_);
    for (PointArray& first : pieces_[0].data.*arrays) {
      const auto lacks = [&](const Piece& piece) { return like(first, piece.data.*arrays) == nullptr; };
      if (std::ranges::any_of(pieces_, lacks)) continue;
      PointArray all{first.name, first.components, {}, first.type};
      all.values.assign(first.components * product(whole), std::numeric_limits<double>::quiet_NaN());
      for (const Piece& piece : pieces_) {
        Index at;
        for (std::size_t c = 0; c < 3; ++c)
          at[c] = static_cast<std::size_t>(piece.extent.first[c] - whole_.first[c]);
        const Index part = size(piece.extent);
        // A piece of a single plane counts as one cell thick, which at the image's end is beyond it.
        for (std::size_t c = 0; c < 3; ++c)
          if (at[c] + part[c] > whole[c]) throw InvalidInput("a piece has cells beyond the whole extent");
        place(*like(first, piece.data.*arrays), part, at, whole, all.values);
      }
      (image_.*arrays).push_back(std::move(all));
    }
  }

  LatticeBox whole_;
  LatticeData image_;
  std::vector<Piece> pieces_;
};

/// What a parallel file says of an image and its pieces.
class ImageListReader : public VtkXmlReader {
 public:
  ImageListReader() : VtkXmlReader("PImageData") {}

  VtkImageList result() {
    if (list_.pieces.empty()) throw InvalidInput("has no pieces");
    return std::move(list_);
  }

 protected:
  void begin_part(std::string_view element, Attributes attributes) override {
    if (element == "PImageData") list_.whole = take_lattice(attributes, list_.lattice);
    if (element == "Piece")
      list_.pieces.push_back({extent_of(attributes, "Extent"), piece_source(attributes)});
  }
  void end_part(std::string_view /*element*/) override {}
  std::vector<PointArray>* arrays_in(std::string_view element) override {
    return element == "FieldData" ? &list_.lattice.fields : nullptr;
  }

 private:
  VtkImageList list_;
};

}  // namespace

VtkImageList parse_vtk_image_list(std::string_view bytes) {
  ImageListReader reader;
  reader.read(bytes);
  return reader.result();
}

LatticeData parse_vtk_image(std::string_view bytes) {
  ImageReader reader;
  reader.read(bytes);
  return reader.result();
}

}  // namespace kappaflow
