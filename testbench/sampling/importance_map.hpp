#pragma once

#include <filesystem>

#include "testbench/sampling/sample_counts.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// Reads an importance map: an OpenEXR image of the film's size. The importance of a pixel is the luminance
/// of channels R, G and B (Rec. 709), else channel Y, else the only channel.
///
/// Throws InputError (file, what was found, what is allowed) for another file, another size, an importance
/// that is not finite or is negative, and for a map of zeros.
std::vector<double> read_importance(const std::filesystem::path& path, FilmSize film);

/// Throws InputError, naming `path`, where importance * samples is more than kMostPixelSamples.
void require_countable(const std::vector<double>& importance, int samples, const std::filesystem::path& path,
                       FilmSize film);

}  // namespace testbench
