#pragma once

#include <string>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Scenes with any number of triangles, to measure how the chip and trees of boxes cope with size and shape.
enum class GeneratedScene : std::uint8_t {
  blob,          ///< a dented ball, finely tessellated, in a Cornell box
  sphere_flake,  ///< balls on balls on balls in a Cornell box (Haines, "A Proposal for Standard Graphics
                 ///< Environments", IEEE CG&A 7(11), 1987)
  stadium,       ///< the blob in a stadium 10^5 times larger than it
  needles,       ///< triangles a thousand times longer than wide, all through a Cornell box
  many_lights,   ///< a ball among small square lights of 24 colours and powers, some behind a wall
};

inline constexpr GeneratedScene kGeneratedScenes[] = {GeneratedScene::blob, GeneratedScene::sphere_flake,
                                                      GeneratedScene::stadium, GeneratedScene::needles,
                                                      GeneratedScene::many_lights};
std::string name_of(GeneratedScene scene);

inline constexpr int kLeastGeneratedTriangles = 100;
inline constexpr int kMostGeneratedTriangles = 10000000;

/// Returns a scene of about `triangles` triangles, including the room's; the number is not exact because
/// surfaces are made of whole patches. The same arguments give the same scene on every machine.
/// @throws InputError if `triangles` is out of range
Scene generate_scene(GeneratedScene kind, int triangles);

}  // namespace testbench
