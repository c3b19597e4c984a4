#include "tools/io/zlib_compressor.h"

#include <libdeflate.h>
#include <vtkObjectFactory.h>

#include <algorithm>
#include <new>

namespace kappaflow {

vtkStandardNewMacro(ZLibCompressor);

void ZLibCompressor::Free::operator()(libdeflate_compressor* compressor) const {
  libdeflate_free_compressor(compressor);
}

void ZLibCompressor::Free::operator()(libdeflate_decompressor* decompressor) const {
  libdeflate_free_decompressor(decompressor);
}

libdeflate_compressor& ZLibCompressor::compressor(Compressor& of, int level) {
  if (of == nullptr) of.reset(libdeflate_alloc_compressor(level));
  if (of == nullptr) throw std::bad_alloc();
  return *of;
}

std::size_t ZLibCompressor::GetMaximumCompressionSpace(std::size_t size) {
  return std::max(libdeflate_zlib_compress_bound(&fastest(), size),
                  libdeflate_zlib_compress_bound(&storing(), size));
}

/// By a sample from the middle.
bool ZLibCompressor::hardly_compresses(const unsigned char* from, std::size_t size, unsigned char* to,
                                       std::size_t room) {
  constexpr std::size_t kSample = 2048;
  constexpr double kHardly = 0.9;
  if (size < 2 * kSample) return false;
  const std::size_t packed =
      libdeflate_zlib_compress(&fastest(), from + (size - kSample) / 2, kSample, to, room);
  return static_cast<double>(packed) > kHardly * kSample;
}

std::size_t ZLibCompressor::CompressBuffer(const unsigned char* from, std::size_t size, unsigned char* to,
                                           std::size_t room) {
  libdeflate_compressor& chosen = hardly_compresses(from, size, to, room) ? storing() : fastest();
  return libdeflate_zlib_compress(&chosen, from, size, to, room);
}

std::size_t ZLibCompressor::UncompressBuffer(const unsigned char* from, std::size_t packed, unsigned char* to,
                                             std::size_t size) {
  if (decompressor_ == nullptr) decompressor_.reset(libdeflate_alloc_decompressor());
  if (decompressor_ == nullptr) throw std::bad_alloc();
  const auto result = libdeflate_zlib_decompress(decompressor_.get(), from, packed, to, size, nullptr);
  return result == LIBDEFLATE_SUCCESS ? size : 0;
}

}  // namespace kappaflow
