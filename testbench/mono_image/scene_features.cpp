#include "testbench/mono_image/scene_features.hpp"

namespace testbench {

path_tracer::Features features_of(const Scene& /*scene*/, const path_tracer::ProgramConfig& config) {
  path_tracer::Features features;
  const bool may_share = features.lobes.evaluable() && !features.lobes.only_diffuse();
  features.multiple_importance =
      config.program != path_tracer::Program::segments && features.lights &&
      (config.estimator == path_tracer::Estimator::mis ||
       (config.estimator == path_tracer::Estimator::per_lobe && may_share));
  return features;
}

path_tracer::ProgramConfig built_for(const Scene& scene, path_tracer::ProgramConfig config) {
  config.features = features_of(scene, config);
  return config;
}

}  // namespace testbench
