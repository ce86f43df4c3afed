#include "testbench/texture/hdr_file.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "testbench/files/text_lines.hpp"
#include "testbench/texture/image_decoder.hpp"

namespace testbench {
namespace {

/// Red, green, blue, and the exponent that they share.
using Rgbe = std::array<std::uint8_t, 4>;

class HdrDecoder {
 public:
  HdrDecoder(std::string_view bytes, const std::string& where) : rest_(bytes), where_(where) {}

  RadianceImage decode() {
    read_header();
    read_resolution();
    // The widest row takes 12 bytes at least: a pixel, and two runs of four bytes.
    constexpr std::size_t kMostPixelsOfByte = kMostImageSide / 8;
    if (std::size_t(image_.width) * std::size_t(image_.height) / kMostPixelsOfByte > rest_.size())
      fail_cut_off();
    image_.rgb.resize(3 * std::size_t(image_.width) * std::size_t(image_.height));
    row_.resize(std::size_t(image_.width));
    for (int y = 0; y < image_.height; ++y) {
      read_row();
      store_row(is_bottom_first_ ? image_.height - 1 - y : y);
    }
    return std::move(image_);
  }

 private:
  [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
    fail_at_image(where_, found, allowed);
  }
  [[noreturn]] void fail_cut_off() const {
    fail("a Radiance HDR file that is cut off or damaged", "a whole one");
  }

  std::string_view take_line() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) fail_cut_off();
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return line;
  }

  void read_header() {
    for (std::string_view line = take_line(); !line.empty(); line = take_line()) {
      if (line.substr(0, 7) == "FORMAT=" && line != "FORMAT=32-bit_rle_rgbe")
        fail("a Radiance HDR file of " + in_quotes(line), "FORMAT=32-bit_rle_rgbe");
      if (line.substr(0, 9) == "EXPOSURE=") read_exposure(line.substr(9));
    }
  }

  void read_exposure(std::string_view text) {
    double factor = 0.0;
    if (!parse_number(trimmed(text), factor) || !(factor > 0.0))
      fail("EXPOSURE=" + in_quotes(text), "a number above 0");
    exposure_ *= factor;
  }

  /// "-Y 512 +X 1024": rows from the top, each from the left.
  void read_resolution() {
    const std::string_view whole = take_line();
    std::string_view line = whole;
    const std::string_view rows = take_word(line);
    const std::string_view height = take_word(line);
    const std::string_view columns = take_word(line);
    const std::string_view width = take_word(line);
    const auto is_axis = [](std::string_view word, char axis) {
      return word.size() == 2 && (word[0] == '-' || word[0] == '+') && word[1] == axis;
    };
    if (!is_axis(rows, 'Y') || !is_axis(columns, 'X') || !trimmed(line).empty())
      fail("a Radiance HDR file of resolution " + in_quotes(whole), "-Y HEIGHT +X WIDTH");
    const std::int64_t height_pixels = side_of(height);
    const std::int64_t width_pixels = side_of(width);
    require_image_size(width_pixels, height_pixels, where_);
    image_.height = static_cast<int>(height_pixels);
    image_.width = static_cast<int>(width_pixels);
    is_bottom_first_ = rows[0] == '+';
    is_right_first_ = columns[0] == '-';
  }

  static std::int64_t side_of(std::string_view text) {
    std::int64_t side = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
    return error == std::errc() && end == text.data() + text.size() ? side : 0;
  }

  std::uint8_t take_byte() {
    if (rest_.empty()) fail_cut_off();
    const auto byte = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return byte;
  }

  Rgbe take_pixel() {
    Rgbe pixel;
    for (std::uint8_t& byte : pixel) byte = take_byte();
    return pixel;
  }

  void read_row() {
    constexpr int kLeastNewWidth = 8;
    constexpr int kMostNewWidth = 0x7fff;
    const Rgbe first = take_pixel();
    const bool is_new = image_.width >= kLeastNewWidth && image_.width <= kMostNewWidth && first[0] == 2 &&
                        first[1] == 2 && first[2] < 128;
    if (!is_new) return read_pixels(first);
    if (first[2] * 256 + first[3] != image_.width) fail_cut_off();
    for (std::size_t channel = 0; channel < 4; ++channel) read_channel(channel);
  }

  /// A row of pixels, in which 1, 1, 1, n repeats the last one. @param pixel the first, read already
  void read_pixels(Rgbe pixel) {
    int shift = 0;
    for (std::size_t x = 0; x < row_.size();) {
      if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
        const std::size_t count = std::size_t(pixel[3]) << shift;
        if (x == 0 || count > row_.size() - x || shift > 24) fail_cut_off();
        for (std::size_t i = 0; i < count; ++i, ++x) row_[x] = row_[x - 1];
        shift += 8;
      } else {
        row_[x++] = pixel;
        shift = 0;
      }
      if (x < row_.size()) pixel = take_pixel();
    }
  }

  /// One channel of a row: n up to 128 bytes as they stand, or n - 128 times the same byte.
  void read_channel(std::size_t channel) {
    for (std::size_t x = 0; x < row_.size();) {
      const std::size_t code = take_byte();
      const bool is_run = code > 128;
      const std::size_t count = is_run ? code - 128 : code;
      if (count == 0 || count > row_.size() - x) fail_cut_off();
      std::uint8_t byte = is_run ? take_byte() : 0;
      for (std::size_t i = 0; i < count; ++i) {
        if (!is_run) byte = take_byte();
        row_[x++][channel] = byte;
      }
    }
  }

  void store_row(int y) {
    const auto width = row_.size();
    float* const to = &image_.rgb[3 * std::size_t(y) * width];
    for (std::size_t x = 0; x < width; ++x) {
      const Rgbe& pixel = row_[is_right_first_ ? width - 1 - x : x];
      if (pixel[3] == 0) continue;  // black
      constexpr int kExponentOfOne = 128 + 8;
      const double unit = std::ldexp(1.0, pixel[3] - kExponentOfOne) / exposure_;
      for (std::size_t channel = 0; channel < 3; ++channel)
        to[3 * x + channel] = static_cast<float>((pixel[channel] + 0.5) * unit);
    }
  }

  std::string_view rest_;
  const std::string& where_;
  RadianceImage image_;
  std::vector<Rgbe> row_;
  double exposure_ = 1.0;
  bool is_bottom_first_ = false;
  bool is_right_first_ = false;
};

}  // namespace

bool is_hdr(std::string_view bytes) {
  return bytes.substr(0, 10) == "#?RADIANCE" || bytes.substr(0, 6) == "#?RGBE";
}

RadianceImage decode_hdr(std::string_view bytes, const std::string& where) {
  return HdrDecoder(bytes, where).decode();
}

}  // namespace testbench
