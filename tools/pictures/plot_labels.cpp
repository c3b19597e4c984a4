#include "tools/pictures/plot_labels.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace kappaflow {
namespace {

/// The ascending numbers nearest to these: those that descend are pooled to their mean.
std::vector<double> ascending(const std::vector<double>& numbers) {
  struct Pool {
    double sum;
    std::size_t count;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Pool> pools;
  for (const double number : numbers) {
    pools.push_back({number, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      pools[pools.size() - 2].sum += pools.back().sum;
      pools[pools.size() - 2].count += pools.back().count;
      pools.pop_back();
    }
  }
  std::vector<double> result;
  for (const Pool& pool : pools) result.insert(result.end(), pool.count, pool.mean());
  return result;
}

}  // namespace

std::vector<double> spread_out(const std::vector<double>& wanted, double gap, double low, double high) {
  const std::size_t n = wanted.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return wanted[k]; });
  if (n > 1) gap = std::min(gap, (high - low) / static_cast<double>(n - 1));
  // Without the gaps below each the places must ascend only.
  std::vector<double> places;
  places.reserve(n);
  for (std::size_t k = 0; k < n; ++k) places.push_back(wanted[order[k]] - gap * static_cast<double>(k));
  places = ascending(places);
  std::vector<double> result(n);
  for (std::size_t k = 0; k < n; ++k)
    result[order[k]] = std::clamp(places[k], low, std::max(low, high - gap * static_cast<double>(n - 1))) +
                       gap * static_cast<double>(k);
  return result;
}

}  // namespace kappaflow
