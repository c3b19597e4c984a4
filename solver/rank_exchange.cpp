#include "solver/rank_exchange.h"

namespace kappaflow {

/// The boxes, so many bytes a value.
void RankExchange::transfer(const RankIndices& sent, const RankIndices& received, std::size_t width,
                            const std::function<void()>& meanwhile) {
  const auto parcels = [width](const RankIndices& indices, std::span<std::byte> box) {
    std::vector<Parcel> result;
    indices.for_parts([&](int rank, std::span<const std::uint32_t> of_rank) {
      result.push_back({rank, box.first(width * of_rank.size())});
      box = box.subspan(width * of_rank.size());
    });
    return result;
  };
  ranks_->exchange(parcels(sent, outbox_), parcels(received, inbox_), meanwhile);
}

}  // namespace kappaflow
