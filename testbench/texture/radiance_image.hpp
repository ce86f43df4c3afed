#pragma once

#include <filesystem>

#include "testbench/texture/image.hpp"

namespace testbench {

/// Reads an environment's image, OpenEXR (channels R, G, B) or Radiance HDR; which of them it is, its first
/// bytes say. Throws InputError (file, what was found, what is allowed) for another file, one that is cut
/// off, a size that is_allowed_image_size() refuses, a value that is not finite or is negative, and an image
/// that is black all over.
RadianceImage read_radiance_image(const std::filesystem::path& path);

}  // namespace testbench
