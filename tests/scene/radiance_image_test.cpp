#include "testbench/texture/radiance_image.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include <cmath>
#include <limits>

#include "testbench/texture/hdr_file.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace radiance_image_test {

using testbench::decode_hdr;
using testbench::RadianceImage;
using testbench::read_radiance_image;

std::string header_of(const std::string& resolution, const std::string& lines = "") {
  return "#?RADIANCE\n# made by a test\nFORMAT=32-bit_rle_rgbe\n" + lines + "\n" + resolution + "\n";
}

std::string bytes_of(std::initializer_list<int> bytes) {
  std::string text;
  for (const int byte : bytes) text += static_cast<char>(byte);
  return text;
}

/// The value of a channel's byte (Ward 1991): its middle, by the exponent.
float value_of(int mantissa, int exponent) {
  return static_cast<float>((mantissa + 0.5) / 256.0 * std::ldexp(1.0, exponent - 128));
}

void expect_refused(const std::string& bytes, const std::vector<std::string>& parts) {
  std::vector<std::string> all = parts;
  all.insert(all.end(), {"a.hdr: found ", "; allowed: "});
  test_support::expect_input_error([&] { decode_hdr(bytes, "a.hdr"); }, all);
}

TEST(HdrFile, ReadsFlatRows) {
  const RadianceImage image =
      decode_hdr(header_of("-Y 1 +X 2") + bytes_of({128, 64, 32, 129, 9, 9, 9, 0}), "a.hdr");
  EXPECT_EQ(image.width, 2);
  EXPECT_EQ(image.height, 1);
  EXPECT_EQ(image.rgb,
            (std::vector<float>{value_of(128, 129), value_of(64, 129), value_of(32, 129), 0, 0, 0}));
}

/// The same row of ten pixels, flat, in runs of channels and in runs of pixels.
TEST(HdrFile, ReadsBothKindsOfRuns) {
  std::string flat;
  for (int i = 0; i < 10; ++i) flat += bytes_of({7, i < 6 ? 5 : 3, 200, 130});
  const std::string runs = bytes_of({2, 2, 0, 10, 138, 7, 134, 5, 4, 3, 3, 3, 3, 138, 200, 138, 130});
  const std::string old_runs = bytes_of({7, 5, 200, 130, 1, 1, 1, 5, 7, 3, 200, 130, 1, 1, 1, 3});
  const std::string start = header_of("-Y 1 +X 10");
  const RadianceImage image = decode_hdr(start + flat, "a.hdr");
  EXPECT_EQ(image.rgb[1], value_of(5, 130));
  EXPECT_EQ(image.rgb[3 * 9 + 1], value_of(3, 130));
  EXPECT_EQ(decode_hdr(start + runs, "a.hdr").rgb, image.rgb);
  EXPECT_EQ(decode_hdr(start + old_runs, "a.hdr").rgb, image.rgb);
}

TEST(HdrFile, PutsRowsWhereTheResolutionSays) {
  const std::string pixels = bytes_of({10, 0, 0, 128, 20, 0, 0, 128, 30, 0, 0, 128, 40, 0, 0, 128});
  const auto reds = [&](const char* resolution) {
    const RadianceImage image = decode_hdr(header_of(resolution) + pixels, "a.hdr");
    std::vector<int> mantissas;
    for (std::size_t i = 0; i < 4; ++i) mantissas.push_back(static_cast<int>(image.rgb[3 * i] * 256.0f));
    return mantissas;
  };
  EXPECT_EQ(reds("-Y 2 +X 2"), (std::vector<int>{10, 20, 30, 40}));
  EXPECT_EQ(reds("+Y 2 +X 2"), (std::vector<int>{30, 40, 10, 20}));
  EXPECT_EQ(reds("-Y 2 -X 2"), (std::vector<int>{20, 10, 40, 30}));
}

TEST(HdrFile, DividesByExposure) {
  const std::string pixel = bytes_of({128, 128, 128, 128});
  const float plain = decode_hdr(header_of("-Y 1 +X 1") + pixel, "a.hdr").rgb[0];
  const float exposed =
      decode_hdr(header_of("-Y 1 +X 1", "EXPOSURE=4\nEXPOSURE= 2.0\n") + pixel, "a.hdr").rgb[0];
  EXPECT_EQ(exposed, plain / 8.0f);
}

TEST(HdrFile, RefusesWhatIsDamaged) {
  const std::string whole =
      header_of("-Y 1 +X 10") + bytes_of({2, 2, 0, 10, 138, 7, 138, 5, 138, 200, 138, 130});
  for (std::size_t size = 0; size < whole.size(); ++size) expect_refused(whole.substr(0, size), {});
  expect_refused(header_of("-Y 1 +X 10") + bytes_of({2, 2, 0, 11}), {"damaged"});          // another width
  expect_refused(header_of("-Y 1 +X 10") + bytes_of({2, 2, 0, 10, 139, 7}), {"damaged"});  // beyond the row
  expect_refused(header_of("-Y 1 +X 10") + bytes_of({2, 2, 0, 10, 0, 7}), {"damaged"});
  expect_refused(header_of("-Y 1 +X 2") + bytes_of({1, 1, 1, 1}), {"damaged"});  // nothing to repeat
  expect_refused("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234", {"xyze", "32-bit_rle_rgbe"});
  for (const char* resolution : {"+X 1 -Y 1", "-Y 1", "-Y 1 +X 1 3", "1 1"})
    expect_refused(header_of(resolution) + "1234", {"resolution", "-Y HEIGHT +X WIDTH"});
  for (const char* resolution : {"-Y 0 +X 1", "-Y 1 +X 16385", "-Y 1x +X 1", "-Y 16384 +X 16384"})
    expect_refused(header_of(resolution) + "1234", {"pixels", "16384"});
  expect_refused(header_of("-Y 8192 +X 8192") + "1234", {"cut off"});
  expect_refused(header_of("-Y 1 +X 1", "EXPOSURE=0\n") + "1234", {"EXPOSURE"});
}

class RadianceImageTest : public test_support::DirectoryFixture {
 protected:
  /// Writes a grey EXR file of two pixels.
  std::filesystem::path exr(float first, float second) const {
    const std::filesystem::path path = directory_ / "a.exr";
    Imf::Header header(2, 1);
    for (const char* const channel : {"R", "G", "B"})
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    Imf::OutputFile file(path.c_str(), header);
    float row[2] = {first, second};
    Imf::FrameBuffer buffer;
    for (const char* const channel : {"R", "G", "B"})
      buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(row), sizeof(float), 0));
    file.setFrameBuffer(buffer);
    file.writePixels(1);
    return path;
  }
  static void expect_no_environment(const std::filesystem::path& path,
                                    const std::vector<std::string>& parts) {
    test_support::expect_input_error([&] { read_radiance_image(path); }, parts);
  }
};

TEST_F(RadianceImageTest, ReadsExrAndHdrByTheirContent) {
  EXPECT_EQ(read_radiance_image(exr(0.0f, 3.5f)).rgb, (std::vector<float>{0, 0, 0, 3.5f, 3.5f, 3.5f}));
  const auto hdr = write("sky.picture", header_of("-Y 1 +X 1") + bytes_of({128, 64, 32, 129}));
  EXPECT_EQ(read_radiance_image(hdr).rgb[2], value_of(32, 129));
}

TEST_F(RadianceImageTest, RefusesWhatIsNoLight) {
  expect_no_environment(exr(0.0f, -1.0f), {"a.exr", "-1.0", "(1, 0)", "from 0"});
  expect_no_environment(exr(0.0f, std::numeric_limits<float>::quiet_NaN()), {"a.exr", "not finite"});
  expect_no_environment(exr(0.0f, std::numeric_limits<float>::infinity()), {"a.exr", "not finite"});
  expect_no_environment(exr(0.0f, 0.0f), {"a.exr", "0 in every pixel", "not black"});
  expect_no_environment(write("b.hdr", header_of("-Y 1 +X 1") + bytes_of({9, 9, 9, 0})), {"b.hdr", "black"});
  expect_no_environment(write("c.hdr", ""), {"c.hdr", "an empty file", "OpenEXR or Radiance HDR"});
  expect_no_environment(write("d.hdr", "P6 1 1 255 abc"), {"d.hdr", "another format"});
  expect_no_environment(directory_ / "none.exr", {"none.exr", "cannot be read"});
}

}  // namespace radiance_image_test
