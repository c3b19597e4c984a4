// Cooper & Verner, "Some explicit Runge-Kutta methods of high order", SIAM J. Numer. Anal. 9, 1972; the table
// is that of Hairer, Norsett & Wanner, "Solving Ordinary Differential Equations I", II.6.
#include "tools/experiments/flow_map.h"

namespace kappaflow {

namespace {
constexpr double kRoot21 = 4.5825756949558400065880471937280085;  // sqrt(21)
}

constexpr FlowMapMethod kCooperVerner{
    {{},
     {1. / 2},
     {1. / 4, 1. / 4},
     {1. / 7, (-7 - 3 * kRoot21) / 98, (21 + 5 * kRoot21) / 49},
     {(11 + kRoot21) / 84, 0, (18 + 4 * kRoot21) / 63, (21 - kRoot21) / 252},
     {(5 + kRoot21) / 48, 0, (9 + kRoot21) / 36, (-231 + 14 * kRoot21) / 360, (63 - 7 * kRoot21) / 80},
     {(10 - kRoot21) / 42, 0, (-432 + 92 * kRoot21) / 315, (633 - 145 * kRoot21) / 90,
      (-504 + 115 * kRoot21) / 70, (63 - 13 * kRoot21) / 35},
     {1. / 14, 0, 0, 0, (14 - 3 * kRoot21) / 126, (13 - 3 * kRoot21) / 63, 1. / 9},
     {1. / 32, 0, 0, 0, (91 - 21 * kRoot21) / 576, 11. / 72, (-385 - 75 * kRoot21) / 1152,
      (63 + 13 * kRoot21) / 128},
     {1. / 14, 0, 0, 0, 1. / 9, (-733 - 147 * kRoot21) / 2205, (515 + 111 * kRoot21) / 504,
      (-51 - 11 * kRoot21) / 56, (132 + 28 * kRoot21) / 245},
     {0, 0, 0, 0, (-42 + 7 * kRoot21) / 18, (-18 + 28 * kRoot21) / 45, (-273 - 53 * kRoot21) / 72,
      (301 + 53 * kRoot21) / 72, (28 - 28 * kRoot21) / 45, (49 - 7 * kRoot21) / 18}},
    {1. / 20, 0, 0, 0, 0, 0, 0, 49. / 180, 16. / 45, 49. / 180, 1. / 20}};

}  // namespace kappaflow
