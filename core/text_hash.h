// Hashes that recognise a text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace kappaflow {

/// The 64-bit FNV-1a hash of a text that comes in parts (Fowler, Noll & Vo), to recognise it, not to protect
/// it.
class TextHash {
 public:
  TextHash& add(std::string_view part) {
    for (const char c : part) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return *this;
  }
  /// Numbers or vectors without gaps between them, and how many there are.
  template <class Value>
  TextHash& add_values(std::span<const Value> values) {
    const std::size_t count = values.size();
    add({reinterpret_cast<const char*>(&count), sizeof count});
    return add({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  }
  /// "fnv1a64:" and 16 hex digits.
  std::string text() const;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

/// TextHash::text() of a whole text.
std::string text_hash(std::string_view text);

}  // namespace kappaflow
