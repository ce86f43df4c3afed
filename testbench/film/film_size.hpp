#pragma once

#include <optional>
#include <string>

#include "testbench/scene/scene.hpp"

namespace testbench {

inline constexpr int kMaxFilmSide = 16384;

/// "480x480"; nothing for any other text or a side that is not 1 to kMaxFilmSide.
std::optional<FilmSize> parse_film_size(const std::string& text);

/// "WIDTHxHEIGHT, each 1 to 16384"
std::string allowed_film_size();

}  // namespace testbench
