// Points with named arrays of numbers, as particle files of several formats hold them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace kappaflow {

enum class NumberType { bit, int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

struct PointArray {
  std::string name;
  std::size_t components = 1;
  std::vector<double> values;             ///< components numbers a tuple; whole ones are exact below 2^53
  NumberType type = NumberType::float64;  ///< in the file, where its reader says so
};

struct PointData {
  std::vector<Vec3> position;
  std::vector<PointArray> arrays;  ///< a tuple a point
  std::vector<PointArray> fields;  ///< numbers of the whole file

  /// Throws InvalidInput where an array does not have one tuple a point.
  void check_sizes() const;
};

/// Polygons one after the other: polygon p has the points corner[end[p - 1]] up to corner[end[p]].
struct PolygonList {
  std::vector<int> corner;
  std::vector<std::size_t> end;
};

/// Points in rows on a lattice, along x first.
struct LatticeData {
  std::array<std::size_t, 3> points{};    ///< along x, y, z
  Vec3 origin = Vec3::Zero();             ///< of the first point
  Vec3 spacing = Vec3::Ones();            ///< between points
  bool turned = false;                    ///< whether its axes are others than x, y, z
  std::vector<PointArray> arrays{};       ///< a tuple a point
  std::vector<PointArray> cell_arrays{};  ///< a tuple a cell
  std::vector<PointArray> fields{};       ///< numbers of the whole file

  /// Along x, y, z; where there is one point, one as well, as VTK counts.
  std::array<std::size_t, 3> cells() const;
  /// Throws InvalidInput where an array does not have one tuple a point or a cell.
  void check_sizes() const;
};

/// The first array with one of the names, given in lower case, and as many components; null where there is
/// none.
const PointArray* find_array(const std::vector<PointArray>& arrays,
                             std::initializer_list<std::string_view> names, std::size_t components);

/// What the field array TimeValue or time says [s]; may be any number.
std::optional<double> time_in(const std::vector<PointArray>& fields);

/// Adds the triangles of the strip to the list.
void add_strip(std::span<const int> strip, PolygonList& polygons);

/// Throws InvalidInput unless the number is one of `points`.
int checked_corner(double number, std::size_t points);

/// How many bytes `count` numbers take. Bits are packed.
std::size_t bytes_of(NumberType type, std::size_t count);

/// The numbers in binary data; of bits, eight for each byte.
std::vector<double> binary_numbers(std::string_view bytes, NumberType type, std::endian order);

/// The number that a word is, nan and inf included. Throws InvalidInput.
double number_from(std::string_view word);

}  // namespace kappaflow
