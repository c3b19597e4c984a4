// Cooper & Verner, "Some explicit Runge-Kutta methods of high order", SIAM J. Numer. Anal. 9, 1972; the table
// is that of Hairer, Norsett & Wanner, "Solving Ordinary Differential Equations I", II.6.
#include "surface/field/flow_map.h"

namespace kappaflow {

namespace {
constexpr double r = 4.5825756949558400065880471937280085;  // sqrt(21)
}

constexpr FlowMapMethod kCooperVerner{
    {{},
     {1. / 2},
     {1. / 4, 1. / 4},
     {1. / 7, (-7 - 3 * r) / 98, (21 + 5 * r) / 49},
     {(11 + r) / 84, 0, (18 + 4 * r) / 63, (21 - r) / 252},
     {(5 + r) / 48, 0, (9 + r) / 36, (-231 + 14 * r) / 360, (63 - 7 * r) / 80},
     {(10 - r) / 42, 0, (-432 + 92 * r) / 315, (633 - 145 * r) / 90, (-504 + 115 * r) / 70,
      (63 - 13 * r) / 35},
     {1. / 14, 0, 0, 0, (14 - 3 * r) / 126, (13 - 3 * r) / 63, 1. / 9},
     {1. / 32, 0, 0, 0, (91 - 21 * r) / 576, 11. / 72, (-385 - 75 * r) / 1152, (63 + 13 * r) / 128},
     {1. / 14, 0, 0, 0, 1. / 9, (-733 - 147 * r) / 2205, (515 + 111 * r) / 504, (-51 - 11 * r) / 56,
      (132 + 28 * r) / 245},
     {0, 0, 0, 0, (-42 + 7 * r) / 18, (-18 + 28 * r) / 45, (-273 - 53 * r) / 72, (301 + 53 * r) / 72,
      (28 - 28 * r) / 45, (49 - 7 * r) / 18}},
    {1. / 20, 0, 0, 0, 0, 0, 0, 49. / 180, 16. / 45, 49. / 180, 1. / 20}};

}  // namespace kappaflow
