// The module that a run of several processes loads: ranks_of_program.h.
#define OMPI_SKIP_MPICXX
#define MPICH_SKIP_MPICXX
#include <mpi.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numeric>
#include <thread>
#include <utility>

#include "core/stopwatch.h"
#include "solver/ranks.h"

namespace kappaflow {
namespace {

// How long a rank that waits for the first one sleeps between looks: at first, and at most.
constexpr std::chrono::microseconds kFirstSleep{20}, kLongestSleep{1000};

// MPI counts bytes in an int; what is longer goes in pieces.
constexpr std::size_t kPiece = std::size_t{1} << 30;

template <class Send>
void in_pieces(std::span<std::byte> bytes, const Send& send) {
  while (!bytes.empty()) {
    const std::size_t size = std::min(bytes.size(), kPiece);
    send(bytes.data(), static_cast<int>(size));
    bytes = bytes.subspan(size);
  }
}

/// Where each rank's bytes are in those of all.
std::vector<std::size_t> begins_of(std::span<const std::size_t> sizes) {
  std::vector<std::size_t> begins(sizes.size());
  std::exclusive_scan(sizes.begin(), sizes.end(), begins.begin(), std::size_t{0});
  return begins;
}

std::vector<int> in_ints(std::span<const std::size_t> numbers) {
  std::vector<int> result(numbers.size());
  std::ranges::transform(numbers, result.begin(), [](std::size_t n) { return static_cast<int>(n); });
  return result;
}

/// Adds the time until it ends.
class Timed {
 public:
  explicit Timed(double& seconds) : seconds_(seconds) {}
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;
  ~Timed() { seconds_ += watch_.seconds(); }

 private:
  double& seconds_;
  Stopwatch watch_;
};

/// MPI takes no note of an error: its own handler ends all processes.
class MpiRanks : public Ranks {
 public:
  explicit MpiRanks(MPI_Comm all, std::shared_ptr<RankTraffic> traffic = std::make_shared<RankTraffic>())
      : all_(all), traffic_(std::move(traffic)) {
    MPI_Comm_rank(all_, &rank_);
    MPI_Comm_size(all_, &size_);
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(all_, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    int count = 0;
    MPI_Comm_size(machine, &count);
    on_this_machine_.resize(static_cast<std::size_t>(count));
    MPI_Allgather(&rank_, 1, MPI_INT, on_this_machine_.data(), 1, MPI_INT, machine);
    MPI_Comm_free(&machine);
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;
  ~MpiRanks() override {
    if (all_ == MPI_COMM_WORLD)
      MPI_Finalize();  // which frees parts: after an error not all come to that at once
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::vector<int> on_this_machine() const override { return on_this_machine_; }
  RankTraffic traffic() const override { return *traffic_; }

  void gather(std::span<const std::byte> own, std::span<const std::size_t> sizes,
              std::span<std::byte> all) override {
    place_own(own, sizes, all);
    gather_in_place(sizes, all);
  }

  void gather_in_place(std::span<const std::size_t> sizes, std::span<std::byte> all) override {
    const std::vector<std::size_t> begins = begins_of(sizes);
    const auto rank = static_cast<std::size_t>(rank_);
    const std::span<std::byte> own = all.subspan(begins[rank], sizes[rank]);
    if (all.size() > kPiece) return exchange_with_all(own, places_of_others(sizes, all));
    note(static_cast<std::size_t>(size_ - 1), own.size());
    const Timed timed(traffic_->seconds);
    if (std::ranges::adjacent_find(sizes, std::not_equal_to()) == sizes.end()) {
      MPI_Allgather(MPI_IN_PLACE, 0, MPI_BYTE, all.data(), static_cast<int>(own.size()), MPI_BYTE, all_);
      return;
    }
    const std::vector<int> counts = in_ints(sizes), places = in_ints(begins);
    MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_BYTE, all.data(), counts.data(), places.data(), MPI_BYTE, all_);
  }

  void swap_counts(std::span<const std::uint64_t> sent, std::span<std::uint64_t> received) override {
    note(static_cast<std::size_t>(size_ - 1), sizeof(std::uint64_t));
    const Timed timed(traffic_->seconds);
    MPI_Alltoall(sent.data(), 1, MPI_UINT64_T, received.data(), 1, MPI_UINT64_T, all_);
  }

  void gather_to_first(std::span<const std::byte> own, std::span<const std::size_t> sizes,
                       std::span<std::byte> all) override {
    if (rank_ > 0) return exchange(std::array{to_send(own, 0)}, {});
    place_own(own, sizes, all);
    exchange({}, places_of_others(sizes, all));
  }

  using WorkGroup::exchange;
  void exchange(std::span<const Parcel> sent, std::span<const Parcel> received,
                const std::function<void()>& meanwhile) override {
    {
      const Timed timed(traffic_->seconds);
      begin_exchange(sent, received);
    }
    meanwhile();
    const Timed timed(traffic_->seconds);
    MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  }

  void exchange_asleep(std::span<const Parcel> sent, std::span<const Parcel> received) override {
    begin_exchange(sent, received);
    wait_asleep(requests_);
  }

  void broadcast(std::span<std::byte> whole) override {
    const Timed timed(traffic_->seconds);
    in_pieces(whole, [&](std::byte* bytes, int count) {
      if (rank_ == 0) note(static_cast<std::size_t>(size_ - 1), static_cast<std::size_t>(count));
      MPI_Bcast(bytes, count, MPI_BYTE, 0, all_);
    });
  }

  void abort(int exit_code) override {
    MPI_Abort(MPI_COMM_WORLD, exit_code);
    std::_Exit(exit_code);
  }

 protected:
  // MPI_Bcast would keep a core busy, which the first rank may need for the surfaces.
  void tell(std::span<std::byte> bytes) override {
    if (rank_ == 0) note(static_cast<std::size_t>(size_ - 1), bytes.size());
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibcast(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, all_, &request);
    wait_asleep({&request, 1});
  }

  std::unique_ptr<Ranks> cut(int first) override {
    MPI_Comm part = MPI_COMM_NULL;
    MPI_Comm_split(all_, rank_ < first ? 0 : 1, rank_, &part);
    return std::make_unique<MpiRanks>(part, traffic_);
  }

 private:
  void begin_exchange(std::span<const Parcel> sent, std::span<const Parcel> received) {
    requests_.clear();
    for (const Parcel& parcel : received)
      in_pieces(parcel.bytes, [&](std::byte* bytes, int count) {
        MPI_Irecv(bytes, count, MPI_BYTE, parcel.rank, 0, all_, &requests_.emplace_back());
      });
    for (const Parcel& parcel : sent)
      in_pieces(parcel.bytes, [&](std::byte* bytes, int count) {
        note(1, static_cast<std::size_t>(count));
        MPI_Isend(bytes, count, MPI_BYTE, parcel.rank, 0, all_, &requests_.emplace_back());
      });
  }

  static void wait_asleep(std::span<MPI_Request> requests) {
    auto sleep = kFirstSleep;
    for (int done = 0;;) {
      MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
      if (done != 0) return;
      std::this_thread::sleep_for(sleep);
      sleep = std::min(2 * sleep, kLongestSleep);
    }
  }

  void note(std::size_t messages, std::size_t bytes_each) {
    traffic_->messages += messages;
    traffic_->bytes += messages * bytes_each;
  }

  /// Of what is only read.
  static Parcel to_send(std::span<const std::byte> bytes, int rank) {
    return {rank, {const_cast<std::byte*>(bytes.data()), bytes.size()}};
  }

  /// Where in `all` the other ranks' bytes come.
  std::vector<Parcel> places_of_others(std::span<const std::size_t> sizes, std::span<std::byte> all) const {
    const std::vector<std::size_t> begins = begins_of(sizes);
    std::vector<Parcel> places;
    for (int r = 0; r < size_; ++r)
      if (const auto k = static_cast<std::size_t>(r); r != rank_)
        places.push_back({r, all.subspan(begins[k], sizes[k])});
    return places;
  }

  /// Puts this rank's bytes where they belong in those of all.
  void place_own(std::span<const std::byte> own, std::span<const std::size_t> sizes,
                 std::span<std::byte> all) const {
    const std::size_t begin = begins_of(sizes)[static_cast<std::size_t>(rank_)];
    std::ranges::copy(own, all.subspan(begin).begin());
  }

  void exchange_with_all(std::span<const std::byte> own, std::span<const Parcel> received) {
    std::vector<Parcel> sent;
    for (int r = 0; r < size_; ++r)
      if (r != rank_) sent.push_back(to_send(own, r));
    exchange(sent, received);
  }

  MPI_Comm all_;
  int rank_ = 0, size_ = 1;
  std::vector<int> on_this_machine_;
  std::shared_ptr<RankTraffic> traffic_;  // of all that this process sends, in its parts too
  std::vector<MPI_Request> requests_;
};

}  // namespace

}  // namespace kappaflow

/// See ranks_of_program.h.
extern "C" kappaflow::Ranks* kappaflow_mpi_ranks() {
  int got = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &got);
  auto* const ranks = new kappaflow::MpiRanks(MPI_COMM_WORLD);
  if (ranks->rank() > 0) {  // the first rank heeds the signals that all get, and tells the others
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGTERM, SIG_IGN);
  }
  return ranks;
}
