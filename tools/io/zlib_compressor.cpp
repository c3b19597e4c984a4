#include "tools/io/zlib_compressor.h"

#include <libdeflate.h>
#include <vtkObjectFactory.h>

#include <new>

namespace kappaflow {

vtkStandardNewMacro(ZLibCompressor);

void ZLibCompressor::Free::operator()(libdeflate_compressor* compressor) const {
  libdeflate_free_compressor(compressor);
}

void ZLibCompressor::Free::operator()(libdeflate_decompressor* decompressor) const {
  libdeflate_free_decompressor(decompressor);
}

libdeflate_compressor& ZLibCompressor::compressor() {
  constexpr int kFastest = 1;
  if (compressor_ == nullptr) compressor_.reset(libdeflate_alloc_compressor(kFastest));
  if (compressor_ == nullptr) throw std::bad_alloc();
  return *compressor_;
}

std::size_t ZLibCompressor::GetMaximumCompressionSpace(std::size_t size) {
  return libdeflate_zlib_compress_bound(&compressor(), size);
}

std::size_t ZLibCompressor::CompressBuffer(const unsigned char* from, std::size_t size, unsigned char* to,
                                           std::size_t room) {
  return libdeflate_zlib_compress(&compressor(), from, size, to, room);
}

std::size_t ZLibCompressor::UncompressBuffer(const unsigned char* from, std::size_t packed, unsigned char* to,
                                             std::size_t size) {
  if (decompressor_ == nullptr) decompressor_.reset(libdeflate_alloc_decompressor());
  if (decompressor_ == nullptr) throw std::bad_alloc();
  const auto result = libdeflate_zlib_decompress(decompressor_.get(), from, packed, to, size, nullptr);
  return result == LIBDEFLATE_SUCCESS ? size : 0;
}

}  // namespace kappaflow
