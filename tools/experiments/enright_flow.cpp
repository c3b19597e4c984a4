#include "tools/experiments/enright_flow.h"

namespace kappaflow {

template class FlowMapField<EnrightFlow>;
template class FlowMapMotion<EnrightFlow>;

}  // namespace kappaflow
