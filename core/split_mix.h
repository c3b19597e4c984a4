// Numbers that look random, the same on every machine.
#pragma once

#include <cstdint>

namespace kappaflow {

/// What the generator SplitMix64 gives in the state x: a permutation of the 64-bit integers that mixes all
/// their bits. The state after it is x + 0x9e3779b97f4a7c15. (Steele, Lea & Flood, "Fast splittable
/// pseudorandom number generators", 2014.)
constexpr std::uint64_t split_mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

}  // namespace kappaflow
