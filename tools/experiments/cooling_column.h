// The theory of a wide layer of liquid that flows down a slope and cools: a column of it.
#pragma once

#include <vector>

#include "solver/temperature_law.h"

namespace kappaflow {

/// A Newtonian layer on a floor without slip, its top free.
struct CoolingLayer {
  double thickness = 0;     ///< [m]
  double acceleration = 0;  ///< by gravity, along the floor [m/s2]
  double viscosity = 0;     ///< kinematic, at the law's reference temperature [m2/s]
  TemperatureLaw law;
  double diffusivity = 0;        ///< of heat [m2/s]
  double conductivity = 0;       ///< [W/(m K)]
  double first_temperature = 0;  ///< of all of it [K]
  double floor_temperature = 0;  ///< of the floor's surface [K]
  double air_temperature = 0;    ///< [K]
  double convection = 0;         ///< heat transfer from the top to the air [W/(m2 K)]
};

/// What a layer so wide that all columns are alike does: heat goes across it,
///   T_t = diffusivity T_zz,   T = T_floor at z = 0,   -k T_z = convection (T - T_air) at the top,
/// and without inertia the weight of what lies above shears it,
///   u_z = acceleration (thickness - z) / nu(T),   u = 0 at z = 0.
/// Finite volumes, implicit in time; heights are shares of the thickness.
class CoolingColumn {
 public:
  explicit CoolingColumn(const CoolingLayer& layer);

  void advance(double time);                ///< until then [s]
  double temperature(double height) const;  ///< [K]
  double speed(double height) const;        ///< [m/s]
  double shift(double height) const;        ///< how far the liquid there has gone [m]

 private:
  void conduct(double dt);
  void shear();

  CoolingLayer layer_;
  double cell_, time_ = 0;
  std::vector<double> temperature_;    // of the cells
  std::vector<double> speed_, shift_;  // at their edges, from the floor
  std::vector<double> upper_, value_;  // Thomas' algorithm
};

}  // namespace kappaflow
