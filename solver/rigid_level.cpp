#include "solver/rigid_level.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

#include "core/bytes.h"
#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr std::size_t kCellGrain = 16, kParentGrain = 2;  // cells that a task works on
constexpr std::size_t kHeadroom = 32;                     // matrices grow by this fraction more than needed
constexpr std::size_t kNeighboursAfter = 13;
constexpr std::int64_t kLastPlace = (std::int64_t{1} << RigidLevel::kBitsOfPlace) - 1;

// Sums in single precision are uncertain by about this share; blocks are made so much stiffer, lest one that
// has a stiff and a soft direction loses the latter, or its sign. It slows nothing but such cells.
constexpr double kUncertainty = 1e-6;

/// Every third bit, from the lowest.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

std::int64_t gathered(std::uint64_t bits) {
  bits &= 0x1249249249249249;
  bits = (bits | bits >> 2) & 0x10c30c30c30c30c3;
  bits = (bits | bits >> 4) & 0x100f00f00f00f00f;
  bits = (bits | bits >> 8) & 0x1f0000ff0000ff;
  bits = (bits | bits >> 16) & 0x1f00000000ffff;
  return static_cast<std::int64_t>((bits | bits >> 32) & static_cast<std::uint64_t>(kLastPlace));
}

/// The k-th of the thirteen neighbours that come after a place.
std::array<std::int64_t, 3> neighbour_after(const std::array<std::int64_t, 3>& place, int k) {
  const int code = 14 + k;
  return {place[0] + code % 3 - 1, place[1] + code / 3 % 3 - 1, place[2] + code / 9 - 1};
}

/// Every neighbour.
constexpr auto kAll = [](std::uint32_t) { return true; };

/// Room for n, without what was there, and without the double of it that growing by a few would take.
template <class T>
void make_room_for(std::vector<T>& values, std::size_t n) {
  if (values.capacity() < n) {
    std::vector<T>().swap(values);
    values.reserve(n + n / kHeadroom);
  }
  values.resize(n);
}

/// Turns counts, with one entry more than there are, into where each begins.
void counts_to_begins(std::vector<std::uint32_t>& counts) {
  std::exclusive_scan(counts.begin(), counts.end(), counts.begin(), std::uint32_t{0});
}

RigidMatrix inverse_of(const RigidMatrix& matrix, double inertia) {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  Matrix m = rigid::squared(matrix);
  m.diagonal().tail<3>().array() += inertia;
  m.diagonal() *= 1 + kUncertainty;
  const auto scale = m.diagonal().cwiseSqrt().cwiseInverse().eval();
  m = (scale.asDiagonal() * m * scale.asDiagonal()).eval();
  m = m.llt().solve(Matrix(scale.asDiagonal())).eval();
  return rigid::packed(scale.asDiagonal() * m);
}

}  // namespace

std::uint64_t RigidLevel::key_of(const std::array<std::int64_t, 3>& place) {
  return spread(static_cast<std::uint64_t>(place[0])) | spread(static_cast<std::uint64_t>(place[1])) << 1 |
         spread(static_cast<std::uint64_t>(place[2])) << 2;
}

std::array<std::int64_t, 3> RigidLevel::place_of(std::uint64_t key) {
  return {gathered(key), gathered(key >> 1), gathered(key >> 2)};
}

std::size_t RigidLevel::bytes() const {
  return bytes_of(key, centre, first_link, links, coupling, anchor, load, motion, parent_, first_child_,
                  first_in_row_, row_, first_of_colour_, coloured_, end_, inverse_) +
         (ranks_ ? ranks_->bytes() : 0);
}

bool RigidLevel::has_key(const std::array<std::int64_t, 3>& place) {
  return std::ranges::all_of(place, [](std::int64_t c) { return c >= 0 && c <= kLastPlace; });
}

std::uint32_t RigidLevel::find(std::uint64_t key_of_cell) const {
  const auto at = std::ranges::lower_bound(key, key_of_cell);
  return at != key.end() && *at == key_of_cell ? static_cast<std::uint32_t>(at - key.begin()) : kNone;
}

void RigidLevel::share_among(Ranks& ranks, const LiquidCut& cut, const LiquidCut::Place& first_place) {
  if (!ranks_) ranks_.emplace(ranks, cut);
  ranks_->set_first_place(first_place);
  ranks_->list(key);
}

void RigidLevel::reset() {
  link_cells();
  find_rows();
  centre.resize(cells());
  if (ranks_) ranks_->find_borders(*this);
  find_colours();
}

void RigidLevel::make_room() {
  for (auto* vectors : {&load, &motion}) vectors->resize(cells());
  for (auto* matrices : {&anchor, &inverse_}) make_room_for(*matrices, cells());
  make_room_for(coupling, links.size());
  parent_.resize(cells());
}

void RigidLevel::link_cells() {
  std::vector<std::uint32_t>& after = row_;  // thirteen a cell, before it takes the links
  after.resize(kNeighboursAfter * cells());
  parallel_for(cells(), [&](std::size_t cell) {
    const auto place = place_of(key[cell]);
    for (std::size_t k = 0; k < kNeighboursAfter; ++k) {
      const auto other = neighbour_after(place, static_cast<int>(k));
      after[kNeighboursAfter * cell + k] = has_key(other) ? find(key_of(other)) : kNone;
    }
  });
  const auto neighbours_after = [&](std::size_t cell) {
    return std::span(after).subspan(kNeighboursAfter * cell, kNeighboursAfter);
  };
  first_link.resize(cells() + 1);
  first_link.front() = 0;
  for (std::size_t cell = 0; cell < cells(); ++cell) {
    const auto missing = std::ranges::count(neighbours_after(cell), kNone);
    first_link[cell + 1] = first_link[cell] + static_cast<std::uint32_t>(kNeighboursAfter - missing);
  }
  make_room_for(links, first_link.back());
  parallel_for(cells(), [&](std::size_t cell) {
    std::uint32_t k = first_link[cell];
    for (const std::uint32_t other : neighbours_after(cell))
      if (other != kNone) links[k++] = {static_cast<std::uint32_t>(cell), other};
  });
}

void RigidLevel::find_rows() {
  first_in_row_.assign(cells() + 1, 0);
  for (const Link& link : links) ++first_in_row_[link.to];
  counts_to_begins(first_in_row_);
  row_.resize(links.size());
  end_ = first_in_row_;
  for (std::uint32_t k = 0; k < links.size(); ++k) row_[end_[links[k].to]++] = k;
}

void RigidLevel::find_colours() {
  first_of_colour_.assign(kColours + 1, 0);
  for (std::uint32_t cell = 0; cell < cells(); ++cell) first_of_colour_[colour(cell)] += is_own(cell);
  counts_to_begins(first_of_colour_);
  coloured_.resize(first_of_colour_.back());
  end_ = first_of_colour_;
  for (std::uint32_t cell = 0; cell < cells(); ++cell)
    if (is_own(cell)) coloured_[end_[colour(cell)]++] = cell;
  if (!ranks_) return;
  for (std::uint64_t k = 0; k < kColours; ++k) {
    std::vector<std::uint32_t> told(ranks_->told(k).begin(), ranks_->told(k).end());
    std::ranges::sort(told);
    const auto begin = coloured_.begin();
    const auto inner =
        std::stable_partition(begin + first_of_colour_[k], begin + first_of_colour_[k + 1],
                              [&](std::uint32_t cell) { return std::ranges::binary_search(told, cell); });
    told_[k] = static_cast<std::uint32_t>(inner - begin) - first_of_colour_[k];
  }
}

bool RigidLevel::coarsen(RigidLevel& finer) {
  const int linked = finer.links.empty() ? 0 : 1;
  const bool shared = finer.ranks_ && !finer.ranks_->is_whole();
  if ((shared ? finer.ranks_->ranks().max(linked) : linked) == 0) return false;
  ranks_.reset();
  if (shared) ranks_ = finer.ranks_->coarser();
  find_parents(finer);
  reset();
  make_room();
  find_centres(finer);
  parallel_for(
      cells(), [&](std::size_t cell) { gather_from(finer, cell); }, kCellGrain);
  if (ranks_) ranks_->add_up_matrices(*this);
  return true;
}

void RigidLevel::find_parents(RigidLevel& finer) {
  int bits = 0;
  do {
    bits += 3;
    key.clear();
    for (const std::uint64_t child : finer.key)
      if (key.empty() || child >> bits != key.back()) key.push_back(child >> bits);
  } while (!ranks_ && key.size() == finer.cells());
  if (ranks_) ranks_->list(key);
  first_child_.resize(cells() + 1);
  std::uint32_t child = 0;
  for (std::uint32_t cell = 0; cell < cells(); ++cell) {
    first_child_[cell] = child;
    for (; child < finer.cells() && finer.key[child] >> bits == key[cell]; ++child)
      finer.parent_[child] = cell;
  }
  first_child_.back() = child;
}

void RigidLevel::find_centres(const RigidLevel& finer) {
  parallel_for(cells(), [&](std::size_t cell) {
    Vec4f sum = Vec4f::Zero();
    for (std::uint32_t child = first_child_[cell]; child < first_child_[cell + 1]; ++child) {
      if (!finer.is_own(child)) continue;
      const Vec4f& x = finer.centre[child];
      sum += Vec4f(x[3] * x[0], x[3] * x[1], x[3] * x[2], x[3]);
    }
    centre[cell] = sum;
  });
  if (ranks_) ranks_->add_up(centre);
  share_values(centre);
  parallel_for(cells(), [&](std::size_t cell) {
    const Vec4f sum = centre[cell];
    centre[cell] = {sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3], sum[3]};
  });
}

/// Where ranks share the finer level: of this rank's cells, and of the links from them.
void RigidLevel::gather_from(const RigidLevel& finer, std::size_t cell) {
  anchor[cell] = {};
  std::fill(coupling.begin() + first_link[cell], coupling.begin() + first_link[cell + 1], RigidMatrix());
  for (std::uint32_t child = first_child_[cell]; child < first_child_[cell + 1]; ++child) {
    if (finer.is_own(child)) {
      anchor[cell] += rigid::matrix_from(finer.anchor[child], (finer.centre[child] - centre[cell]).head<3>());
      for (std::uint32_t k = finer.first_link[child]; k < finer.first_link[child + 1]; ++k)
        add_link(finer, cell, k, finer.parent_[finer.links[k].to]);
    }
    for (const std::uint32_t k : finer.links_to(child))
      if (finer.is_own(finer.links[k].from)) add_link(finer, cell, k, finer.parent_[finer.links[k].from]);
  }
}

/// The finer level's link k joins the cell and another.
void RigidLevel::add_link(const RigidLevel& finer, std::size_t cell, std::uint32_t k, std::uint32_t other) {
  for (std::uint32_t own = first_link[cell]; own < first_link[cell + 1]; ++own)
    if (links[own].to == other)
      coupling[own] +=
          rigid::matrix_from(finer.coupling[k], (finer.centre[finer.links[k].from] - centre[cell]).head<3>());
}

/// Moving a link's S to the cell's centre rounds what it has of turning: by a share of what the force between
/// the centres would have, which is much for a cell of one particle, whose own share is nothing.
RigidMatrix RigidLevel::diagonal(std::uint32_t cell) const {
  RigidMatrix sum = anchor[cell];
  float moved = 0;
  const auto add = [&](const RigidMatrix& matrix, std::uint32_t other) {
    sum += matrix;
    moved += (matrix.force[0] + matrix.force[1] + matrix.force[2]) * arm(cell, other).squaredNorm();
  };
  for (std::uint32_t k = first_link[cell]; k < first_link[cell + 1]; ++k) add(coupling[k], links[k].to);
  for (const std::uint32_t k : links_to(cell))
    add(rigid::matrix_from(coupling[k], arm(links[k].from, cell).head<3>()), links[k].from);
  for (std::size_t k = 0; k < 3; ++k) sum.turning[k] += static_cast<float>(kUncertainty) * moved;
  return sum;
}

void RigidLevel::invert(float inertia) {
  if (ranks_) ranks_->share_links(coupling);
  parallel_for(
      cells(),
      [&](std::size_t cell) {
        if (!is_own(cell)) return;
        inverse_[cell] = inverse_of(diagonal(static_cast<std::uint32_t>(cell)),
                                    static_cast<double>(inertia * centre[cell][3]));
      },
      kCellGrain);
}

// Differences of motions come first: the common motion of stiff liquid must not leave rounding.
template <class Select>
RigidVector RigidLevel::residual(std::uint32_t cell, const Select& counts) const {
  const RigidVector own = motion[cell];
  RigidVector result = load[cell] - rigid::product(anchor[cell], own);
  for (std::uint32_t k = first_link[cell]; k < first_link[cell + 1]; ++k) {
    const std::uint32_t to = links[k].to;
    if (!counts(to)) continue;
    result -= rigid::product(coupling[k], own - rigid::motion_about(motion[to], arm(cell, to)));
  }
  for (const std::uint32_t k : links_to(cell)) {
    const std::uint32_t from = links[k].from;
    if (!counts(from)) continue;
    const Vec4f away = arm(from, cell);
    result +=
        rigid::load_from(rigid::product(coupling[k], motion[from] - rigid::motion_about(own, away)), away);
  }
  return result;
}

/// Calls work(cell) for the colour's cells; where ranks share them, first for those that others are told.
template <class Work>
void RigidLevel::relax_colour(std::uint64_t colour, const Work& work) {
  const auto relax_cells = [&](std::uint32_t begin, std::uint32_t end) {
    parallel_for(
        end - begin, [&](std::size_t c) { work(coloured_[begin + c]); }, kCellGrain);
  };
  const std::uint32_t begin = first_of_colour_[colour], end = first_of_colour_[colour + 1];
  if (!ranks_) return relax_cells(begin, end);
  const std::uint32_t inner = begin + told_[colour];
  relax_cells(begin, inner);
  ranks_->share_colour(colour, motion, [&] { relax_cells(inner, end); });
}

void RigidLevel::relax_from_zero() {
  for (std::uint64_t k = 0; k < kColours; ++k)
    relax_colour(k, [&](std::uint32_t cell) {
      motion[cell] = {};
      const RigidVector left = residual(cell, [&](std::uint32_t other) { return colour(other) < k; });
      motion[cell] = rigid::product(inverse_[cell], left);
    });
}

void RigidLevel::restrict_to(RigidLevel& coarser) const {
  parallel_for(
      coarser.cells(),
      [&](std::size_t above) {
        RigidVector sum;
        for (std::uint32_t cell = coarser.first_child_[above]; cell < coarser.first_child_[above + 1]; ++cell)
          if (is_own(cell))
            sum +=
                rigid::load_from(residual(cell, kAll), without_fourth(centre[cell] - coarser.centre[above]));
        coarser.load[above] = sum;
      },
      kParentGrain);
  if (coarser.ranks_) coarser.ranks_->add_up(coarser.load);
}

void RigidLevel::relax() {
  for (std::uint64_t k = kColours; k-- > 0;)
    relax_colour(
        k, [&](std::uint32_t cell) { motion[cell] += rigid::product(inverse_[cell], residual(cell, kAll)); });
}

void RigidLevel::add_from(const RigidLevel& coarser) {
  parallel_for(cells(), [&](std::size_t cell) {
    const std::uint32_t above = parent_[cell];
    motion[cell] +=
        rigid::motion_about(coarser.motion[above], without_fourth(centre[cell] - coarser.centre[above]));
  });
}

}  // namespace kappaflow
