#include "tools/io/image_pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/errors.h"
#include "core/text_scanner.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

std::string distances_text(const ImagePiece& piece) {
  return fmt::format("\"{}\" of {}", one_line(piece.frame.name, 30), piece.of_cells ? "cells" : "points");
}

std::string box_text(const LatticeBox& box) {
  return fmt::format("({}) to ({})", fmt::join(box.first, ", "), fmt::join(box.last, ", "));
}

/// Throws InvalidInput where the piece has others than the first.
void check_arrays(const ImagePiece& piece, const ImagePiece& first) {
  if (piece.frame.name != first.frame.name || piece.of_cells != first.of_cells)
    throw InvalidInput({piece.file.string()},
                       fmt::format("its distances are {}; those of {}, a piece of the same frame, are {}",
                                   distances_text(piece), first.file.string(), distances_text(first)));
  const bool has = !piece.frame.velocity_name.empty();
  if (has == first.frame.velocity_name.empty())
    throw InvalidInput({(has ? first : piece).file.string()},
                       fmt::format("has no velocities; {}, a piece of the same frame, has",
                                   (has ? piece : first).file.string()));
}

/// The time that pieces say. Throws InvalidInput where they differ.
std::optional<double> common_time(std::span<const ImagePiece> pieces) {
  const ImagePiece* timed = nullptr;
  for (const ImagePiece& piece : pieces) {
    if (!piece.frame.time) continue;
    if (!std::isfinite(*piece.frame.time))
      throw InvalidInput({piece.file.string()}, fmt::format("its time is {} s", *piece.frame.time));
    if (timed == nullptr) timed = &piece;
    if (*piece.frame.time != *timed->frame.time)
      throw InvalidInput({piece.file.string()},
                         fmt::format("its time is {} s; that of {}, a piece of the same frame, is {} s",
                                     *piece.frame.time, timed->file.string(), *timed->frame.time));
  }
  return timed == nullptr ? std::nullopt : timed->frame.time;
}

/// Where values are: value 0, and how far they are apart [m].
struct ValueLattice {
  Vec3 origin, spacing;
};

/// Of the piece, by the numbers of the lattice, which that of `file` is. Throws InvalidInput where it is on
/// another.
LatticeBox box_on(const ValueLattice& lattice, const ImagePiece& piece, const fs::path& file) {
  constexpr double kFarthest = 1e9, kTolerance = 1e-3, kRounding = 1e-6,
                   kMostTolerance = 0.2;  // of origins in text with few digits
  LatticeBox box;
  for (int c = 0; c < 3; ++c) {
    const int count = piece.frame.dims[c];
    const double first = (piece.frame.origin[c] - lattice.origin[c]) / lattice.spacing[c],
                 drift = count * (piece.frame.spacing[c] / lattice.spacing[c] - 1),
                 tolerance =
                     std::min(kTolerance + kRounding * std::abs(piece.frame.origin[c] / lattice.spacing[c]),
                              kMostTolerance);
    if (!(std::abs(first) < kFarthest) || !(std::abs(first - std::round(first)) <= tolerance) ||
        !(std::abs(drift) <= tolerance))
      throw InvalidInput(
          {piece.file.string()},
          fmt::format(
              "its values begin at ({:.9g}), ({:.9g}) apart; expected them on the lattice of {}, with "
              "values at ({:.9g}), ({:.9g}) apart",
              fmt::join(piece.frame.origin, ", "), fmt::join(piece.frame.spacing, ", "), file.string(),
              fmt::join(lattice.origin, ", "), fmt::join(lattice.spacing, ", ")));
    box.first[c] = static_cast<std::int64_t>(std::round(first));
    box.last[c] = box.first[c] + count - 1;
  }
  return box;
}

/// Of points, what belongs to cells begins with the same number.
LatticeBox values_in(LatticeBox points, bool of_cells) {
  if (of_cells)
    for (std::int64_t& last : points.last) --last;
  return points;
}

/// Where the pieces are, and what each is there for.
struct Arrangement {
  LatticeBox whole{};
  Vec3 origin = Vec3::Zero();               // of the first value of the whole [m]
  std::vector<LatticeBox> has{}, serves{};  // of each piece its values, and those of them that count
};

Arrangement arranged_by_list(std::span<const ImagePiece> pieces, const ImageLattice& list,
                             const fs::path& file) {
  const bool of_cells = pieces.front().of_cells;
  const Vec3 half = (of_cells ? 0.5 : 0.0) * list.spacing;
  Arrangement result{.whole = values_in(list.points, of_cells), .origin = list.origin};
  for (int c = 0; c < 3; ++c) result.origin[c] += static_cast<double>(list.points.first[c]) * list.spacing[c];
  if (of_cells) result.origin += half;
  for (const ImagePiece& piece : pieces) {
    const LatticeBox has = box_on({list.origin + half, list.spacing}, piece, file),
                     serves = values_in(*piece.points, of_cells).common_with(result.whole);
    if (!has.contains(serves))
      throw InvalidInput({piece.file.string()},
                         fmt::format("has the {} {}; expected {}, as {} says", of_cells ? "cells" : "points",
                                     box_text(has), box_text(serves), file.string()));
    result.has.push_back(has);
    result.serves.push_back(serves);
  }
  return result;
}

LatticeBox moved_back(LatticeBox box, const std::array<std::int64_t, 3>& by) {
  for (std::size_t c = 0; c < 3; ++c) {
    box.first[c] -= by[c];
    box.last[c] -= by[c];
  }
  return box;
}

/// By where they are, in the box around them all, whose first value is number 0.
Arrangement arranged(std::span<const ImagePiece> pieces) {
  const ImageFrame& first = pieces.front().frame;
  Arrangement result{.origin = first.origin};
  LatticeBox& whole = result.whole;
  bool found = false;  // a piece with values
  for (const ImagePiece& piece : pieces) {
    const LatticeBox box = box_on({first.origin, first.spacing}, piece, pieces.front().file);
    const bool is_empty = std::ranges::any_of(piece.frame.dims, [](int n) { return n == 0; });
    if (!found && !is_empty) whole = box, result.origin = piece.frame.origin;
    found = found || !is_empty;
    for (int c = 0; c < 3 && !is_empty; ++c) {
      if (box.first[c] < whole.first[c]) result.origin[c] = piece.frame.origin[c];
      whole.first[c] = std::min(whole.first[c], box.first[c]);
      whole.last[c] = std::max(whole.last[c], box.last[c]);
    }
    result.has.push_back(box);
  }
  for (LatticeBox& box : result.has) box = moved_back(box, whole.first);
  whole = moved_back(whole, whole.first);
  result.serves = result.has;
  return result;
}

/// Throws InvalidInput where a value is in none of the pieces.
void check_filled(const Arrangement& pieces, bool of_cells, const fs::path& file) {
  if (const auto gap = gap_between(pieces.whole, pieces.serves))
    throw InvalidInput({file.string()},
                       fmt::format("the pieces of this frame leave a gap: none has the {0} {1}; expected all "
                                   "from {2}",
                                   of_cells ? "cells" : "points", box_text(*gap), box_text(pieces.whole)));
}

/// Copies what a piece has of the whole, as far as it calls it ghosts or does not.
void copy_values(const ImagePiece& piece, const LatticeBox& has, const LatticeBox& serves, bool ghosts,
                 const LatticeBox& all, ImageFrame& whole) {
  for (std::int64_t k = serves.first[2]; k <= serves.last[2]; ++k)
    for (std::int64_t j = serves.first[1]; j <= serves.last[1]; ++j)
      for (std::int64_t i = serves.first[0]; i <= serves.last[0]; ++i) {
        const std::size_t from = has.index(i, j, k), to = all.index(i, j, k);
        const bool is_ghost = !piece.ghost.empty() && piece.ghost[from];
        if (is_ghost != ghosts) continue;
        if (!ghosts) check_number(piece.frame, from);
        whole.value[to] = piece.frame.value[from];
        if (!whole.velocity.empty()) whole.velocity[to] = piece.frame.velocity[from];
      }
}

}  // namespace

ImagePiece join_pieces(std::span<const ImagePiece> pieces, const std::optional<ImageLattice>& whole,
                       const fs::path& file) {
  const ImagePiece& first = pieces.front();
  for (const ImagePiece& piece : pieces) check_arrays(piece, first);
  const Arrangement at = whole ? arranged_by_list(pieces, *whole, file) : arranged(pieces);
  check_filled(at, first.of_cells, file);
  ImagePiece joined{.file = file, .of_cells = first.of_cells};
  ImageFrame& frame = joined.frame;
  const std::array<std::size_t, 3> count = at.whole.points();
  for (std::size_t c = 0; c < 3; ++c) frame.dims[c] = static_cast<int>(count[c]);
  frame.origin = at.origin;
  frame.spacing = whole ? whole->spacing : first.frame.spacing;
  frame.name = first.frame.name;
  frame.velocity_name = first.frame.velocity_name;
  frame.time = common_time(pieces);
  frame.value.resize(count[0] * count[1] * count[2]);
  if (!frame.velocity_name.empty()) frame.velocity.resize(frame.value.size());
  for (const bool ghosts : {true, false})
    for (std::size_t p = 0; p < pieces.size(); ++p) try {
        copy_values(pieces[p], at.has[p], at.serves[p], ghosts, at.whole, frame);
      } catch (const InvalidInput& error) {
        throw InvalidInput({pieces[p].file.string()}, error.what());
      }
  return joined;
}

}  // namespace kappaflow
