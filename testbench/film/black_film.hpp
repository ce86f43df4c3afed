#pragma once

#include <string>

#include "testbench/film/film.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// Whether every pixel is zero. Ends at the first that is not.
bool is_black(const Film& film);

/// Whether some pixel is not zero, and all are smaller than any normal number in single precision.
bool is_below_single_precision(const Film& film);

/// Why a film of the scene may be all black, as a clause: what a few rays through the film meet, and whether
/// any light faces what they meet. An estimate by brute force, for films that are black only.
/// @param casts_shadow_rays whether the program does, without which lights without area are not found
std::string why_black(const Scene& scene, bool casts_shadow_rays);

}  // namespace testbench
