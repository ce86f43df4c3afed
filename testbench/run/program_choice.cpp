#include "testbench/run/program_choice.hpp"

#include "testbench/mono_image/scene_features.hpp"

namespace testbench {

std::string choose_program(const Scene& scene, const model::ChipConfig& chip, const GivenOptions& given,
                           path_tracer::ProgramConfig& program) {
  if (given.count("light_candidates") == 0)
    program.light_candidates = suited_light_candidates(scene, program);
  if (given.count("estimator") == 0) program.estimator = suited_estimator(scene, program.light_candidates);
  program = built_for(scene, program);
  return choose_tree(TriangleCount(scene), chip, given, program);
}

}  // namespace testbench
