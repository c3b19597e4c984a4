#include "tools/io/bgeo_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string_view>

#include "core/errors.h"
#include "core/text_scanner.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBgeoMagic = "BgeoV";
constexpr std::uint32_t kVersion = 5;
enum AttributeType : std::uint32_t { kFloat = 0, kInteger = 1, kString = 4, kVector = 5 };

/// Big-endian numbers of a file that may be compressed.
class BigEndianReader {
 public:
  explicit BigEndianReader(const fs::path& file) : file_(file), stream_(gzopen(file.c_str(), "rb")) {
    if (stream_ == nullptr)
      throw IoError(file.string(), fmt::format("cannot be read ({})", std::strerror(errno)));
  }

  std::string text(std::size_t length) {
    std::string result(length, '\0');
    read(result.data(), length);
    return result;
  }
  std::uint16_t short_number() {
    std::array<unsigned char, 2> bytes{};
    read(bytes.data(), bytes.size());
    return static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
  }
  std::uint32_t number() {
    const std::uint32_t high = short_number();
    return high << 16 | short_number();
  }
  float real() { return std::bit_cast<float>(number()); }

  [[noreturn]] void fail(const std::string& why) const {
    throw IoError(file_.string(), fmt::format("is damaged or not complete ({})", why));
  }

 private:
  void read(void* to, std::size_t bytes) {
    if (gzread(stream_.get(), to, static_cast<unsigned>(bytes)) == static_cast<int>(bytes)) return;
    int error = Z_OK;
    gzerror(stream_.get(), &error);
    if (error == Z_ERRNO)
      throw IoError(file_.string(), fmt::format("cannot be read ({})", std::strerror(errno)));
    fail(error == Z_DATA_ERROR ? "its compressed data are wrong" : "it ends early");
  }

  struct Close {
    void operator()(gzFile_s* stream) const { gzclose(stream); }
  };
  const fs::path& file_;
  std::unique_ptr<gzFile_s, Close> stream_;
};

/// What the file says of one attribute.
struct Definition {
  std::string name;
  std::size_t components;
  std::uint32_t type;
};

Definition read_definition(BigEndianReader& in) {
  Definition definition;
  definition.name = in.text(in.short_number());
  definition.components = in.short_number();
  definition.type = in.number();
  switch (definition.type) {
    case kFloat:
    case kInteger:
    case kVector:
      for (std::size_t c = 0; c < definition.components; ++c) in.number();  // the default
      break;
    case kString:
      for (std::uint32_t n = in.number(); n > 0; --n) in.text(in.short_number());
      break;
    default:
      in.fail(fmt::format("attribute \"{}\" is of the unknown type {}", one_line(definition.name, 30),
                          definition.type));
  }
  return definition;
}

}  // namespace

PointData read_bgeo(const fs::path& file) {
  BigEndianReader in(file);
  if (in.text(kBgeoMagic.size()) != kBgeoMagic) throw IoError(file.string(), "is no .bgeo file of version 5");
  if (const std::uint32_t version = in.number(); version != kVersion)
    throw IoError(file.string(), fmt::format("is of version {}; .bgeo is read in version 5", version));
  const std::uint32_t points = in.number();
  in.number();  // primitives
  in.number();  // groups of points
  in.number();  // groups of primitives
  const std::uint32_t count = in.number();
  for (int other = 0; other < 3; ++other) in.number();  // attributes of vertices, primitives, the file
  std::vector<Definition> definitions;
  for (std::uint32_t a = 0; a < count; ++a) definitions.push_back(read_definition(in));

  // Nothing is set aside for as many points as the file claims: it may be damaged.
  PointData result;
  for (const Definition& d : definitions) result.arrays.push_back({d.name, d.components, {}});
  for (std::uint32_t p = 0; p < points; ++p) {
    const double x = in.real(), y = in.real(), z = in.real();
    result.position.emplace_back(x, y, z);
    in.real();  // w
    for (std::size_t a = 0; a < definitions.size(); ++a)
      for (std::size_t c = 0; c < definitions[a].components; ++c) {
        const std::uint32_t bits = in.number();
        const bool real = definitions[a].type == kFloat || definitions[a].type == kVector;
        result.arrays[a].values.push_back(real ? static_cast<double>(std::bit_cast<float>(bits))
                                               : static_cast<double>(std::bit_cast<std::int32_t>(bits)));
      }
  }
  return result;
}

}  // namespace kappaflow
