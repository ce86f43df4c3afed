#include "testbench/mono_image/lights.hpp"

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "testbench/mono_image/environment_cells.hpp"
#include "testbench/mono_image/light_candidates.hpp"
#include "testbench/mono_image/light_choice.hpp"
#include "testbench/mono_image/to_record.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// The disks of suns; parallel light has none.
std::vector<path_tracer::SunRecord> suns_of(const Scene& scene) {
  std::vector<path_tracer::SunRecord> suns;
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::sun || !(light.angular_diameter_radians > 0.0)) continue;
    const double half_angle = 0.5 * light.angular_diameter_radians;
    const double sine = std::sin(half_angle);
    suns.push_back({to_record(-light.direction),
                    to_record(light.intensity / (glm::pi<double>() * sine * sine)), std::cos(half_angle)});
  }
  return suns;
}

void require_light(const Scene& scene, bool has_emitters) {
  if (has_emitters || scene.environment.constant != glm::dvec3(0.0)) return;
  throw InputError(
      scene.name +
      (scene.environment.image ? ": the environment's image is black and nothing else" : ": nothing") +
      " emits light; a material with Ke above 0, an environment or a light is needed");
}

/// Fills in the records of lights as often as they are chosen.
void add_records(const std::vector<Emitter>& emitters, const LightChoice& choice, Lights& lights) {
  lights.cdf = choice.cdf;
  lights.classes = choice.classes;
  for (std::size_t i = 0; i < choice.order.size(); ++i) {
    const Emitter& emitter = emitters[choice.order[i]];
    const double pdf = choice.probability[i] / emitter.measure;
    path_tracer::LightRecord record = emitter.record;
    record.inverse_pdf = 1.0 / pdf;
    if (emitter.shape() == path_tracer::LightShape::environment) record.edge1.z = float(pdf);
    lights.records.push_back(record);
    lights.triangles.push_back(emitter.triangles);
  }
}

/// The density by which shadow rays find each cell.
/// @param first place of the cells among the emitters
std::vector<float> pdf_of_cells(const EnvironmentCells& cells, const LightChoice& choice, std::size_t first) {
  std::vector<float> pdf(cells.emitters.size());
  for (std::size_t i = 0; i < choice.order.size(); ++i) {
    if (choice.order[i] < first) continue;
    const std::size_t cell = choice.order[i] - first;
    pdf[cell] = float(choice.probability[i] / cells.emitters[cell].measure);
  }
  return pdf;
}

/// Everything that shadow rays are aimed at. The environment's cells come last.
struct AllEmitters {
  std::vector<Emitter> emitters;
  EnvironmentCells cells;
  std::size_t first_cell = 0;  ///< among the emitters
};

AllEmitters all_emitters(const Scene& scene, const std::vector<std::int32_t>& faces,
                         path_tracer::LightSampling sampling, double radius) {
  AllEmitters all;
  all.emitters = surface_emitters(scene, faces, sampling);
  append(all.emitters, light_emitters(scene, radius));
  all.cells = environment_cells(scene, radius);
  all.first_cell = all.emitters.size();
  append(all.emitters, all.cells.emitters);
  require_light(scene, !all.emitters.empty());
  return all;
}

}  // namespace

LightSurvey survey_lights(const Scene& scene, const std::vector<std::int32_t>& faces,
                          path_tracer::LightSampling sampling) {
  const double radius = surroundings_of(scene).radius;
  return {sampling, light_weights(scene, all_emitters(scene, faces, sampling, radius).emitters)};
}

Lights make_lights(const Scene& scene, const std::vector<std::int32_t>& faces,
                   path_tracer::LightSampling sampling, const LightSurvey* survey) {
  const double radius = surroundings_of(scene).radius;
  const AllEmitters all = all_emitters(scene, faces, sampling, radius);
  Lights lights;
  lights.suns = suns_of(scene);
  if (all.emitters.empty()) return lights;
  const bool is_surveyed = survey != nullptr && survey->sampling == sampling;
  const LightWeights weights = is_surveyed ? survey->weights : light_weights(scene, all.emitters);
  const LightChoice choice = choose_by(weights.choice);
  add_records(all.emitters, choice, lights);
  lights.candidates = light_candidates(all.emitters, choice, weights.visibility, radius);
  if (!all.cells.emitters.empty())
    lights.environment_texels =
        environment_texels(scene.environment, all.cells, pdf_of_cells(all.cells, choice, all.first_cell));
  return lights;
}

}  // namespace testbench
