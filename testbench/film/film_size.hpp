#pragma once

#include <optional>
#include <string>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The size that a text like "480x480" names; std::nullopt for any other text or a side outside 1 to
/// kMaxFilmSide.
std::optional<FilmSize> parse_film_size(const std::string& text);

/// The allowed texts for error messages: "WIDTHxHEIGHT, each 1 to 16384".
std::string allowed_film_size();

}  // namespace testbench
