#include "testbench/paper/paper_alternatives.hpp"

#include "model/config/chip_parameters.hpp"

namespace testbench {

Scene with_four_times_the_triangles(const Scene& scene) {
  Scene finer = scene;
  finer.triangles.clear();
  for (const Triangle& triangle : scene.triangles) {
    const glm::dvec3* corner = triangle.vertex;
    const glm::dvec3 middle[3] = {0.5 * (corner[0] + corner[1]), 0.5 * (corner[1] + corner[2]),
                                  0.5 * (corner[2] + corner[0])};
    const glm::dvec3 parts[4][3] = {{corner[0], middle[0], middle[2]},
                                    {middle[0], corner[1], middle[1]},
                                    {middle[2], middle[1], corner[2]},
                                    {middle[0], middle[1], middle[2]}};
    for (const auto& part : parts) {
      Triangle smaller = triangle;
      for (int i = 0; i < 3; ++i) smaller.vertex[i] = part[i];
      finer.triangles.push_back(smaller);
    }
  }
  return finer;
}

std::vector<Assumptions> paper_alternatives(const Assumptions& base, const Scene& closed_box) {
  std::vector<Assumptions> all{base};
  const auto add = [&](const char* name) -> Assumptions& {
    all.push_back(base);
    all.back().name = name;
    return all.back();
  };
  const auto set = [](Assumptions& assumptions, const char* key, const char* value) {
    model::set_parameter(assumptions.chip, key, value, "calibrate");
  };
  Assumptions& clock = add("clock of 250 MHz");
  set(clock, "chip.clock_hz", "250000000");
  set(clock, "ddr.refresh_interval_cycles", "1950");
  set(add("both chips of the board"), "board.chips", "2");
  Assumptions& primitives = add("four times the triangles");
  primitives.scene = with_four_times_the_triangles(base.scene);
  add("closed box").scene = closed_box;
  all.back().scene.film = base.scene.film;
  add("roulette from the first segment").program.roulette_start = 0;
  add("shadow rays only where facing").program.cull_shadow_rays = true;
  add("bins of 4 blocks").program.bin_blocks = 4;
  add("bins of 16 blocks").program.bin_blocks = 16;
  set(add("PIO serves in strict order"), "pio.arbitration", "strict_fifo");
  set(add("a PIO engine each way"), "pio.arbitration", "queue_per_direction");
  Assumptions& two_constants = add("no cost of a call fitted");
  two_constants.fits_transfer_call = false;
  set(two_constants, "control.transfer_call_cycles",
      model::parameter_text(model::default_chip_config(), "control.transfer_call_cycles").c_str());
  return all;
}

}  // namespace testbench
