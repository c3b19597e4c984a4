// Ranks that are threads of one process, without MPI.
#pragma once

#include <algorithm>
#include <barrier>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "solver/ranks.h"

namespace kappaflow {

/// What the threads hold out to each other.
struct RankBoard {
  explicit RankBoard(int size) : barrier(size), own(size) {}

  RankBoard(const RankBoard&) = delete;
  RankBoard& operator=(const RankBoard&) = delete;
  ~RankBoard() {
    for (const auto& [way, box] : post)
      if (!box.empty()) std::terminate();  // nobody has taken it
  }

  std::barrier<> barrier;
  std::vector<std::span<const std::byte>> own;
  std::mutex mutex;
  std::condition_variable posted;
  std::map<std::pair<int, int>, std::deque<std::vector<std::byte>>> post;  // from one rank to another
  std::map<std::pair<int, bool>, RankBoard> parts;  // of the ranks below a number and of the others

  RankBoard& part(int first, bool below) {
    const std::lock_guard lock(mutex);
    const int size = static_cast<int>(own.size());
    return parts.try_emplace({first, below}, below ? first : size - first).first->second;
  }
};

class ThreadRanks : public Ranks {
 public:
  ThreadRanks(RankBoard& board, int rank) : board_(board), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(board_.own.size()); }
  std::vector<int> on_this_machine() const override {
    std::vector<int> all(board_.own.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
  RankTraffic traffic() const override { return {}; }

  void gather(std::span<const std::byte> own, std::span<const std::size_t>,
              std::span<std::byte> all) override {
    hold_out(own, [&] { copy_all(all); });
  }
  void gather_in_place(std::span<const std::size_t> sizes, std::span<std::byte> all) override {
    const auto begin_of = [&](int rank) {
      return std::accumulate(sizes.begin(), sizes.begin() + rank, std::size_t{0});
    };
    hold_out(all.subspan(begin_of(rank_), sizes[rank_]), [&] {
      for (int r = 0; r < size(); ++r)
        if (r != rank_) std::ranges::copy(board_.own[r], all.subspan(begin_of(r)).begin());
    });
  }
  void gather_to_first(std::span<const std::byte> own, std::span<const std::size_t>,
                       std::span<std::byte> all) override {
    hold_out(own, [&] {
      if (rank_ == 0) copy_all(all);
    });
  }
  void swap_counts(std::span<const std::uint64_t> sent, std::span<std::uint64_t> received) override {
    hold_out(std::as_bytes(sent), [&] {
      for (std::size_t r = 0; r < received.size(); ++r) {
        const auto* const of_rank = reinterpret_cast<const std::uint64_t*>(board_.own[r].data());
        received[r] = of_rank[rank_];
      }
    });
  }
  using WorkGroup::exchange;
  void exchange(std::span<const Parcel> sent, std::span<const Parcel> received,
                const std::function<void()>& meanwhile) override {
    std::unique_lock lock(board_.mutex);
    for (const Parcel& parcel : sent)
      board_.post[{rank_, parcel.rank}].emplace_back(parcel.bytes.begin(), parcel.bytes.end());
    board_.posted.notify_all();
    lock.unlock();
    meanwhile();
    lock.lock();
    for (const Parcel& parcel : received) {
      auto& box = board_.post[{parcel.rank, rank_}];
      board_.posted.wait(lock, [&] { return !box.empty(); });
      std::ranges::copy(box.front(), parcel.bytes.begin());
      box.pop_front();
    }
  }
  void exchange_asleep(std::span<const Parcel> sent, std::span<const Parcel> received) override {
    exchange(sent, received);
  }
  void broadcast(std::span<std::byte> bytes) override {
    hold_out(bytes, [&] {
      if (rank_ != 0) std::ranges::copy(board_.own[0], bytes.begin());
    });
  }
  void abort(int) override { std::terminate(); }

 protected:
  void tell(std::span<std::byte> bytes) override { broadcast(bytes); }
  std::unique_ptr<Ranks> cut(int first) override {
    const bool below = rank_ < first;
    return std::make_unique<ThreadRanks>(board_.part(first, below), below ? rank_ : rank_ - first);
  }

 private:
  template <class Work>
  void hold_out(std::span<const std::byte> own, const Work& work) {
    board_.own[rank_] = own;
    board_.barrier.arrive_and_wait();
    work();
    board_.barrier.arrive_and_wait();
  }
  void copy_all(std::span<std::byte> all) const {
    auto to = all.begin();
    for (const auto& own : board_.own) to = std::ranges::copy(own, to).out;
  }

  RankBoard& board_;
  int rank_;
};

/// Calls `work` on each of `size` ranks. Ends the program where one of them throws: the others would wait for
/// it.
inline void on_each_rank(int size, const std::function<void(Ranks&)>& work) noexcept {
  RankBoard board(size);
  std::vector<std::jthread> threads;
  for (int rank = 0; rank < size; ++rank)
    threads.emplace_back([&board, rank, &work]() noexcept {
      ThreadRanks ranks(board, rank);
      work(ranks);
    });
}

}  // namespace kappaflow
