// What ranks send each other of values that each of them has by index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/bytes.h"
#include "core/parallel.h"
#include "solver/ranks.h"

namespace kappaflow {

/// Indices of values that go to other ranks, or come from them: rank by rank, those of one in the order in
/// which it lists them too.
struct RankIndices {
  /// Ends where the next rank's begin.
  struct Part {
    int rank = 0;
    std::size_t end = 0;
  };

  void clear() {
    index.clear();
    parts.clear();
  }
  void add(int rank, std::span<const std::uint32_t> of_rank) {
    if (of_rank.empty()) return;
    index.insert(index.end(), of_rank.begin(), of_rank.end());
    parts.push_back({rank, index.size()});
  }
  /// Calls visit(rank, its indices).
  template <class Visit>
  void for_parts(const Visit& visit) const {
    std::size_t begin = 0;
    for (const Part& part : parts) {
      visit(part.rank, std::span(index).subspan(begin, part.end - begin));
      begin = part.end;
    }
  }

  std::vector<std::uint32_t> index;
  std::vector<Part> parts;
};

struct ExchangePlan {
  RankIndices sent, received;

  std::size_t bytes() const { return bytes_of(sent.index, sent.parts, received.index, received.parts); }
};

/// Exchanges values by plans that all ranks have made of the same things. Keeps its buffers.
class RankExchange {
 public:
  explicit RankExchange(Ranks& ranks) : ranks_(&ranks) {}

  Ranks& ranks() const { return *ranks_; }

  /// Sends read(i) for the indices `sent`; until others' values come: meanwhile(). Returns what has come for
  /// those `received`, until the next call.
  template <class T, class Read>
  std::span<const T> swap(
      const RankIndices& sent, const RankIndices& received, const Read& read,
      const std::function<void()>& meanwhile = [] {}) {
    outbox_.resize(sizeof(T) * sent.index.size());
    inbox_.resize(sizeof(T) * received.index.size());
    T* const out = reinterpret_cast<T*>(outbox_.data());
    parallel_for(sent.index.size(), [&](std::size_t k) { out[k] = read(sent.index[k]); });
    transfer(sent, received, sizeof(T), meanwhile);
    return {reinterpret_cast<const T*>(inbox_.data()), received.index.size()};
  }
  /// The same of the values themselves, each of which comes from one rank at most.
  template <class T>
  void swap(
      const ExchangePlan& plan, std::vector<T>& values, const std::function<void()>& meanwhile = [] {}) {
    const auto read = [&](std::size_t i) -> const T& { return values[i]; };
    const std::span<const T> in = swap<T>(plan.sent, plan.received, read, meanwhile);
    parallel_for(in.size(), [&](std::size_t k) { values[plan.received.index[k]] = in[k]; });
  }

  std::size_t bytes() const { return bytes_of(outbox_, inbox_); }

 private:
  void transfer(const RankIndices& sent, const RankIndices& received, std::size_t width,
                const std::function<void()>& meanwhile);

  Ranks* ranks_;
  std::vector<std::byte> outbox_, inbox_;
};

/// How many things come from each rank, for how many go there.
inline std::vector<std::uint64_t> swapped_counts(Ranks& ranks, std::span<const std::uint64_t> sent) {
  std::vector<std::uint64_t> received(sent.size());
  ranks.swap_counts(sent, received);
  return received;
}

/// What each rank has for this one, for what this one has for each: one list a rank.
template <class T>
std::vector<std::vector<T>> swapped(Ranks& ranks, std::vector<std::vector<T>> sent) {
  std::vector<std::uint64_t> counts(sent.size());
  std::vector<std::vector<T>> received(sent.size());
  std::vector<Parcel> out, in;
  const auto add = [](std::vector<Parcel>& parcels, std::size_t rank, std::vector<T>& values) {
    if (!values.empty()) parcels.push_back({static_cast<int>(rank), bytes_in(std::span(values))});
  };
  for (std::size_t r = 0; r < sent.size(); ++r) counts[r] = sent[r].size();
  counts = swapped_counts(ranks, counts);
  for (std::size_t r = 0; r < sent.size(); ++r) {
    received[r].resize(counts[r]);
    add(out, r, sent[r]);
    add(in, r, received[r]);
  }
  ranks.exchange(out, in);
  return received;
}

}  // namespace kappaflow
