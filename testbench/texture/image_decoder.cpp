#include "testbench/texture/image_decoder.hpp"

#include "testbench/system/error.hpp"

namespace testbench {

void fail_at_image(const std::string& where, const std::string& found, const std::string& allowed) {
  throw InputError(where + ": found " + found + "; allowed: " + allowed);
}

void require_image_size(std::int64_t width, std::int64_t height, const std::string& where) {
  if (!is_allowed_image_size(width, height))
    fail_at_image(where, "an image of " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                  kAllowedImageSize);
}

Image decode_image(std::string_view bytes, const std::string& where) {
  constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";
  constexpr std::string_view kJpegStart = "\xff\xd8\xff";
  if (bytes.substr(0, kPngStart.size()) == kPngStart) return decode_png(bytes, where);
  if (bytes.substr(0, kJpegStart.size()) == kJpegStart) return decode_jpeg(bytes, where);
  fail_at_image(where, bytes.empty() ? "an empty image" : "an image in another format",
                "a PNG or JPEG file of 8 bits a channel");
}

}  // namespace testbench
