#pragma once

#include <kappaflow/surface/motion/velocity.h>

void evaluate_height(const kappaflow::Field& field, const kappaflow::SurfacePoints& points,
                     const kappaflow::VelocityOptions& options, kappaflow::VelocitySpans result);
