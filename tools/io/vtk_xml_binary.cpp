#include "tools/io/vtk_xml_binary.h"

#include <fmt/format.h>
#include <vtkCallbackCommand.h>
#include <vtkLZ4DataCompressor.h>
#include <vtkLZMADataCompressor.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/errors.h"
#include "core/text_scanner.h"
#include "tools/io/zlib_compressor.h"

namespace kappaflow {
namespace {

/// No compressor of VTK's makes blocks smaller by more than this factor; a damaged size can.
constexpr std::size_t kMostCompressed = 8192;

[[noreturn]] void fail_short() {
  throw InvalidInput("has binary data that end early");
}

constexpr int kNoDigit = -1, kPadding = -2;

constexpr int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return c == '=' ? kPadding : kNoDigit;
}

/// Of every character; negative where it is no digit.
constexpr auto kDigits = [] {
  std::array<std::int8_t, 256> digits{};
  for (int c = 0; c < 256; ++c)
    digits[static_cast<std::size_t>(c)] = static_cast<std::int8_t>(base64_digit(static_cast<char>(c)));
  return digits;
}();

int digit_of(char c) {
  return kDigits[static_cast<unsigned char>(c)];
}

/// Bytes one after the other, decoded as they are asked for, and each valid until the next: several pieces of
/// base64, each padded to four characters, may follow one another.
class Bytes {
 public:
  Bytes(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  std::string_view read(std::size_t count) {
    if (count > at_most()) fail_short();
    if (!base64_) {
      const std::string_view result = text_.substr(0, count);
      text_.remove_prefix(count);
      return result;
    }
    decoded_.erase(0, read_);
    while (decoded_.size() < count) {
      decode_digits(count);
      if (decoded_.size() < count) decode_four();
    }
    read_ = count;
    return std::string_view(decoded_).substr(0, count);
  }
  std::size_t at_most() const { return text_.size() + decoded_.size() - read_; }

 private:
  /// Of the digits that come next as many groups of four as make up `count` bytes: nearly all of a text, and
  /// ten times as fast as one by one.
  void decode_digits(std::size_t count) {
    constexpr std::size_t kAtOnce = 1024;  // lines may be short
    const std::size_t before = decoded_.size(),
                      most = std::min({(count - before + 2) / 3, text_.size() / 4, kAtOnce});
    decoded_.resize(before + 3 * most);
    std::size_t n = 0;
    for (; n < most; ++n) {
      const char* four = text_.data() + 4 * n;
      const int a = digit_of(four[0]), b = digit_of(four[1]), c = digit_of(four[2]), d = digit_of(four[3]);
      if ((a | b | c | d) < 0) break;
      char* three = decoded_.data() + before + 3 * n;
      three[0] = static_cast<char>(a << 2 | b >> 4);
      three[1] = static_cast<char>(b << 4 | c >> 2);
      three[2] = static_cast<char>(c << 6 | d);
    }
    decoded_.resize(before + 3 * n);
    text_.remove_prefix(4 * n);
  }
  void decode_four() {
    std::uint32_t group = 0;
    int digits = 0;
    for (int i = 0; i < 4; ++i) {
      text_.remove_prefix(std::min(text_.find_first_not_of(" \t\r\n"), text_.size()));
      if (text_.empty()) fail_short();
      const int digit = digit_of(text_.front());
      if (digit == kNoDigit || (digit != kPadding && digits < i) || (digit == kPadding && i < 2))
        throw InvalidInput(
            fmt::format("has \"{}\" where base64 is expected", one_line(text_.substr(0, 1), 1)));
      group = group << 6 | static_cast<std::uint32_t>(std::max(digit, 0));
      digits += digit != kPadding;
      text_.remove_prefix(1);
    }
    for (int byte = 0; byte + 1 < digits; ++byte) decoded_ += static_cast<char>(group >> (16 - 8 * byte));
  }

  std::string_view text_;
  bool base64_;
  std::string decoded_;
  std::size_t read_ = 0;  // of what is decoded
};

std::size_t read_size(Bytes& bytes, const DataEncoding& encoding) {
  const NumberType type = encoding.long_header ? NumberType::uint64 : NumberType::uint32;
  const double size = binary_numbers(bytes.read(bytes_of(type, 1)), type, encoding.order)[0];
  constexpr double kLargest = 9007199254740992;  // 2^53
  if (size >= kLargest) throw InvalidInput("has a size in its binary data that is not possible");
  return static_cast<std::size_t>(size);
}

vtkSmartPointer<vtkDataCompressor> compressor_of(std::string_view name) {
  vtkSmartPointer<vtkDataCompressor> compressor;
  if (name == "vtkZLibDataCompressor") compressor = vtkSmartPointer<ZLibCompressor>::New();
  if (name == "vtkLZ4DataCompressor") compressor = vtkSmartPointer<vtkLZ4DataCompressor>::New();
  if (name == "vtkLZMADataCompressor") compressor = vtkSmartPointer<vtkLZMADataCompressor>::New();
  if (compressor == nullptr)
    throw InvalidInput(
        fmt::format("is compressed by \"{}\"; expected vtkZLibDataCompressor, "
                    "vtkLZ4DataCompressor or vtkLZMADataCompressor",
                    one_line(name, 40)));
  compressor->AddObserver(vtkCommand::ErrorEvent, vtkNew<vtkCallbackCommand>());  // prints nothing of its own
  return compressor;
}

std::string uncompressed(Bytes& bytes, const DataEncoding& encoding) {
  const vtkSmartPointer<vtkDataCompressor> compressor = compressor_of(encoding.compressor);
  const std::size_t blocks = read_size(bytes, encoding), size = read_size(bytes, encoding),
                    last = read_size(bytes, encoding);
  if (blocks > bytes.at_most()) fail_short();
  std::vector<std::size_t> compressed(blocks);
  for (std::size_t& c : compressed) c = read_size(bytes, encoding);
  std::string result;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::string_view block = bytes.read(compressed[b]);
    const std::size_t expected = b + 1 == blocks && last != 0 ? last : size;
    if (expected / kMostCompressed > block.size())
      throw InvalidInput("has a size in its binary data that is not possible");
    const auto* from = reinterpret_cast<const unsigned char*>(block.data());
    const std::size_t before = result.size();
    result.resize(before + expected);
    auto* to = reinterpret_cast<unsigned char*>(result.data() + before);
    if (compressor->Uncompress(from, block.size(), to, expected) != expected)
      throw InvalidInput("has a compressed block that is damaged");
  }
  return result;
}

}  // namespace

std::vector<double> encoded_numbers(std::string_view text, bool base64, NumberType type,
                                    const DataEncoding& encoding) {
  Bytes bytes(text, base64);
  if (!encoding.compressor.empty())
    return binary_numbers(uncompressed(bytes, encoding), type, encoding.order);
  const std::size_t size = read_size(bytes, encoding);
  return binary_numbers(bytes.read(size), type, encoding.order);
}

}  // namespace kappaflow
