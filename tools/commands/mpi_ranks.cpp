#include "tools/commands/mpi_ranks.h"

#define OMPI_SKIP_MPICXX
#define MPICH_SKIP_MPICXX
#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <thread>

#include "core/errors.h"

namespace kappaflow {
namespace {

// How long a rank that waits for the first one sleeps between looks: at first, and at most.
constexpr std::chrono::microseconds kFirstSleep{20}, kLongestSleep{1000};

/// MPI counts bytes in an int.
int count_of(std::size_t bytes) {
  if (bytes > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error(
        fmt::format("a message of {} bytes between ranks; at most 2^31 can be sent, take more ranks", bytes),
        1);
  return static_cast<int>(bytes);
}

struct Places {
  std::vector<int> counts, begins;
  explicit Places(std::span<const std::size_t> sizes) {
    std::size_t begin = 0;
    for (const std::size_t size : sizes) {
      counts.push_back(count_of(size));
      begins.push_back(count_of(begin));
      begin += size;
    }
  }
};

/// MPI takes no note of an error: its own handler ends all processes.
class MpiRanks : public Ranks {
 public:
  MpiRanks() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  ~MpiRanks() override { MPI_Finalize(); }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  RankTraffic traffic() const override { return traffic_; }

  void gather(std::span<const std::byte> own, std::span<const std::size_t> sizes,
              std::span<std::byte> all) override {
    note(static_cast<std::size_t>(size_ - 1), own.size());
    if (std::ranges::adjacent_find(sizes, std::not_equal_to()) == sizes.end()) {
      const int count = count_of(own.size());
      MPI_Allgather(own.data(), count, MPI_BYTE, all.data(), count, MPI_BYTE, MPI_COMM_WORLD);
      return;
    }
    const Places places(sizes);
    MPI_Allgatherv(own.data(), count_of(own.size()), MPI_BYTE, all.data(), places.counts.data(),
                   places.begins.data(), MPI_BYTE, MPI_COMM_WORLD);
  }

  void gather_to_first(std::span<const std::byte> own, std::span<const std::size_t> sizes,
                       std::span<std::byte> all) override {
    if (rank_ != 0) note(1, own.size());
    const Places places(sizes);
    MPI_Gatherv(own.data(), count_of(own.size()), MPI_BYTE, all.data(), places.counts.data(),
                places.begins.data(), MPI_BYTE, 0, MPI_COMM_WORLD);
  }

  void exchange(std::span<const Parcel> sent, std::span<const Parcel> received) override {
    std::vector<MPI_Request> requests(sent.size() + received.size());
    auto request = requests.begin();
    for (const Parcel& parcel : received)
      MPI_Irecv(parcel.bytes.data(), count_of(parcel.bytes.size()), MPI_BYTE, parcel.rank, 0, MPI_COMM_WORLD,
                &*request++);
    for (const Parcel& parcel : sent) {
      note(1, parcel.bytes.size());
      MPI_Isend(parcel.bytes.data(), count_of(parcel.bytes.size()), MPI_BYTE, parcel.rank, 0, MPI_COMM_WORLD,
                &*request++);
    }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  }

  void broadcast(std::span<std::byte> bytes) override {
    if (rank_ == 0) note(static_cast<std::size_t>(size_ - 1), bytes.size());
    MPI_Bcast(bytes.data(), count_of(bytes.size()), MPI_BYTE, 0, MPI_COMM_WORLD);
  }

  void abort(int exit_code) override {
    MPI_Abort(MPI_COMM_WORLD, exit_code);
    std::_Exit(exit_code);
  }

 protected:
  // MPI_Bcast would keep a core busy, which the first rank may need for the surfaces.
  void tell(std::span<std::byte> bytes) override {
    if (rank_ == 0) note(static_cast<std::size_t>(size_ - 1), bytes.size());
    MPI_Request request;
    MPI_Ibcast(bytes.data(), count_of(bytes.size()), MPI_BYTE, 0, MPI_COMM_WORLD, &request);
    auto sleep = kFirstSleep;
    for (int done = 0;;) {
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
      if (done != 0) return;
      std::this_thread::sleep_for(sleep);
      sleep = std::min(2 * sleep, kLongestSleep);
    }
  }

 private:
  void note(std::size_t messages, std::size_t bytes_each) {
    traffic_.messages += messages;
    traffic_.bytes += messages * bytes_each;
  }

  int rank_ = 0, size_ = 1;
  RankTraffic traffic_;
};

/// Whether Open MPI, MPICH or Slurm has started this process for MPI.
bool is_started_by_mpi() {
  const auto has = [](const char* name) { return std::getenv(name) != nullptr; };
  return has("OMPI_COMM_WORLD_SIZE") || has("PMI_SIZE") || has("PMI_RANK") || has("PMIX_RANK");
}

}  // namespace

std::unique_ptr<Ranks> ranks_of_program() {
  if (!is_started_by_mpi()) return nullptr;
  int got = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &got);
  auto ranks = std::make_unique<MpiRanks>();
  if (ranks->rank() > 0) {  // the first rank heeds the signals that all get, and tells the others
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGTERM, SIG_IGN);
  }
  return ranks;
}

}  // namespace kappaflow
