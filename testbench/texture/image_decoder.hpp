#pragma once

#include <string>
#include <string_view>

#include "testbench/texture/image.hpp"

namespace testbench {

/// Decodes a PNG or JPEG file of 8 bits a channel or fewer; which of them it is, its first bytes say. Colour
/// profiles and gamma chunks are ignored, see glTF 2.0, section 3.8.3; a PNG's palette and
/// transparent colour become RGB and alpha.
/// @param where the file or part of a file, in messages
/// Throws InputError for bytes that are neither, cut off or damaged, for 16 bits a channel, CMYK, or a size
/// that is_allowed_image_size() refuses; no memory is taken for pixels that the bytes cannot hold.
Image decode_image(std::string_view bytes, const std::string& where);

/// The two formats; decode_image() has what they throw.
Image decode_png(std::string_view bytes, const std::string& where);
Image decode_jpeg(std::string_view bytes, const std::string& where);

/// Throws InputError for an image that cannot be used.
[[noreturn]] void fail_at_image(const std::string& where, const std::string& found,
                                const std::string& allowed);
/// Throws InputError unless is_allowed_image_size().
void require_image_size(std::int64_t width, std::int64_t height, const std::string& where);

}  // namespace testbench
