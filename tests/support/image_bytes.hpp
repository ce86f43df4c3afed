#pragma once

#include <cstdio>  // jpeglib.h needs it

#include <jpeglib.h>
#include <png.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace test_support {

/// A PNG file to make. Rows are packed as the file holds them.
struct PngContent {
  int width = 1;
  int height = 1;
  int colour_type = PNG_COLOR_TYPE_RGB;
  int bit_depth = 8;
  std::vector<std::uint8_t> bytes;
  std::vector<png_color> palette;
  std::vector<png_byte> palette_alpha;
  double gamma = 0.0;  ///< of a gAMA chunk; 0 for none
  int rows = -1;       ///< -1 for all, 0 for pixels that are none
};

/// The bytes of the file.
inline std::string png_bytes(const PngContent& content) {
  std::string file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  const auto append = [](png_structp writer, png_bytep from, std::size_t count) {
    static_cast<std::string*>(png_get_io_ptr(writer))->append(reinterpret_cast<char*>(from), count);
  };
  png_set_write_fn(png, &file, append, [](png_structp) {});
  png_set_IHDR(png, info, png_uint_32(content.width), png_uint_32(content.height), content.bit_depth,
               content.colour_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (!content.palette.empty())
    png_set_PLTE(png, info, content.palette.data(), static_cast<int>(content.palette.size()));
  if (!content.palette_alpha.empty())
    png_set_tRNS(png, info, content.palette_alpha.data(), static_cast<int>(content.palette_alpha.size()),
                 nullptr);
  if (content.gamma > 0.0) png_set_gAMA(png, info, content.gamma);
  png_write_info(png, info);
  const std::size_t row_bytes = content.bytes.size() / std::size_t(content.height);
  for (int row = 0; content.rows < 0 && row < content.height; ++row)
    png_write_row(png, content.bytes.data() + std::size_t(row) * row_bytes);
  if (content.rows < 0) png_write_end(png, info);
  const png_byte nothing[4] = {};
  if (content.rows == 0) png_write_chunk(png, reinterpret_cast<png_const_bytep>("IDAT"), nothing, 4);
  png_destroy_write_struct(&png, &info);
  return file;
}

/// An RGB PNG file of the given texels.
inline std::string png_bytes(int width, int height, const std::vector<std::uint8_t>& rgb) {
  PngContent content;
  content.width = width;
  content.height = height;
  content.bytes = rgb;
  return png_bytes(content);
}

/// A JPEG file of one colour. @param colour of each channel @param space of `colour` and of the file
inline std::string jpeg_bytes(int width, int height, const std::vector<std::uint8_t>& colour,
                              J_COLOR_SPACE space, bool is_progressive = false) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = JDIMENSION(width);
  jpeg.image_height = JDIMENSION(height);
  jpeg.input_components = static_cast<int>(colour.size());
  jpeg.in_color_space = space;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  if (is_progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<std::uint8_t> row;
  for (int x = 0; x < width; ++x) row.insert(row.end(), colour.begin(), colour.end());
  while (jpeg.next_scanline < jpeg.image_height) {
    JSAMPROW rows = row.data();
    jpeg_write_scanlines(&jpeg, &rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string file(reinterpret_cast<char*>(memory), size);
  std::free(memory);
  return file;
}

}  // namespace test_support
