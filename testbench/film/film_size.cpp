#include "testbench/film/film_size.hpp"

#include <cstdio>

namespace testbench {

std::optional<FilmSize> parse_film_size(const std::string& text) {
  long long width = 0;
  long long height = 0;
  char end = 0;
  const bool two_numbers = std::sscanf(text.c_str(), "%lldx%lld%c", &width, &height, &end) == 2;
  const auto allowed = [](long long side) { return side >= 1 && side <= kMaxFilmSide; };
  if (!two_numbers || !allowed(width) || !allowed(height)) return std::nullopt;
  return FilmSize{static_cast<int>(width), static_cast<int>(height)};
}

std::string allowed_film_size() {
  return "WIDTHxHEIGHT, each 1 to " + std::to_string(kMaxFilmSide);
}

}  // namespace testbench
