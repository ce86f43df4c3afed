#pragma once

#include <string>
#include <string_view>

#include "testbench/texture/image.hpp"

namespace testbench {

/// Whether the bytes begin as a file in Radiance's format do.
bool is_hdr(std::string_view bytes);

/// Decodes a Radiance HDR file: RGB with a common exponent (RGBE), its rows flat or with run lengths of
/// either kind, from the top left or with -Y, +X replaced by +Y, -X. Values are divided by the header's
/// EXPOSURE. Source: Ward, "Real Pixels", Graphics Gems II, 1991, chapter II.5. Throws InputError (`where`,
/// what was found, what is allowed) for a file that is cut off or no such image, XYZE, columns before rows,
/// and a size that is_allowed_image_size() refuses.
RadianceImage decode_hdr(std::string_view bytes, const std::string& where);

}  // namespace testbench
