// Binary numbers in VTK XML files.
#pragma once

#include <bit>
#include <string>
#include <string_view>
#include <vector>

#include "tools/io/point_data.h"

namespace kappaflow {

/// What the element VTKFile says of all binary data of a file.
struct DataEncoding {
  std::endian order = std::endian::little;
  bool long_header = false;  ///< sizes are of 8 bytes, not 4
  std::string compressor;    ///< VTK's name; empty: not compressed
};

/// The numbers of the array that `text` begins with; what follows it is not read. base64: or as they are.
/// Not compressed: the number of bytes, and the bytes. Compressed: the number of blocks, the size of a block,
/// the size of the last one (0: as the others), the compressed size of each, and the blocks. Throws
/// InvalidInput.
std::vector<double> encoded_numbers(std::string_view text, bool base64, NumberType type,
                                    const DataEncoding& encoding);

}  // namespace kappaflow
