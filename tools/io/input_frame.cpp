#include "tools/io/input_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>

#include "core/errors.h"
#include "core/text_scanner.h"
#include "tools/io/bgeo_file.h"
#include "tools/io/number_table.h"
#include "tools/io/parallel_vtk.h"
#include "tools/io/point_data.h"
#include "tools/io/pysph_file.h"
#include "tools/io/vtk_points.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr int kFluidType = 3;  // DualSPHysics: 0 fixed, 1 moving, 2 floating, 3 fluid
constexpr int kLocalTag = 0;   // PySPH: 0 local, 1 remote, 2 ghost
constexpr int kNoGhost = 0;    // VTK: of points 1 duplicate, 2 hidden; in older files how far from the piece

using VectorNames = std::array<std::string_view, 3>;
constexpr VectorNames kPositionNames{"x", "y", "z"};
constexpr std::array<VectorNames, 2> kVelocityNames{{{"vx", "vy", "vz"}, {"u", "v", "w"}}};
const std::initializer_list<std::string_view> kRadiusNames{"radius", "particle_radius", "pscale"};
const std::initializer_list<std::string_view> kIdNames{"id", "ids", "idp", "gid", "particle_id"};

/// The components of a vector: of one array, or of three.
struct VectorArrays {
  std::array<const PointArray*, 3> array{};
  std::string name;

  Vec3 at(std::size_t i) const {
    if (array[1] == nullptr) return Vec3(&array[0]->values[3 * i]);
    return {array[0]->values[i], array[1]->values[i], array[2]->values[i]};
  }
};

VectorArrays find_velocity(const std::vector<PointArray>& arrays) {
  if (const PointArray* array = find_array(arrays, {"velocity", "velocities", "vel", "v"}, 3))
    return {{array}, array->name};
  for (const VectorNames& names : kVelocityNames) {
    VectorArrays found{{}, fmt::format("{}", fmt::join(names, ", "))};
    for (std::size_t c = 0; c < 3; ++c) found.array[c] = find_array(arrays, {names[c]}, 1);
    if (std::ranges::count(found.array, nullptr) == 0) return found;
  }
  return {};
}

/// The points that are liquid and belong to this file.
std::vector<std::size_t> chosen_points(const PointData& data) {
  const auto& arrays = data.arrays;
  const PointArray* type =
      find_array(arrays, {"idp"}, 1) != nullptr ? find_array(arrays, {"type"}, 1) : nullptr;
  const PointArray* tag =
      find_array(arrays, {"gid"}, 1) != nullptr ? find_array(arrays, {"tag"}, 1) : nullptr;
  const PointArray* ghost = find_array(arrays, {"vtkghosttype", "vtkghostlevels"}, 1);
  const auto is = [](const PointArray* array, std::size_t i, int value) {
    return array == nullptr || array->values[i] == value;
  };
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < data.position.size(); ++i)
    if (is(type, i, kFluidType) && is(tag, i, kLocalTag) && is(ghost, i, kNoGhost)) chosen.push_back(i);
  return chosen;
}

std::int64_t whole_id(double number, const fs::path& file) {
  constexpr double kEndOfExact = 9007199254740992;  // 2^53
  if (number != std::floor(number) || !(std::abs(number) < kEndOfExact))
    throw InvalidInput({file.string()}, fmt::format("the id {} is not a whole number below 2^53", number));
  return static_cast<std::int64_t>(number);
}

void copy_scalar(const PointArray* array, const std::vector<std::size_t>& chosen,
                 std::vector<float>& values) {
  if (array == nullptr) return;
  for (const std::size_t i : chosen) values.push_back(static_cast<float>(array->values[i]));
}

/// Nothing where one of them is no whole number: then the array is something else, say a source of heat.
void copy_names(const PointArray* array, const std::vector<std::size_t>& chosen, std::vector<int>& names) {
  constexpr double kLargest = std::numeric_limits<int>::max();
  if (array == nullptr) return;
  const auto is_name = [&](std::size_t i) {
    const double x = array->values[i];
    return x == std::floor(x) && std::abs(x) <= kLargest;
  };
  if (!std::ranges::all_of(chosen, is_name)) return;
  for (const std::size_t i : chosen) names.push_back(static_cast<int>(array->values[i]));
}

/// PySPH calls the smoothing length h, which elsewhere may be a height. kappaflow's own files have sigma,
/// which says something where it is not the same for all.
const PointArray* find_radius(const std::vector<PointArray>& arrays) {
  if (const PointArray* radius = find_array(arrays, kRadiusNames, 1)) return radius;
  if (find_array(arrays, {"gid"}, 1) != nullptr) return find_array(arrays, {"h"}, 1);
  const PointArray* sigma = find_array(arrays, {"sigma"}, 1);
  if (sigma == nullptr ||
      std::ranges::adjacent_find(sigma->values, std::not_equal_to()) == sigma->values.end())
    return nullptr;
  return sigma;
}

/// An array that goes by the name of ids or velocities and cannot be them is a mistake, not another quantity.
void check_components(const std::vector<PointArray>& arrays, std::initializer_list<std::string_view> names,
                      std::size_t components, const fs::path& file) {
  if (find_array(arrays, names, components) != nullptr) return;
  for (const PointArray& array : arrays)
    if (find_array(arrays, names, array.components) == &array)
      throw InvalidInput({file.string()}, fmt::format("array \"{}\" has {} components; expected {}",
                                                      array.name, array.components, components));
}

InputFrame frame_from_points(const PointData& points, const fs::path& file) {
  const std::vector<PointArray>& arrays = points.arrays;
  check_components(arrays, kIdNames, 1, file);
  check_components(arrays, {"velocity", "velocities", "vel"}, 3, file);
  const std::vector<std::size_t> chosen = chosen_points(points);
  InputFrame frame;
  frame.left_out = points.position.size() - chosen.size();
  for (const std::size_t i : chosen) frame.position.push_back(points.position[i]);
  if (const PointArray* id = find_array(arrays, kIdNames, 1)) {
    frame.id_name = id->name;
    for (const std::size_t i : chosen) frame.id.push_back(whole_id(id->values[i], file));
  }
  if (const VectorArrays velocity = find_velocity(arrays); velocity.array[0] != nullptr) {
    frame.velocity_name = velocity.name;
    for (const std::size_t i : chosen) frame.velocity.push_back(velocity.at(i));
  }
  copy_scalar(find_array(arrays, {"density", "rho", "rhop"}, 1), chosen, frame.density);
  copy_scalar(find_array(arrays, {"pressure", "press", "p"}, 1), chosen, frame.pressure);
  copy_scalar(find_array(arrays, {"temperature", "temp"}, 1), chosen, frame.temperature);
  copy_names(find_array(arrays, {"source"}, 1), chosen, frame.source);
  if (const PointArray* radius = find_radius(arrays)) {
    frame.radius_name = radius->name;
    for (const std::size_t i : chosen) frame.radius.push_back(radius->values[i]);
  }
  frame.time = time_in(points.fields);
  return frame;
}

/// Where the velocities' columns are; nowhere where there are none. Two of three are a mistake.
std::vector<std::size_t> velocity_columns(const NumberTable& table) {
  const auto is_there = [&](std::string_view name) { return !table.find({&name, 1}).empty(); };
  std::vector<std::size_t> columns = table.find(kVelocityNames[0]);
  if (!columns.empty()) return columns;
  if (std::ranges::any_of(kVelocityNames[0], is_there)) table.refuse_header();
  return table.find(kVelocityNames[1]);
}

InputFrame frame_from_csv(const fs::path& file) {
  const NumberTable table(
      file, "x,y,z or id,x,y,z or x,y,z,vx,vy,vz or id,x,y,z,vx,vy,vz, in any order, perhaps among others");
  InputFrame frame;
  std::vector<std::size_t> columns = table.find(kPositionNames);
  if (columns.empty()) table.refuse_header();
  const std::vector<std::size_t> velocity = velocity_columns(table);
  for (const std::size_t column : velocity) columns.push_back(column);
  const auto add_first = [&](std::initializer_list<std::string_view> names, std::string& found) {
    for (const std::string_view name : names)
      if (const std::vector<std::size_t> column = table.find({&name, 1}); !column.empty() && found.empty()) {
        found = name;
        columns.push_back(column[0]);
      }
    return columns.size() - 1;
  };
  const std::size_t id = add_first(kIdNames, frame.id_name),
                    radius = add_first(kRadiusNames, frame.radius_name);
  for (const std::vector<double>& row : table.rows(columns)) {
    frame.position.emplace_back(row[0], row[1], row[2]);
    if (!velocity.empty()) frame.velocity.emplace_back(row[3], row[4], row[5]);
    if (!frame.id_name.empty()) frame.id.push_back(whole_id(row[id], file));
    if (!frame.radius_name.empty()) frame.radius.push_back(row[radius]);
  }
  if (!velocity.empty())
    frame.velocity_name = fmt::format(
        "{}",
        fmt::join(velocity == table.find(kVelocityNames[0]) ? kVelocityNames[0] : kVelocityNames[1], ", "));
  return frame;
}

bool is_finite(const Vec3& v) {
  return v.allFinite();
}
bool is_finite(double x) {
  return std::isfinite(x);
}
std::string text_of(const Vec3& v) {
  return fmt::format("({}, {}, {})", v[0], v[1], v[2]);
}
std::string text_of(double x) {
  return fmt::format("{}", x);
}

template <class Value>
void check_finite(const std::vector<Value>& values, const char* what, const InputFrame& frame,
                  const fs::path& file) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (is_finite(values[i])) continue;
    const std::string name = frame.id.empty() ? fmt::format("number {}", i) : fmt::format("{}", frame.id[i]);
    throw InvalidInput({file.string()}, fmt::format("the {} of particle {} is {}; it must be finite", what,
                                                    name, text_of(values[i])));
  }
}

/// The particles of one file, of which there may be none.
InputFrame read_piece(const fs::path& file) {
  const std::string kind = lower_case(file.extension().string());
  if (kind == ".npz")
    throw InvalidInput({file.string()}, "is NumPy's; tools/pysph/to_vtk.py writes its particles as .vtk");
  if (!is_particle_file(file))
    throw InvalidInput({file.string()},
                       fmt::format("unknown kind of particle file; expected {}", kParticleFileKinds));
  InputFrame frame = kind == ".csv"    ? frame_from_csv(file)
                     : kind == ".bgeo" ? frame_from_points(read_bgeo(file), file)
                     : kind == ".hdf5" ? frame_from_points(read_pysph(file), file)
                                       : frame_from_points(read_vtk_points(file), file);
  check_finite(frame.position, "position", frame, file);
  check_finite(frame.velocity, "velocity", frame, file);
  check_finite(frame.density, "density", frame, file);
  check_finite(frame.pressure, "pressure", frame, file);
  check_finite(frame.radius, "radius", frame, file);
  if (const auto bad = std::ranges::find_if(frame.radius, [](double r) { return r <= 0; });
      bad != frame.radius.end())
    throw InvalidInput({file.string()},
                       fmt::format("a particle has the {} {}; it must be positive", frame.radius_name, *bad));
  if (frame.time && !std::isfinite(*frame.time))
    throw InvalidInput({file.string()}, fmt::format("its time is {} s; it must be finite", *frame.time));
  return frame;
}

/// What the pieces of a frame must have in common.
class CommonOfPieces {
 public:
  /// Throws InvalidInput where the piece differs from those before.
  void add(const InputFrame& piece, const fs::path& file) {
    left_out_ += piece.left_out;
    if (piece.time && timed_.empty()) {
      timed_ = file;
      time_ = *piece.time;
    }
    if (piece.time && *piece.time != time_)
      throw InvalidInput({file.string()},
                         fmt::format("its time is {} s; that of {}, a piece of the same frame, "
                                     "is {} s",
                                     *piece.time, timed_.string(), time_));
    if (piece.position.empty()) return;
    const std::array<bool, kNames.size()> has{!piece.id.empty(),          !piece.velocity.empty(),
                                              !piece.density.empty(),     !piece.pressure.empty(),
                                              !piece.temperature.empty(), !piece.radius.empty()};
    if (first_.empty()) {
      first_ = file;
      has_ = has;
    }
    for (std::size_t a = 0; a < has.size(); ++a)
      if (has[a] != has_[a])
        throw InvalidInput({(has[a] ? first_ : file).string()},
                           fmt::format("has no {}; {}, a piece of the same frame, has", kNames[a],
                                       (has[a] ? file : first_).string()));
  }

  /// Throws InvalidInput where no piece has a particle.
  void check_any(const fs::path& frame) const {
    if (!first_.empty()) return;
    throw InvalidInput(
        {frame.string()},
        left_out_ == 0 ? std::string("holds no particles")
                       : fmt::format("holds no liquid: all {} particles are of walls or ghosts", left_out_));
  }

 private:
  static constexpr std::array<const char*, 6> kNames{"ids",       "velocities",   "densities",
                                                     "pressures", "temperatures", "radii"};
  fs::path first_, timed_;  // the first with particles, and with a time
  std::array<bool, kNames.size()> has_{};
  double time_ = 0;
  std::size_t left_out_ = 0;
};

void append(InputFrame&& piece, InputFrame& frame) {
  const std::size_t left_out = frame.left_out + piece.left_out;
  const std::optional<double> time = frame.time ? frame.time : piece.time;
  if (frame.position.empty()) {
    frame = std::move(piece);
  } else if (!piece.position.empty()) {
    // Sources that are whole numbers in some of the pieces only are something else.
    if (frame.source.size() != frame.position.size() || piece.source.size() != piece.position.size()) {
      frame.source.clear();
      piece.source.clear();
    }
    for_each_array(piece, frame,
                   [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); });
  }
  frame.left_out = left_out;
  frame.time = time;
}

}  // namespace

bool is_particle_file(const fs::path& file) {
  static constexpr std::array<std::string_view, 8> kKinds{".vtk",  ".vtp",  ".vtu",  ".pvtp",
                                                          ".pvtu", ".bgeo", ".hdf5", ".csv"};
  return std::ranges::count(kKinds, lower_case(file.extension().string())) > 0;
}

void for_each_piece(std::span<const fs::path> files, const std::function<void(InputFrame&& piece)>& take) {
  CommonOfPieces common;
  for (const fs::path& file : files)
    for (const fs::path& piece : pieces_of(file)) {
      InputFrame read = read_piece(piece);
      common.add(read, piece);
      take(std::move(read));
    }
  common.check_any(files.front());
}

InputFrame read_input_frame(std::span<const fs::path> files) {
  InputFrame frame;
  for_each_piece(files, [&](InputFrame&& piece) { append(std::move(piece), frame); });
  // With a number that is not finite it is something else, or not known everywhere.
  if (!std::ranges::all_of(frame.temperature, [](float t) { return std::isfinite(t); }))
    frame.temperature.clear();
  frame.all = frame.position.size();
  return frame;
}

InputFrame read_input_frame(const fs::path& file) {
  return read_input_frame({&file, 1});
}

}  // namespace kappaflow
