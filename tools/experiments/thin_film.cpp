#include "tools/experiments/thin_film.h"

#include <algorithm>
#include <cmath>

namespace kappaflow {
namespace {

constexpr double kFilmEdge = 0.1;       // of the largest thickness: the front
constexpr double kFilmDiffusion = 0.2;  // time step over cell^2 / diffusivity; 1/4 is the limit
constexpr double kFilmCourant = 0.4;    // over the time in which a wave crosses a cell

/// Of the cell [low, low + 1] in units of cells what [from, to] covers.
double covered(double low, double from, double to) {
  return std::max(0.0, std::min(low + 1, to) - std::max(low, from));
}

}  // namespace

ThinFilm::ThinFilm(const FilmLiquid& liquid, const FilmGrid& grid)
    : liquid_(liquid),
      grid_(grid),
      thickness_(grid.nx * grid.ny, 0),
      cubes_(thickness_.size(), 0),
      source_(thickness_.size(), 0),
      change_(thickness_.size(), 0) {}

void ThinFilm::set_source(const Vec2& lower, const Vec2& upper, double speed) {
  const Vec2 from = (lower - grid_.lower) / grid_.cell, to = (upper - grid_.lower) / grid_.cell;
  for (std::size_t j = 0; j < grid_.ny; ++j)
    for (std::size_t i = 0; i < grid_.nx; ++i)
      source_[j * grid_.nx + i] = speed * covered(static_cast<double>(i), from.x(), to.x()) *
                                  covered(static_cast<double>(j), from.y(), to.y());
}

void ThinFilm::advance(double time) {
  while (time_ < time) {
    const double dt = time_step(time - time_);
    step(dt);
    time_ = dt < time - time_ ? time_ + dt : time;
  }
}

double ThinFilm::volume() const {
  double sum = 0;
  for (const double h : thickness_) sum += h;
  return sum * grid_.cell * grid_.cell;
}

/// With a film that is nowhere thicker.
double ThinFilm::longest_step(double thickest) const {
  const double mobility = thickest * thickest / liquid_.viscosity;
  const double diffusivity = liquid_.into_plane * mobility * thickest / 3,
               wave = liquid_.down_slope * mobility;
  return 1 / (diffusivity / (kFilmDiffusion * grid_.cell * grid_.cell) + wave / (kFilmCourant * grid_.cell));
}

/// Short enough for what the source makes of the film by its end.
double ThinFilm::time_step(double longest) const {
  const double thickest = *std::ranges::max_element(thickness_), rise = *std::ranges::max_element(source_);
  double dt = longest;
  while (longest_step(thickest + rise * dt) < dt) dt *= 0.9;
  return dt;
}

void ThinFilm::step(double dt) {
  for (std::size_t k = 0; k < thickness_.size(); ++k) {
    cubes_[k] = thickness_[k] * thickness_[k] * thickness_[k];
    change_[k] = source_[k];
  }
  const double spread = liquid_.into_plane / (6 * liquid_.viscosity * grid_.cell * grid_.cell),
               run = liquid_.down_slope / (3 * liquid_.viscosity * grid_.cell);
  const auto exchange = [&](std::size_t a, std::size_t b, double down) {
    if (cubes_[a] + cubes_[b] == 0) return;
    const double flux = spread * (cubes_[a] + cubes_[b]) * (thickness_[a] - thickness_[b]) + down * cubes_[a];
    change_[a] -= flux;
    change_[b] += flux;
  };
  for (std::size_t j = 0; j < grid_.ny; ++j)
    for (std::size_t i = 0; i < grid_.nx; ++i) {
      const std::size_t k = j * grid_.nx + i;
      if (i + 1 < grid_.nx) exchange(k, k + 1, run);
      if (j + 1 < grid_.ny) exchange(k, k + grid_.nx, 0);
    }
  for (std::size_t k = 0; k < thickness_.size(); ++k) thickness_[k] += dt * change_[k];
}

/// Linear between the cells' centres; beyond the outermost ones theirs.
double ThinFilm::at(const Vec2& place) const {
  const Vec2 p = (place - grid_.lower) / grid_.cell - Vec2(0.5, 0.5);
  const double x = std::clamp(p.x(), 0.0, static_cast<double>(grid_.nx - 1)),
               y = std::clamp(p.y(), 0.0, static_cast<double>(grid_.ny - 1));
  const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
  const std::size_t in = std::min(i + 1, grid_.nx - 1), jn = std::min(j + 1, grid_.ny - 1);
  const double s = x - static_cast<double>(i), t = y - static_cast<double>(j);
  return (1 - t) * ((1 - s) * thickness(i, j) + s * thickness(in, j)) +
         t * ((1 - s) * thickness(i, jn) + s * thickness(in, jn));
}

double ThinFilm::reach(const Vec2& from, const Vec2& direction) const {
  const double edge = kFilmEdge * *std::ranges::max_element(thickness_), step = grid_.cell / 10;
  const double whole = grid_.cell * std::hypot(static_cast<double>(grid_.nx), static_cast<double>(grid_.ny));
  double reached = 0;
  for (double r = 0; r < whole; r += step) {
    const Vec2 place = from + r * direction;
    const Vec2 end = (place - grid_.lower) / grid_.cell;
    if (end.x() > static_cast<double>(grid_.nx) || end.y() > static_cast<double>(grid_.ny) || end.x() < 0)
      break;
    if (at(place) >= edge) reached = r;
  }
  return reached;
}

}  // namespace kappaflow
