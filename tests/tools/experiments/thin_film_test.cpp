// The theory of thin films against its similarity solutions.
#include "tools/experiments/thin_film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kappaflow {
namespace {

/// Plane flow of a block of liquid from x = 0 to `length`, one metre high, on cells of 5 cm.
ThinFilm plane_block(const FilmLiquid& liquid, double length, double plane) {
  constexpr double kCell = 0.05;
  ThinFilm film(liquid, {{0, 0}, kCell, static_cast<std::size_t>(plane / kCell), 1});
  for (std::size_t i = 0; i < static_cast<std::size_t>(length / kCell + 0.5); ++i) film.thickness(i, 0) = 1;
  return film;
}

double plane_front(const ThinFilm& film) {
  return film.reach({0, 0.025}, {1, 0});
}

// Huppert, "The propagation of two-dimensional and axisymmetric viscous gravity currents over a rigid
// horizontal surface" (1982): x = 1.411 (g q^3 t / (3 nu))^(1/5), of the area q; the front lies within a
// cell.
TEST(ThinFilm, SpreadsOnAFloorAsTheFifthRootOfTime) {
  ThinFilm film = plane_block({1, 0, 10}, 1, 12);
  for (const double time : {100.0, 1000.0}) {
    film.advance(time);
    const double known = 1.411 * std::pow(10 * time / 3, 0.2);
    EXPECT_NEAR(plane_front(film), known, 0.05) << time;
  }
  EXPECT_NEAR(film.volume(), 0.05, 1e-14);
}

// Huppert, "Flow and instability of viscous gravity currents down a slope" (1982):
// x = (9 q^2 g sin(slope) t / (4 nu))^(1/3) and h = (nu x / (g sin(slope) t))^(1/2) behind the front, of
// liquid that was all at x = 0: a block as long as a tenth of the way is 3 percent of the way ahead.
TEST(ThinFilm, RunsDownASlopeAsTheThirdRootOfTime) {
  ThinFilm film = plane_block({1, 10, 0}, 1, 30);
  const auto known = [](double time) { return std::cbrt(9 * 10 * time / 4); };
  film.advance(100);
  const double first = plane_front(film);
  EXPECT_NEAR(first, known(100), 0.03 * known(100));
  EXPECT_NEAR(film.thickness(100, 0), std::sqrt(5.025 / (10 * 100)), 0.01 * std::sqrt(5.025 / 1000));
  film.advance(800);
  EXPECT_NEAR(std::log(plane_front(film) / first) / std::log(8), 1.0 / 3, 0.005);
  EXPECT_NEAR(film.volume(), 0.05, 1e-14);
}

// Huppert (1982) as above, liquid that comes at a constant rate Q on a floor: r = 0.715 (g Q^3 / (3
// nu))^(1/8) t^(1/2). The quarter of the plane has closed edges, and the source there a quarter of its rate.
TEST(ThinFilm, SpreadsFromASourceAsTheRootOfTime) {
  constexpr double kCell = 0.04, kSource = 0.08;
  ThinFilm film({1, 0, 10}, {{0, 0}, kCell, 60, 60});
  const double rate = 0.02;
  film.set_source({-kSource, -kSource}, {kSource, kSource}, rate / std::pow(2 * kSource, 2));
  film.advance(30);
  EXPECT_NEAR(film.volume(), rate * 30 / 4, 1e-12);
  const double known = 0.715 * std::pow(10 * std::pow(rate, 3) / 3, 0.125) * std::sqrt(30);
  for (const double direction : {0.0, 0.25, 0.5}) {
    const double angle = direction * std::numbers::pi;
    EXPECT_NEAR(film.reach({0, 0}, {std::cos(angle), std::sin(angle)}), known, kCell) << direction;
  }
}

// Half of a source's plane is the whole's half, whatever the slope.
TEST(ThinFilm, EdgesAreLinesOfSymmetry) {
  ThinFilm half({1, 2, 10}, {{-1, 0}, 0.1, 40, 15}), whole({1, 2, 10}, {{-1, -1.5}, 0.1, 40, 30});
  for (ThinFilm* film : {&half, &whole}) {
    film->set_source({-0.2, -0.2}, {0.2, 0.2}, 0.5);
    film->advance(5);
  }
  for (std::size_t i = 0; i < 40; ++i)
    for (std::size_t j = 0; j < 15; ++j) EXPECT_NEAR(half.thickness(i, j), whole.thickness(i, 15 + j), 1e-12);
}

}  // namespace
}  // namespace kappaflow
