// Against VTK's own compressor, which is zlib.
#include "tools/io/zlib_compressor.h"

#include <gtest/gtest.h>
#include <vtkNew.h>

#include <numeric>
#include <random>
#include <vector>

namespace kappaflow {
namespace {

using Bytes = std::vector<unsigned char>;

Bytes packed(vtkDataCompressor& compressor, const Bytes& bytes) {
  Bytes result(compressor.GetMaximumCompressionSpace(bytes.size()));
  result.resize(compressor.Compress(bytes.data(), bytes.size(), result.data(), result.size()));
  return result;
}

/// Empty where there is an error.
Bytes unpacked(vtkDataCompressor& compressor, const Bytes& bytes, std::size_t size) {
  Bytes result(size);
  result.resize(compressor.Uncompress(bytes.data(), bytes.size(), result.data(), size));
  return result;
}

std::vector<Bytes> samples() {
  std::vector<Bytes> result{Bytes(1, 7), Bytes(32768, 0), Bytes(32768), Bytes(32768)};
  std::iota(result[2].begin(), result[2].end(), static_cast<unsigned char>(0));
  std::mt19937 random(5);
  for (unsigned char& b : result[3]) b = static_cast<unsigned char>(random());  // grows
  return result;
}

TEST(ZLibCompressor, ZlibReadsWhatItWritesAndItReadsWhatZlibWrites) {
  vtkNew<ZLibCompressor> ours;
  vtkNew<vtkZLibDataCompressor> zlib;
  for (const Bytes& bytes : samples()) {
    EXPECT_EQ(unpacked(*zlib, packed(*ours, bytes), bytes.size()), bytes);
    EXPECT_EQ(unpacked(*ours, packed(*zlib, bytes), bytes.size()), bytes);
  }
}

TEST(ZLibCompressor, IsZlibToThoseWhoAsk) {
  EXPECT_STREQ(vtkNew<ZLibCompressor>()->GetClassName(), "vtkZLibDataCompressor");
}

TEST(ZLibCompressor, DamagedDataAndWrongSizesAreErrors) {
  vtkNew<ZLibCompressor> ours;
  const Bytes bytes = samples()[2], whole = packed(*ours, bytes);
  EXPECT_EQ(unpacked(*ours, whole, bytes.size() - 1), Bytes());
  EXPECT_EQ(unpacked(*ours, whole, bytes.size() + 1), Bytes());
  EXPECT_EQ(unpacked(*ours, Bytes(whole.begin(), whole.end() - 5), bytes.size()), Bytes());
  Bytes damaged = whole;
  damaged.back() ^= 1;  // of the check sum
  EXPECT_EQ(unpacked(*ours, damaged, bytes.size()), Bytes());
}

}  // namespace
}  // namespace kappaflow
