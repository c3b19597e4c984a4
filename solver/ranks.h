// Processes that share one liquid, or follow its surfaces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/work_group.h"

namespace kappaflow {

/// What the other ranks are to do together with rank 0, which alone is asked by anybody.
enum class RankTask : std::int64_t {
  end,
  resume,
  make,
  step,  ///< value: the time left for it [s]
  collect_motion,
  collect_all,
  collect_shares,
  restore,
  find_speed,       ///< below which the share `value` of the particles is
  serve,            ///< the surfaces are apart: RanksApart
  find_near,        ///< particles near the surface; value: whether all that is known of them
  write_particles,  ///< each its own; value: the frame
  go_to,            ///< the frame `value`, with the surfaces
  hear,             ///< what the liquid has told
  measure_field,    ///< value: whether the frame's surfaces are judged
  measure_surface,  ///< the one of number `value`
  restore_surfaces  ///< from the state that follows
};

struct RankOrder {
  RankTask task = RankTask::end;
  double value = 0;  ///< what the task says of it
};

/// What a rank has sent since the start, and how long it was, awake, at that and at waiting for the others
/// [s].
struct RankTraffic {
  std::uint64_t messages = 0, bytes = 0;
  double seconds = 0;
};

/// What a rank has of the liquid.
struct RankShare {
  std::uint64_t particles = 0, ghosts = 0, memory = 0;  ///< memory: of the solver, for liquid [bytes]
  double own_seconds = 0;  ///< of all steps, without the exchange and the wait for others
  RankTraffic traffic;
};

/// The ranks, numbered from 0, that run one solver, or follow the same surfaces: how they exchange data.
/// Every rank calls the functions in the same order. What they add up they gather and add in the order of the
/// ranks, each for itself, so that all have the same bits, every time. The libraries know no more of it than
/// this: whoever starts the processes says how bytes go from one to another (tools/commands/mpi_ranks.cpp by
/// MPI).
class Ranks : public WorkGroup {
 public:
  /// Those that are, this one among them; ascending.
  virtual std::vector<int> on_this_machine() const = 0;
  virtual RankTraffic traffic() const = 0;

  /// all = what every rank gives, in their order; sizes: of each rank's [bytes].
  virtual void gather(std::span<const std::byte> own, std::span<const std::size_t> sizes,
                      std::span<std::byte> all) = 0;
  /// The same, on rank 0 only; the others give no `all`.
  virtual void gather_to_first(std::span<const std::byte> own, std::span<const std::size_t> sizes,
                               std::span<std::byte> all) = 0;
  /// received[r] = what rank r gives for this one, which gives sent[r] for it: one number each.
  virtual void swap_counts(std::span<const std::uint64_t> sent, std::span<std::uint64_t> received) = 0;
  /// Rank 0's bytes to all.
  virtual void broadcast(std::span<std::byte> bytes) = 0;
  /// As exchange(), but sleeps until both are through: where that may take long.
  virtual void exchange_asleep(std::span<const Parcel> sent, std::span<const Parcel> received) = 0;
  /// Ends all ranks at once.
  virtual void abort(int exit_code) = 0;

  /// How much of the liquid each rank is to have, relative to the others: the same numbers on all ranks.
  /// Without them, all have the same.
  void set_shares(std::vector<double> shares) {
    const double most = *std::ranges::max_element(shares);
    // One that vanished beside the largest would leave nothing to divide by among its like.
    for (double& share : shares) share = std::max(share / most, std::numeric_limits<double>::min());
    shares_ = std::move(shares);
  }
  /// The largest is 1; empty: they are all the same.
  const std::vector<double>& shares() const { return shares_; }
  /// Of so many ranks together, from `first` on.
  double share_of(int first, int count) const {
    if (shares_.empty()) return count;
    return std::accumulate(shares_.begin() + first, shares_.begin() + first + count, 0.0);
  }

  /// By the shares.
  std::size_t share_begin(std::size_t n, int rank) const override {
    if (shares_.empty() || rank == size()) return WorkGroup::share_begin(n, rank);
    return static_cast<std::size_t>(static_cast<double>(n) * share_of(0, rank) / share_of(0, size()));
  }

  /// The ranks below `first`, or the others, by themselves: those that this one is of, numbered anew from 0,
  /// with their shares. All ranks call it.
  std::unique_ptr<Ranks> part(int first) {
    std::unique_ptr<Ranks> result = cut(first);
    const auto begin = shares_.begin();
    if (!shares_.empty())
      result->set_shares(rank() < first ? std::vector(begin, begin + first)
                                        : std::vector(begin + first, shares_.end()));
    return result;
  }

  /// Rank 0 tells the others what is next; until finish() they are at it together.
  void announce(const RankOrder& order) {
    RankOrder copy = order;
    tell(bytes_in(std::span(&copy, 1)));
    busy_ = order.task != RankTask::end;
  }
  /// The others wait for it: long, while rank 0 works alone.
  RankOrder next_order() {
    RankOrder order;
    tell(bytes_in(std::span(&order, 1)));
    ended_ = order.task == RankTask::end;
    begun_ = begun_ || order.task == RankTask::make || order.task == RankTask::serve;
    return order;
  }
  void finish() { busy_ = false; }
  /// Rank 0 begins, unannounced, what another waits for; until finish().
  void start() { busy_ = true; }
  /// Whether rank 0 is at something that all take part in.
  bool busy() const { return busy_; }
  /// Whether rank 0 has begun, and whether it has said that there is nothing more to do.
  bool begun() const { return begun_; }
  bool ended() const { return ended_; }

  /// One value of each rank.
  template <class T>
  std::vector<T> one_of_each(const T& own) {
    const std::vector<std::size_t> sizes(static_cast<std::size_t>(size()), sizeof(T));
    std::vector<T> all(sizes.size());
    gather(bytes_in(std::span(&own, 1)), sizes, bytes_in(std::span(all)));
    return all;
  }
  /// Combination in the order of the ranks.
  template <class T, class Combine>
  T combined(const T& own, const Combine& combine) {
    const std::vector<T> all = one_of_each(own);
    T result = all.front();
    for (std::size_t k = 1; k < all.size(); ++k) result = combine(result, all[k]);
    return result;
  }
  template <class T>
  T sum(const T& own) {
    return combined(own, [](const T& a, const T& b) -> T { return a + b; });
  }
  template <class T>
  T max(const T& own) {
    return combined(own, [](const T& a, const T& b) -> T { return a < b ? b : a; });
  }

  /// The same of each of as many values.
  template <class T>
  std::vector<T> sum_each(const std::vector<T>& own) {
    const std::vector<T> all = gathered(
        std::span<const T>(own), std::vector<std::size_t>(static_cast<std::size_t>(size()), own.size()));
    std::vector<T> result(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(own.size()));
    for (std::size_t k = own.size(); k < all.size(); ++k) result[k % own.size()] += all[k];
    return result;
  }

  /// The values of all ranks, counts[r] of rank r.
  template <class T>
  std::vector<T> gathered(std::span<const T> own, std::span<const std::size_t> counts) {
    std::vector<T> all(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
    gather(bytes_in(own), sizes_of<T>(counts), bytes_in(std::span(all)));
    return all;
  }
  /// The same where only each rank knows how many it has.
  template <class T>
  std::vector<T> gathered(const std::vector<T>& own) {
    return gathered(std::span<const T>(own), one_of_each(own.size()));
  }
  /// On rank 0 only; elsewhere nothing.
  template <class T>
  std::vector<T> gathered_to_first(std::span<const T> own, std::span<const std::size_t> counts) {
    std::vector<T> all(rank() == 0 ? std::accumulate(counts.begin(), counts.end(), std::size_t{0}) : 0);
    gather_to_first(bytes_in(own), sizes_of<T>(counts), bytes_in(std::span(all)));
    return all;
  }
  /// Rank 0's values to all.
  template <class Values>
  void broadcast_values(Values& values) {
    std::uint64_t count = values.size();
    broadcast(bytes_in(std::span(&count, 1)));
    values.resize(count);
    broadcast(bytes_in(std::span(values)));
  }

 protected:
  /// As broadcast(), but the others should sleep until it comes.
  virtual void tell(std::span<std::byte> bytes) = 0;
  /// As part(), but for the shares.
  virtual std::unique_ptr<Ranks> cut(int first) = 0;

 private:
  template <class T>
  static std::vector<std::size_t> sizes_of(std::span<const std::size_t> counts) {
    std::vector<std::size_t> sizes(counts.begin(), counts.end());
    for (std::size_t& size : sizes) size *= sizeof(T);
    return sizes;
  }

  std::vector<double> shares_;
  bool busy_ = false, begun_ = false, ended_ = false;
};

}  // namespace kappaflow
