#include "tools/io/checkpoint.h"

#include <fmt/format.h>
#include <zlib.h>

#include <sstream>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/saved_state.h"
#include "tools/io/files.h"

namespace kappaflow {
namespace {

constexpr std::string_view kMagic = "kf-state";

/// What stands before the state.
struct CheckpointHeader {
  std::uint32_t format = kCheckpointFormat, checksum = 0;
  std::uint64_t bytes = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(format, checksum, bytes);
  }
};

std::uint32_t checksum_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, std::string_view state) {
  std::ostringstream header;
  StateWriter(header, little_endian())(CheckpointHeader{kCheckpointFormat, checksum_of(state), state.size()});
  write_file_durably(file, {kMagic, header.view(), state});
}

std::string read_checkpoint(const std::filesystem::path& file) {
  std::istringstream bytes(read_file(file));
  std::string magic(kMagic.size(), '\0');
  bytes.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  CheckpointHeader header;
  try {
    StateReader archive(bytes);
    archive(header);
  } catch (const cereal::Exception&) {
    magic.clear();  // the file is too short
  }
  if (magic != kMagic) throw IoError(file.string(), "is not a checkpoint of kappaflow");
  if (header.format != kCheckpointFormat)
    throw InvalidInput({file.string()},
                       fmt::format("a checkpoint of format {}; this version of kappaflow reads format {}",
                                   header.format, kCheckpointFormat));
  const auto begin = static_cast<std::size_t>(bytes.tellg());
  std::string state = std::move(bytes).str().substr(begin);
  if (state.size() != header.bytes || checksum_of(state) != header.checksum)
    throw IoError(file.string(), "the checkpoint is damaged: its checksum does not match");
  return state;
}

}  // namespace kappaflow
