#include <png.h>

#include <cstring>

#include "testbench/texture/image_decoder.hpp"

namespace testbench {
namespace {

/// Reads one PNG file with libpng, which leaves its functions by longjmp() when it meets an error. So each
/// step calls nothing but libpng.
class PngDecoder {
 public:
  PngDecoder(std::string_view bytes, const std::string& where) : rest_(bytes), where_(where) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  Image decode() {
    if (info_ == nullptr) throw std::bad_alloc();
    const std::size_t bytes = rest_.size();
    read_header();
    require_image_size(png_get_image_width(png_, info_), png_get_image_height(png_, info_), where_);
    if (png_get_bit_depth(png_, info_) > 8)
      fail_at_image(where_, "a PNG file of 16 bits a channel", "8 bits a channel or fewer");
    const std::size_t height = png_get_image_height(png_, info_);
    // zlib expands by a factor below 1032.
    if (png_get_rowbytes(png_, info_) * height / 1032 > bytes)
      fail_at_image(where_, "a PNG file of fewer bytes than its pixels need", "a whole PNG file");
    choose_eight_bits();
    return read_pixels();
  }

 private:
  static PngDecoder& decoder_of(png_structp png) { return *static_cast<PngDecoder*>(png_get_error_ptr(png)); }

  [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
    std::strncpy(decoder_of(png).message_, message, sizeof(message_) - 1);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}

  static void read_bytes(png_structp png, png_bytep to, std::size_t count) {
    std::string_view& rest = decoder_of(png).rest_;
    if (count > rest.size()) png_error(png, "the file is cut off");
    std::memcpy(to, rest.data(), count);
    rest.remove_prefix(count);
  }

  [[noreturn]] void fail() const {
    fail_at_image(where_, std::string("a PNG file that cannot be read (") + message_ + ")",
                  "a whole PNG file of 8 bits a channel");
  }

  void read_header() {
    if (setjmp(png_jmpbuf(png_)) != 0) fail();
    png_set_read_fn(png_, nullptr, read_bytes);
    png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);  // require_image_size() says more
    png_read_info(png_, info_);
  }

  void choose_eight_bits() {
    if (setjmp(png_jmpbuf(png_)) != 0) fail();
    png_set_expand(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
  }

  Image read_pixels() {
    Image image;
    image.width = static_cast<int>(png_get_image_width(png_, info_));
    image.height = static_cast<int>(png_get_image_height(png_, info_));
    image.channels = png_get_channels(png_, info_);
    const std::size_t row_bytes = png_get_rowbytes(png_, info_);
    image.texels.resize(row_bytes * std::size_t(image.height));
    rows_.reserve(std::size_t(image.height));
    for (std::size_t row = 0; row < std::size_t(image.height); ++row)
      rows_.push_back(image.texels.data() + row * row_bytes);
    if (!read_rows()) fail();
    return image;
  }

  bool read_rows() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows_.data());
    png_read_end(png_, nullptr);
    return true;
  }

  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::string_view rest_;
  const std::string& where_;
  char message_[100] = {};
  std::vector<png_bytep> rows_;
};

}  // namespace

Image decode_png(std::string_view bytes, const std::string& where) {
  return PngDecoder(bytes, where).decode();
}

}  // namespace testbench
