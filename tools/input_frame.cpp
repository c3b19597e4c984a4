#include "tools/input_frame.h"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkDataSetReader.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPointSet.h>
#include <vtkSmartPointer.h>
#include <vtkVariant.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <span>
#include <sstream>
#include <string_view>

#include "core/errors.h"
#include "tools/bgeo_file.h"
#include "tools/files.h"
#include "tools/number_table.h"
#include "tools/vtk_messages.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr int kFluidType = 3;  // DualSPHysics: 0 fixed, 1 moving, 2 floating, 3 fluid
constexpr int kLocalTag = 0;   // PySPH: 0 local, 1 remote, 2 ghost

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// The first array with one of the names and as many components; null where there is none.
vtkDataArray* find_array(vtkFieldData& data, std::initializer_list<std::string_view> names, int components) {
  for (const std::string_view name : names)
    for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
      vtkDataArray* array = data.GetArray(a);
      if (array != nullptr && array->GetName() != nullptr && array->GetNumberOfComponents() == components &&
          lower_case(array->GetName()) == name)
        return array;
    }
  return nullptr;
}

/// Reads by a VTK reader; complaints of VTK's become one line.
template <class Reader>
vtkSmartPointer<vtkPointSet> read_by(Reader& reader, const fs::path& file) {
  const VtkMessages messages;
  reader.SetFileName(file.c_str());
  reader.Update();
  vtkSmartPointer<vtkPointSet> data = vtkPointSet::SafeDownCast(reader.GetOutputDataObject(0));
  if (!messages.first_error().empty())
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", messages.first_error()));
  if (reader.GetErrorCode() != 0 || data == nullptr)
    throw IoError(file.string(), "holds no points that VTK can read");
  return data;
}

/// Throws IoError where the last section of cells ends before it is complete: VTK 9.1 reads past the end of
/// such polydata.
void check_cells(const fs::path& file) {
  const std::string text = read_file(file);
  std::size_t section = 0;
  for (const char* keyword : {"\nVERTICES ", "\nLINES ", "\nPOLYGONS ", "\nTRIANGLE_STRIPS "})
    if (const std::size_t found = text.rfind(keyword); found != std::string::npos)
      section = std::max(section, found + 1);
  if (section == 0 || text.find("\nPOINT_DATA", section) != std::string::npos) return;
  std::istringstream stream(text.substr(section));
  std::string keyword, next;
  std::size_t cells = 0, numbers = 0;
  stream >> keyword >> cells >> numbers;
  std::size_t needed = numbers, present = 0;
  if (text.find("\nBINARY") < section) {
    const bool long_numbers = text.find("OFFSETS vtktypeint64", section) != std::string::npos;  // format 5.1
    needed = long_numbers ? 8 * (cells + numbers) : 4 * numbers;
    present = text.size() - std::min(text.size(), text.find('\n', section));
  } else {
    while (stream >> next) ++present;
  }
  if (numbers == 0 || present < needed)  // a section without numbers is one whose header was cut
    throw IoError(file.string(), fmt::format("is damaged or not complete (its {} end early)", keyword));
}

vtkSmartPointer<vtkPointSet> read_points(const fs::path& file, const std::string& kind) {
  if (kind == ".vtp") return read_by(*vtkSmartPointer<vtkXMLPolyDataReader>::New(), file);
  if (kind == ".vtu") return read_by(*vtkSmartPointer<vtkXMLUnstructuredGridReader>::New(), file);
  check_cells(file);
  const auto reader = vtkSmartPointer<vtkDataSetReader>::New();
  reader->ReadAllScalarsOn();
  reader->ReadAllVectorsOn();
  reader->ReadAllFieldsOn();
  return read_by(*reader, file);
}

/// The components of a vector: of one array, or of three.
struct VectorArrays {
  std::array<vtkDataArray*, 3> array{};
  std::string name;

  Vec3 at(vtkIdType i) const {
    if (array[1] == nullptr) return Vec3(array[0]->GetTuple3(i));
    return {array[0]->GetTuple1(i), array[1]->GetTuple1(i), array[2]->GetTuple1(i)};
  }
};

VectorArrays find_velocity(vtkPointData& data) {
  if (vtkDataArray* array = find_array(data, {"velocity", "velocities", "vel", "v"}, 3))
    return {{array}, array->GetName()};
  constexpr std::array<std::array<std::string_view, 3>, 2> kComponents{{{"vx", "vy", "vz"}, {"u", "v", "w"}}};
  for (const auto& names : kComponents) {
    VectorArrays found{{}, fmt::format("{}", fmt::join(names, ", "))};
    for (int c = 0; c < 3; ++c) found.array[c] = find_array(data, {names[c]}, 1);
    if (std::ranges::count(found.array, nullptr) == 0) return found;
  }
  return {};
}

/// The points that are liquid and belong to this file.
std::vector<vtkIdType> chosen_points(vtkPointSet& points) {
  vtkPointData& data = *points.GetPointData();
  vtkDataArray* type = find_array(data, {"idp"}, 1) != nullptr ? find_array(data, {"type"}, 1) : nullptr;
  vtkDataArray* tag = find_array(data, {"gid"}, 1) != nullptr ? find_array(data, {"tag"}, 1) : nullptr;
  std::vector<vtkIdType> chosen;
  for (vtkIdType i = 0; i < points.GetNumberOfPoints(); ++i)
    if ((type == nullptr || type->GetTuple1(i) == kFluidType) &&
        (tag == nullptr || tag->GetTuple1(i) == kLocalTag))
      chosen.push_back(i);
  return chosen;
}

void copy_scalar(vtkDataArray* array, const std::vector<vtkIdType>& chosen, std::vector<float>& values) {
  if (array == nullptr) return;
  for (const vtkIdType i : chosen) values.push_back(static_cast<float>(array->GetTuple1(i)));
}

InputFrame frame_from_vtk(const fs::path& file, const std::string& kind) {
  const vtkSmartPointer<vtkPointSet> points = read_points(file, kind);
  vtkPointData& data = *points->GetPointData();
  const std::vector<vtkIdType> chosen = chosen_points(*points);
  InputFrame frame;
  frame.left_out = static_cast<std::size_t>(points->GetNumberOfPoints()) - chosen.size();
  for (const vtkIdType i : chosen) frame.position.emplace_back(points->GetPoint(i));
  if (vtkDataArray* id = find_array(data, {"id", "ids", "idp", "gid", "particle_id"}, 1)) {
    frame.id_name = id->GetName();
    for (const vtkIdType i : chosen) frame.id.push_back(id->GetVariantValue(i).ToTypeInt64());
  }
  if (const VectorArrays velocity = find_velocity(data); velocity.array[0] != nullptr) {
    frame.velocity_name = velocity.name;
    for (const vtkIdType i : chosen) frame.velocity.push_back(velocity.at(i));
  }
  copy_scalar(find_array(data, {"density", "rho", "rhop"}, 1), chosen, frame.density);
  copy_scalar(find_array(data, {"pressure", "press", "p"}, 1), chosen, frame.pressure);
  if (vtkDataArray* time = find_array(*points->GetFieldData(), {"timevalue", "time"}, 1);
      time != nullptr && time->GetNumberOfTuples() > 0)
    frame.time = time->GetTuple1(0);
  return frame;
}

std::string first_line(const fs::path& file) {
  std::string text = read_file(file);
  text.resize(std::min(text.find_first_of("\r\n"), text.size()));
  return text;
}

std::int64_t whole_id(double number, const fs::path& file) {
  constexpr double kLargestExact = 9007199254740992;  // 2^53
  if (number != std::floor(number) || std::abs(number) > kLargestExact)
    throw InvalidInput({file.string()}, fmt::format("the id {} is not a whole number below 2^53", number));
  return static_cast<std::int64_t>(number);
}

InputFrame frame_from_csv(const fs::path& file) {
  const std::string header = first_line(file);
  const bool has_id = header.starts_with("id,"), has_velocity = header.ends_with(",vx,vy,vz");
  const std::string expected = fmt::format("{}x,y,z{}", has_id ? "id," : "", has_velocity ? ",vx,vy,vz" : "");
  InputFrame frame;
  const std::size_t x = has_id ? 1 : 0;
  for (const std::vector<double>& row : read_number_table(file, expected)) {
    if (has_id) frame.id.push_back(whole_id(row[0], file));
    frame.position.emplace_back(row[x], row[x + 1], row[x + 2]);
    if (has_velocity) frame.velocity.emplace_back(row[x + 3], row[x + 4], row[x + 5]);
  }
  if (has_id) frame.id_name = "id";
  if (has_velocity) frame.velocity_name = "vx, vy, vz";
  return frame;
}

InputFrame frame_from_bgeo(const fs::path& file) {
  const BgeoPoints points = read_bgeo(file);
  InputFrame frame;
  frame.position = points.position;
  if (const BgeoPoints::Attribute* id = points.find("id", 1)) {
    frame.id_name = id->name;
    for (const double value : id->value) frame.id.push_back(static_cast<std::int64_t>(value));
  }
  for (const char* name : {"velocity", "v"})
    if (const BgeoPoints::Attribute* velocity = points.find(name, 3); velocity && frame.velocity.empty()) {
      frame.velocity_name = velocity->name;
      for (std::size_t i = 0; i < frame.position.size(); ++i)
        frame.velocity.emplace_back(Eigen::Map<const Vec3>(&velocity->value[3 * i]));
    }
  const auto copy = [&](const char* name, std::vector<float>& values) {
    if (const BgeoPoints::Attribute* attribute = points.find(name, 1))
      values.assign(attribute->value.begin(), attribute->value.end());
  };
  copy("density", frame.density);
  copy("pressure", frame.pressure);
  return frame;
}

void check_finite(std::span<const Vec3> values, const char* what, const InputFrame& frame,
                  const fs::path& file) {
  const auto found = std::ranges::find_if_not(values, [](const Vec3& v) { return v.allFinite(); });
  if (found == values.end()) return;
  const std::size_t i = found - values.begin();
  const std::string name = frame.id.empty() ? fmt::format("number {}", i) : fmt::format("{}", frame.id[i]);
  throw InvalidInput({file.string()}, fmt::format("the {} of particle {} is ({}, {}, {}); it must be finite",
                                                  what, name, (*found)[0], (*found)[1], (*found)[2]));
}

}  // namespace

InputFrame read_input_frame(const fs::path& file) {
  const std::string kind = lower_case(file.extension().string());
  const bool vtk = kind == ".vtk" || kind == ".vtp" || kind == ".vtu";
  if (!vtk && kind != ".csv" && kind != ".bgeo")
    throw InvalidInput({file.string()},
                       "unknown kind of particle file; expected .vtk, .vtp, .vtu, .bgeo or .csv");
  check_readable(file);
  InputFrame frame = vtk               ? frame_from_vtk(file, kind)
                     : kind == ".bgeo" ? frame_from_bgeo(file)
                                       : frame_from_csv(file);
  if (frame.position.empty())
    throw InvalidInput(
        {file.string()},
        frame.left_out == 0
            ? std::string("holds no particles")
            : fmt::format("holds no liquid: all {} particles are of walls or ghosts", frame.left_out));
  check_finite(frame.position, "position", frame, file);
  check_finite(frame.velocity, "velocity", frame, file);
  return frame;
}

}  // namespace kappaflow
