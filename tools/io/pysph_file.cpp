// The layout is that of pysph/solver/output.py: particles/NAME/arrays/PROPERTY, and the time as attribute t
// of solver_data.
#include "tools/io/pysph_file.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_scanner.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr hsize_t kMostOfAByte = 1100;  // more than a byte of deflate's expands to

/// Closes what HDF5 opened. Throws InvalidInput where it could not open it.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), std::string_view what) : id_(id), close_(close) {
    if (id < 0) throw InvalidInput(fmt::format("{} cannot be read", what));
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close_(id_); }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

Handle open_group(hid_t parent, const std::string& name) {
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, fmt::format("the group {}", name)};
}

std::vector<std::string> names_in(hid_t group) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0)
    throw InvalidInput("the names in a group cannot be read");
  return names;
}

/// The type of numbers that are stored one after the other; nothing for other types.
std::optional<NumberType> number_type(hid_t type) {
  const std::size_t bytes = H5Tget_size(type);
  if (H5Tget_class(type) == H5T_FLOAT)
    return bytes == 4   ? std::optional(NumberType::float32)
           : bytes == 8 ? std::optional(NumberType::float64)
                        : std::nullopt;
  constexpr std::array kSigned{NumberType::int8, NumberType::int16, NumberType::int32, NumberType::int64},
      kUnsigned{NumberType::uint8, NumberType::uint16, NumberType::uint32, NumberType::uint64};
  if (H5Tget_class(type) != H5T_INTEGER || !std::has_single_bit(bytes) || bytes > 8) return std::nullopt;
  return (H5Tget_sign(type) == H5T_SGN_NONE ? kUnsigned : kSigned)[std::countr_zero(bytes)];
}

/// A row of numbers in a file. HDF5 says where its bytes are; it is not made to unpack them, because it goes
/// beyond its memory where a damaged file says two things about their size.
class Row {
 public:
  Row(hid_t group, const std::string& name, std::string_view file)
      : name_(one_line(name, 30)),
        file_(file),
        set_(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, name_),
        space_(H5Dget_space(set_), H5Sclose, name_),
        type_(H5Dget_type(set_), H5Tclose, name_),
        layout_(H5Dget_create_plist(set_), H5Pclose, name_) {}

  /// Empty for what is no row of numbers.
  std::vector<double> numbers() const {
    const std::optional<NumberType> type = number_type(type_);
    if (!type || H5Sget_simple_extent_ndims(space_) != 1) return {};
    hsize_t count = 0;
    H5Sget_simple_extent_dims(space_, &count, nullptr);
    if (count / kMostOfAByte > file_.size())
      throw InvalidInput(fmt::format("{} has not the {} numbers that it claims", name_, count));
    const std::size_t bytes = bytes_of(*type, count);
    const std::string content = count == 0                              ? ""
                                : H5Pget_layout(layout_) == H5D_CHUNKED ? unpacked(bytes)
                                                                        : contiguous(bytes);
    const bool big = H5Tget_order(type_) == H5T_ORDER_BE;
    return binary_numbers(content, *type, big ? std::endian::big : std::endian::little);
  }

 private:
  std::string contiguous(std::size_t bytes) const {
    const haddr_t begin = H5Dget_offset(set_);
    if (begin > file_.size() || bytes > file_.size() - begin)
      throw InvalidInput(fmt::format("{} lies outside the file", name_));
    return std::string(file_.substr(begin, bytes));
  }

  /// The chunks, which deflate has or has not packed.
  std::string unpacked(std::size_t bytes) const {
    hsize_t length = 0;
    if (H5Pget_chunk(layout_, 1, &length) != 1 || length == 0 || length > file_.size() * 8)
      throw InvalidInput(fmt::format("{} is in no chunks that there can be", name_));
    const int filters = H5Pget_nfilters(layout_);
    unsigned flags = 0;
    std::size_t options = 0;
    const bool deflated = filters == 1 && H5Pget_filter2(layout_, 0, &flags, &options, nullptr, 0, nullptr,
                                                         nullptr) == H5Z_FILTER_DEFLATE;
    if (filters != 0 && !deflated) throw InvalidInput(fmt::format("{} is not packed by gzip", name_));
    const std::size_t chunk = length * H5Tget_size(type_);
    std::string content;
    for (hsize_t begin = 0; content.size() < bytes; begin += length)
      content += deflated ? inflated(chunk_at(begin), chunk) : chunk_at(begin);
    content.resize(bytes);
    return content;
  }

  std::string chunk_at(hsize_t begin) const {
    hsize_t bytes = 0;
    std::uint32_t skipped_filters = 0;
    if (H5Dget_chunk_storage_size(set_, &begin, &bytes) < 0 || bytes == 0 || bytes > file_.size())
      throw InvalidInput(fmt::format("{} lacks the numbers from {} on", name_, begin));
    std::string packed(bytes, '\0');
    if (H5Dread_chunk(set_, H5P_DEFAULT, &begin, &skipped_filters, packed.data()) < 0 || skipped_filters != 0)
      throw InvalidInput(fmt::format("{} cannot be read from {} on", name_, begin));
    return packed;
  }

  std::string inflated(const std::string& packed, std::size_t bytes) const {
    if (bytes / kMostOfAByte > packed.size())
      throw InvalidInput(fmt::format("the compressed data of {} are too short", name_));
    std::string content(bytes, '\0');
    uLongf size = bytes;
    const auto* const from = reinterpret_cast<const Bytef*>(packed.data());
    if (uncompress(reinterpret_cast<Bytef*>(content.data()), &size, from, packed.size()) != Z_OK ||
        size != bytes)
      throw InvalidInput(fmt::format("the compressed data of {} are wrong", name_));
    return content;
  }

  std::string name_;
  std::string_view file_;
  Handle set_, space_, type_, layout_;
};

/// The particles of one array, with every property that there is one number of for each.
PointData particles_in(hid_t particles, const std::string& name, std::string_view file) {
  const Handle array = open_group(particles, name), group = open_group(array, "arrays");
  const auto numbers = [&](const std::string& property) { return Row(group, property, file).numbers(); };
  PointData points;
  const std::vector<double> x = numbers("x"), y = numbers("y"), z = numbers("z");
  if (y.size() != x.size() || z.size() != x.size())
    throw InvalidInput(fmt::format("has {}, {} and {} coordinates x, y and z", x.size(), y.size(), z.size()));
  for (std::size_t i = 0; i < x.size(); ++i) points.position.emplace_back(x[i], y[i], z[i]);
  for (const std::string& property : names_in(group))
    if (std::vector<double> values = numbers(property); values.size() == x.size())
      points.arrays.push_back({property, 1, std::move(values)});
  return points;
}

/// What both have, one after the other.
PointData joined(PointData first, PointData second) {
  first.position.insert(first.position.end(), second.position.begin(), second.position.end());
  std::erase_if(first.arrays, [&](PointArray& array) {
    const auto same = std::ranges::find(second.arrays, array.name, &PointArray::name);
    if (same == second.arrays.end()) return true;
    array.values.insert(array.values.end(), same->values.begin(), same->values.end());
    return false;
  });
  return first;
}

std::vector<std::string> liquids_of(std::vector<std::string> names) {
  if (names.size() == 1) return names;
  std::vector<std::string> liquids;
  for (const std::string& name : names)
    for (const std::string_view word : {"fluid", "liquid", "water"})
      if (lower_case(name).find(word) != std::string::npos) {
        liquids.push_back(name);
        break;
      }
  return liquids;
}

/// The time of the solver's data; nothing where there is none.
std::vector<PointArray> time_in(hid_t file) {
  const Handle solver = open_group(file, "solver_data");
  if (H5Aexists(solver, "t") <= 0) return {};
  const Handle time(H5Aopen(solver, "t", H5P_DEFAULT), H5Aclose, "the time"),
      space(H5Aget_space(time), H5Sclose, "the time"), type(H5Aget_type(time), H5Tclose, "the time");
  double value = 0;
  if (H5Sget_simple_extent_npoints(space) != 1 || !number_type(type) ||
      H5Aread(time, H5T_NATIVE_DOUBLE, &value) < 0)
    throw InvalidInput("the time cannot be read");
  return {{"time", 1, {value}}};
}

std::uint64_t number_at(std::string_view bytes, std::uint64_t at) {
  if (at > bytes.size() || bytes.size() - at < 8) throw InvalidInput("a heap of names lies outside the file");
  std::uint64_t number = 0;
  for (std::size_t i = 8; i > 0; --i) number = number << 8 | static_cast<unsigned char>(bytes[at + i - 1]);
  return number;
}

/// Throws InvalidInput where the free places of a heap of names go round in a circle, as HDF5 1.10 then does.
void check_heaps(std::string_view bytes) {
  constexpr std::string_view kMark("HEAP\0\0\0\0", 8);
  constexpr std::uint64_t kNone = 1, kLeastPlace = 16;
  for (std::size_t heap = bytes.find(kMark); heap != bytes.npos; heap = bytes.find(kMark, heap + 1)) {
    const std::uint64_t names = number_at(bytes, heap + 24);
    std::uint64_t left = number_at(bytes, heap + 8) / kLeastPlace;
    for (std::uint64_t free = number_at(bytes, heap + 16); free != kNone;
         free = number_at(bytes, names + free))
      if (left-- == 0) throw InvalidInput("a heap of names has no end");
  }
}

PointData liquid_in(std::string& bytes, const fs::path& file) {
  check_heaps(bytes);
  const Handle memory(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "HDF5");
  H5Pset_fapl_core(memory, bytes.size(), false);
  H5Pset_file_image(memory, bytes.data(), bytes.size());
  const fs::path nowhere = file / "bytes";  // HDF5 opens bytes only under a name that no file has
  const Handle opened(H5Fopen(nowhere.c_str(), H5F_ACC_RDONLY, memory), H5Fclose, "HDF5");
  const Handle particles = open_group(opened, "particles");
  const std::vector<std::string> names = names_in(particles), liquids = liquids_of(names);
  if (liquids.empty())
    throw IoError(
        file.string(),
        fmt::format("which of its particles ({}) are liquid is not known; expected a name with fluid, "
                    "liquid or water, or only one (tools/pysph/to_vtk.py takes any)",
                    one_line(fmt::format("{}", fmt::join(names, ", ")), 60)));
  PointData points = particles_in(particles, liquids.front(), bytes);
  for (std::size_t l = 1; l < liquids.size(); ++l)
    points = joined(std::move(points), particles_in(particles, liquids[l], bytes));
  points.fields = time_in(opened);
  return points;
}

}  // namespace

PointData read_pysph(const fs::path& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // its own messages take a screen
  std::string bytes = read_file(file);
  try {
    return liquid_in(bytes, file);
  } catch (const InvalidInput& error) {
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
}

}  // namespace kappaflow
