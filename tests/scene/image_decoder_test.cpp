#include "testbench/texture/image_decoder.hpp"

#include "tests/support/image_bytes.hpp"
#include "tests/support/input_error.hpp"

namespace image_decoder_test {

using test_support::PngContent;
using testbench::decode_image;
using testbench::Image;
using Texels = std::vector<std::uint8_t>;

void expect_refused(const std::string& bytes, const std::vector<std::string>& parts) {
  std::vector<std::string> all = parts;
  all.insert(all.end(), {"a.png: found ", "; allowed: "});
  test_support::expect_input_error([&] { decode_image(bytes, "a.png"); }, all);
}

Image decode_png_of(int colour_type, int bit_depth, int width, const Texels& bytes) {
  PngContent content;
  content.width = width;
  content.colour_type = colour_type;
  content.bit_depth = bit_depth;
  content.bytes = bytes;
  return decode_image(test_support::png_bytes(content), "a.png");
}

void expect_texels(const Image& image, int channels, const Texels& texels) {
  EXPECT_EQ(image.channels, channels);
  EXPECT_EQ(image.texels, texels);
  EXPECT_EQ(image.texels.size(), std::size_t(image.width * image.height * image.channels));
}

TEST(ImageDecoder, ReadsEveryKindOfPngOfEightBitsAndFewer) {
  expect_texels(decode_png_of(PNG_COLOR_TYPE_RGB, 8, 2, {1, 2, 3, 4, 5, 6}), 3, {1, 2, 3, 4, 5, 6});
  expect_texels(decode_png_of(PNG_COLOR_TYPE_RGB_ALPHA, 8, 1, {1, 2, 3, 4}), 4, {1, 2, 3, 4});
  expect_texels(decode_png_of(PNG_COLOR_TYPE_GRAY, 8, 2, {7, 9}), 1, {7, 9});
  expect_texels(decode_png_of(PNG_COLOR_TYPE_GRAY_ALPHA, 8, 1, {7, 9}), 2, {7, 9});
  expect_texels(decode_png_of(PNG_COLOR_TYPE_GRAY, 1, 3, {0b10100000}), 1, {255, 0, 255});
  expect_texels(decode_png_of(PNG_COLOR_TYPE_GRAY, 4, 2, {0x1f}), 1, {17, 255});
}

TEST(ImageDecoder, ReadsPalettesWithAndWithoutAlpha) {
  PngContent content;
  content.width = 2;
  content.colour_type = PNG_COLOR_TYPE_PALETTE;
  content.bytes = {1, 0};
  content.palette = {{10, 20, 30}, {40, 50, 60}};
  expect_texels(decode_image(test_support::png_bytes(content), "a.png"), 3, {40, 50, 60, 10, 20, 30});
  content.palette_alpha = {128};
  expect_texels(decode_image(test_support::png_bytes(content), "a.png"), 4,
                {40, 50, 60, 255, 10, 20, 30, 128});
}

TEST(ImageDecoder, IgnoresGamma) {
  PngContent content;
  content.bytes = {10, 100, 200};
  content.gamma = 1.0;
  expect_texels(decode_image(test_support::png_bytes(content), "a.png"), 3, {10, 100, 200});
}

TEST(ImageDecoder, ReadsJpegOfEveryKindButCmyk) {
  for (const bool is_progressive : {false, true}) {
    const Image image =
        decode_image(test_support::jpeg_bytes(17, 9, {200, 100, 50}, JCS_RGB, is_progressive), "a.jpg");
    EXPECT_EQ(image.width, 17);
    EXPECT_EQ(image.height, 9);
    ASSERT_EQ(image.texels.size(), 17u * 9 * 3);
    for (std::size_t i = 0; i < image.texels.size(); ++i)
      EXPECT_NEAR(image.texels[i], (Texels{200, 100, 50})[i % 3], 2);
  }
  const Image grey = decode_image(test_support::jpeg_bytes(8, 8, {77}, JCS_GRAYSCALE), "a.jpg");
  expect_texels(grey, 1, Texels(64, 77));
  expect_refused(test_support::jpeg_bytes(8, 8, {1, 2, 3, 4}, JCS_CMYK), {"CMYK"});
}

TEST(ImageDecoder, RefusesWhatIsNeitherPngNorJpeg) {
  expect_refused("", {"an empty image", "a PNG or JPEG file"});
  expect_refused("GIF89a and more", {"another format", "a PNG or JPEG file"});
  expect_refused("\x89PNG\r\n\x1a\n", {"cannot be read"});
  expect_refused(std::string("\xff\xd8\xff\xe0\x00", 5), {"a JPEG file that cannot be read"});
}

TEST(ImageDecoder, RefusesSixteenBits) {
  PngContent content;
  content.bit_depth = 16;
  content.bytes = Texels(6, 1);
  expect_refused(test_support::png_bytes(content), {"16 bits", "8 bits"});
}

TEST(ImageDecoder, RefusesEveryFileThatIsCutOff) {
  const std::string png = test_support::png_bytes(4, 4, Texels(48, 200));
  for (std::size_t size = 0; size < png.size(); ++size) expect_refused(png.substr(0, size), {});
  const std::string jpeg = test_support::jpeg_bytes(40, 40, {9, 99, 199}, JCS_RGB);
  for (std::size_t size = 0; size + 2 < jpeg.size(); size += 7) expect_refused(jpeg.substr(0, size), {});
}

TEST(ImageDecoder, RefusesDamagedPixels) {
  std::string png = test_support::png_bytes(4, 4, Texels(48, 200));
  png[png.size() - 20] ^= 1;  // in the checksum or the data of IDAT
  expect_refused(png, {});
}

TEST(ImageDecoder, RefusesSizesBeforeMemoryIsTaken) {
  PngContent content;
  content.rows = 0;
  content.bytes = {0};
  content.width = 16385;
  expect_refused(test_support::png_bytes(content), {"16385 x 1", "16384"});
  content.width = content.height = 16384;
  expect_refused(test_support::png_bytes(content), {"16384 x 16384", "67108864"});
  content.width = content.height = 8192;
  expect_refused(test_support::png_bytes(content), {"fewer bytes than its pixels need"});
}

}  // namespace image_decoder_test
