#pragma once

#include <string>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Scenes of any number of triangles, to see what a tree of boxes and the chip make of them.
enum class GeneratedScene : std::uint8_t {
  blob,          ///< a dented ball, finely tessellated, in a box like Cornell's
  sphere_flake,  ///< balls on balls on balls in that box (Haines, "A Proposal for Standard Graphics
                 ///< Environments", IEEE CG&A 7(11), 1987)
  stadium,       ///< the blob, 10^5 times smaller than the stadium that it lies in
  needles,       ///< triangles a thousand times longer than wide, all through that box
};

inline constexpr GeneratedScene kGeneratedScenes[] = {GeneratedScene::blob, GeneratedScene::sphere_flake,
                                                      GeneratedScene::stadium, GeneratedScene::needles};
std::string name_of(GeneratedScene scene);

inline constexpr int kLeastGeneratedTriangles = 100;
inline constexpr int kMostGeneratedTriangles = 10000000;

/// About `triangles` of them, the room included: as near as whole patches come. The same number gives the
/// same scene on every machine.
/// @throws InputError for a number out of range
Scene generate_scene(GeneratedScene kind, int triangles);

}  // namespace testbench
