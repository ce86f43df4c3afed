#include <cstdio>  // jpeglib.h needs it

#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <new>

#include "testbench/texture/image_decoder.hpp"

namespace testbench {
namespace {

/// Reads one JPEG file with libjpeg, which is told to leave its functions by longjmp() when it meets an
/// error. So each step calls nothing but libjpeg.
class JpegDecoder {
 public:
  JpegDecoder(std::string_view bytes, const std::string& where) : bytes_(bytes), where_(where) {
    jpeg_.err = jpeg_std_error(&errors_);
    errors_.error_exit = on_error;
    errors_.emit_message = on_message;
    jpeg_.client_data = this;
    progress_.progress_monitor = on_progress;
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&jpeg_); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  Image decode() {
    read_header();
    require_image_size(jpeg_.image_width, jpeg_.image_height, where_);
    if (jpeg_.jpeg_color_space == JCS_CMYK || jpeg_.jpeg_color_space == JCS_YCCK)
      fail_at_image(where_, "a JPEG file in CMYK", "RGB or grey");
    // Each block of 8 x 8 pixels takes a bit at least, for its mean.
    const std::size_t blocks = std::size_t((jpeg_.image_width + 7) / 8) * ((jpeg_.image_height + 7) / 8);
    if (blocks / 8 > bytes_.size())
      fail_at_image(where_, "a JPEG file of fewer bytes than its pixels need", "a whole JPEG file");
    start();
    return read_pixels();
  }

 private:
  static constexpr int kMostScans = 200;

  static JpegDecoder& decoder_of(j_common_ptr jpeg) { return *static_cast<JpegDecoder*>(jpeg->client_data); }

  [[noreturn]] static void on_error(j_common_ptr jpeg) {
    JpegDecoder& decoder = decoder_of(jpeg);
    jpeg->err->format_message(jpeg, decoder.message_);
    std::longjmp(decoder.on_failure_, 1);
  }

  /// What libjpeg warns of and would fill with grey counts as an error.
  static void on_message(j_common_ptr jpeg, int level) {
    if (level >= 0) return;
    const int code = jpeg->err->msg_code;
    if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE) on_error(jpeg);
  }

  /// Every scan of a progressive file goes over all pixels, and takes few bytes.
  static void on_progress(j_common_ptr jpeg) {
    if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMostScans) return;
    std::snprintf(decoder_of(jpeg).message_, sizeof(message_), "more than %d scans", kMostScans);
    std::longjmp(decoder_of(jpeg).on_failure_, 1);
  }

  [[noreturn]] void fail() const {
    fail_at_image(where_, std::string("a JPEG file that cannot be read (") + message_ + ")",
                  "a whole JPEG file, RGB or grey");
  }

  void read_header() {
    if (setjmp(on_failure_) != 0) fail();
    jpeg_create_decompress(&jpeg_);
    jpeg_.client_data = this;
    jpeg_.progress = &progress_;
    jpeg_mem_src(&jpeg_, reinterpret_cast<const unsigned char*>(bytes_.data()),
                 static_cast<unsigned long>(bytes_.size()));
    jpeg_read_header(&jpeg_, TRUE);
  }

  void start() {
    if (setjmp(on_failure_) != 0) fail();
    jpeg_.out_color_space = jpeg_.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_.dct_method = JDCT_ISLOW;  // the one whose bits every processor agrees on
    jpeg_start_decompress(&jpeg_);
  }

  Image read_pixels() {
    Image image;
    image.width = static_cast<int>(jpeg_.output_width);
    image.height = static_cast<int>(jpeg_.output_height);
    image.channels = jpeg_.output_components;
    const std::size_t row_bytes = std::size_t(image.width) * std::size_t(image.channels);
    image.texels.resize(row_bytes * std::size_t(image.height));
    if (!read_rows(image.texels.data(), row_bytes)) fail();
    return image;
  }

  bool read_rows(JSAMPLE* texels, std::size_t row_bytes) {
    if (setjmp(on_failure_) != 0) return false;
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW row = texels + jpeg_.output_scanline * row_bytes;
      jpeg_read_scanlines(&jpeg_, &row, 1);
    }
    jpeg_finish_decompress(&jpeg_);
    return true;
  }

  std::string_view bytes_;
  const std::string& where_;
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf on_failure_{};
  char message_[JMSG_LENGTH_MAX] = {};
};

}  // namespace

Image decode_jpeg(std::string_view bytes, const std::string& where) {
  return JpegDecoder(bytes, where).decode();
}

}  // namespace testbench
