// A quantity that is given at instants and changes linearly between them.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Linear in time between the keys, constant before the first and after the last. Value: a number or an Eigen
/// vector. A table whose values are all the same gives exactly that value everywhere.
template <class Value>
struct TimeTable {
  struct Key {
    double time;  ///< [s]
    Value value;

    friend bool operator==(const Key&, const Key&) = default;
  };
  std::vector<Key> keys;  ///< times strictly increasing; may be empty where no value is asked for

  bool empty() const { return keys.empty(); }
  /// Whether times are finite and strictly increasing.
  bool ascends() const {
    for (std::size_t k = 0; k < keys.size(); ++k)
      if (!std::isfinite(keys[k].time) || (k > 0 && !(keys[k - 1].time < keys[k].time))) return false;
    return true;
  }

  Value at(double time) const;
  /// Over [t0, t1], exact; at(t0) where both are the same.
  Value mean(double t0, double t1) const;
  /// The largest absolute value, or length, in [t0, t1]: convex between keys, it is that of a key or an end.
  double largest(double t0, double t1) const;

  friend bool operator==(const TimeTable&, const TimeTable&) = default;

 private:
  static double size_of(double value) { return std::abs(value); }
  static double size_of(const Vec3& value) { return value.norm(); }
};

template <class Value>
Value TimeTable<Value>::at(double time) const {
  const auto next = std::ranges::find_if(keys, [=](const Key& key) { return key.time > time; });
  if (next == keys.begin()) return keys.front().value;
  if (next == keys.end()) return keys.back().value;
  const Key &a = *(next - 1), &b = *next;
  return a.value + (time - a.time) / (b.time - a.time) * (b.value - a.value);
}

template <class Value>
Value TimeTable<Value>::mean(double t0, double t1) const {
  if (!(t0 < t1)) return at(t0);
  const Value first = at(t0);
  // What is summed up is the difference to the first value: nothing is rounded where that does not change.
  Value sum = 0 * first, last = sum;
  double time = t0;
  const auto add = [&](double to, const Value& value) {
    const Value next = value - first;
    sum += 0.5 * (to - time) * (last + next);
    time = to, last = next;
  };
  for (const Key& key : keys)
    if (key.time > t0 && key.time < t1) add(key.time, key.value);
  add(t1, at(t1));
  return first + sum / (t1 - t0);
}

template <class Value>
double TimeTable<Value>::largest(double t0, double t1) const {
  double result = std::max(size_of(at(t0)), size_of(at(t1)));
  for (const Key& key : keys)
    if (key.time > t0 && key.time < t1) result = std::max(result, size_of(key.value));
  return result;
}

}  // namespace kappaflow
