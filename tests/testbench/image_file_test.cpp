#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "testbench/files/atomic_file.hpp"
#include "testbench/film/image_file.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace image_file_test {

namespace fs = std::filesystem;
using testbench::Film;
using testbench::InputError;
using testbench::RunError;

class ImageFileTest : public test_support::DirectoryFixture {
 protected:
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory_))
      names.push_back(entry.path().filename().string());
    return names;
  }
};

/// A film of 3 x 2 pixels. Each pixel has a different colour and two samples; the last has no sample.
Film small_film() {
  Film film({3, 2}, 1.0);
  for (int pixel = 0; pixel < 5; ++pixel) {
    film.add(pixel, {0.25 * pixel, 0.0, 1.0 - 0.25 * pixel});
    film.add(pixel, {0.25 * pixel, 0.5, 1.0 - 0.25 * pixel});
  }
  return film;
}

/// A file of R, G and B with this data window, of which the first `rows` are written with `value`.
fs::path rgb_file(const fs::path& path, const Imath::Box2i& window, int rows, float value) {
  Imf::Header header(window, window);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const char* const channel : {"R", "G", "B"})
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  Imf::OutputFile file(path.c_str(), header);
  // Every row lies at the same place, with R, G and B in it, too.
  std::vector<float> row(std::size_t(window.max.x - window.min.x + 1), value);
  Imf::FrameBuffer buffer;
  for (const char* const channel : {"R", "G", "B"})
    buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(row.data() - window.min.x),
                                      sizeof(float), 0));
  file.setFrameBuffer(buffer);
  if (rows > 0) file.writePixels(rows);
  return path;
}

/// A file of 5 x 3 pixels at (2, -1) with the values 0, 1, 2, ... as half floats, in lines or in tiles of 2
/// x 2.
fs::path tiled_or_not(const fs::path& path, Imf::Compression compression, bool has_tiles) {
  const Imath::Box2i window({2, -1}, {6, 1});
  Imf::Header header(window, window);
  header.compression() = compression;
  if (has_tiles) header.setTileDescription({2, 2, Imf::ONE_LEVEL});
  std::vector<half> values;
  for (int i = 0; i < 45; ++i) values.push_back(half(float(i)));
  Imf::FrameBuffer buffer;
  const char* const names[] = {"R", "G", "B"};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    header.channels().insert(names[channel], Imf::Channel(Imf::HALF));
    buffer.insert(names[channel],
                  Imf::Slice::Make(Imf::HALF, &values[channel], window, 3 * sizeof(half), 15 * sizeof(half)));
  }
  if (has_tiles) {
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(3);
  }
  return path;
}

TEST_F(ImageFileTest, exr_of_another_size_than_a_film_is_refused_before_memory_is_taken) {
  const std::string allowed = "allowed: WIDTHxHEIGHT, each 1 to 16384";
  const fs::path wide = rgb_file(directory_ / "wide.exr", {{0, 0}, {16384, 1}}, 2, 1);
  test_support::expect_input_error([&] { testbench::read_exr_rgb(wide); },
                                   {wide.string() + ": dataWindow: found 16385x2 pixels", allowed});
  const fs::path far = rgb_file(directory_ / "far.exr", {{-1000, -400000}, {1000, 400000}}, 0, 1);
  test_support::expect_input_error([&] { testbench::read_exr_film(far); },
                                   {"found 2001x800001 pixels", allowed});
  const fs::path hollow = rgb_file(directory_ / "hollow.exr", {{0, 0}, {16383, 16383}}, 0, 1);
  test_support::expect_input_error([&] { testbench::read_exr_rgb(hollow); },
                                   {hollow.string(), "for 268435456 pixels; allowed: a whole OpenEXR file"});
}

TEST_F(ImageFileTest, exr_attribute_that_claims_more_than_the_file_holds_is_refused_before_memory_is_taken) {
  const fs::path path = directory_ / "claim.exr";
  write_exr(path, small_film(), {{"note", "abc"}});
  std::string bytes = test_support::read_file(path);
  const std::string place("note\0string\0", 12);
  bytes[bytes.find(place) + place.size() + 3] = 0x7f;  // 3 bytes become 2 GB
  write("claim.exr", bytes);
  test_support::expect_input_error([&] { testbench::read_exr_film(path); },
                                   {path.string(), "note", "cannot be read"});
}

TEST_F(ImageFileTest, exr_of_every_lossless_compression_and_of_tiles_is_read) {
  for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                             Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION})
    for (const bool has_tiles : {false, true}) {
      const fs::path path = tiled_or_not(directory_ / "form.exr", compression, has_tiles);
      const testbench::RadianceImage image = testbench::read_exr_rgb(path);
      ASSERT_EQ(image.width, 5);
      ASSERT_EQ(image.height, 3);
      for (std::size_t i = 0; i < image.rgb.size(); ++i)
        EXPECT_EQ(image.rgb[i], float(i)) << compression << has_tiles;
    }
}

TEST_F(ImageFileTest, exr_with_missing_or_endless_pixels_is_refused) {
  const Imath::Box2i window({0, 0}, {3, 63});
  EXPECT_EQ(testbench::read_exr_rgb(rgb_file(directory_ / "whole.exr", window, 64, 2)).rgb[600], 2.0f);
  const fs::path part = rgb_file(directory_ / "part.exr", window, 20, 2);
  test_support::expect_input_error([&] { testbench::read_exr_rgb(part); }, {part.string()});
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const fs::path endless = rgb_file(directory_ / "endless.exr", window, 64, value);
    test_support::expect_input_error(
        [&] { testbench::read_exr_rgb(endless); },
        {endless.string() + ": R: found a value that is not finite in pixel (0, 0)"});
  }
}

TEST_F(ImageFileTest, exr_returns_the_means_row_by_row_from_the_top) {
  const fs::path path = directory_ / "a.exr";
  const Film film = small_film();
  write_exr(path, film, {});
  const testbench::RadianceImage image = testbench::read_exr_rgb(path);
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.height, 2);
  const std::vector<double> rgb = film.rgb();
  ASSERT_EQ(image.rgb.size(), rgb.size());
  for (std::size_t i = 0; i < rgb.size(); ++i) EXPECT_EQ(image.rgb[i], static_cast<float>(rgb[i]));
  EXPECT_EQ(files(), std::vector<std::string>{"a.exr"});
}

TEST_F(ImageFileTest, exr_holds_variance_samples_and_provenance) {
  const fs::path path = directory_ / "a.exr";
  const Film film = small_film();
  write_exr(path, film,
            {{"commandLine", "csx600 render"}, {"aLongAttributeNameOfMoreThan31Characters", "x"}});

  Imf::InputFile file(path.c_str());
  EXPECT_EQ(file.header().lineOrder(), Imf::INCREASING_Y);
  const auto* attribute = file.header().findTypedAttribute<Imf::StringAttribute>("commandLine");
  ASSERT_NE(attribute, nullptr);
  EXPECT_EQ(attribute->value(), "csx600 render");
  EXPECT_NE(
      file.header().findTypedAttribute<Imf::StringAttribute>("aLongAttributeNameOfMoreThan31Characters"),
      nullptr);

  std::vector<float> variance(6);
  std::vector<std::uint32_t> samples(6);
  const Imath::Box2i window = file.header().dataWindow();
  Imf::FrameBuffer buffer;
  buffer.insert("variance.G", Imf::Slice::Make(Imf::FLOAT, variance.data(), window));
  buffer.insert("samples", Imf::Slice::Make(Imf::UINT, samples.data(), window));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  for (int pixel = 0; pixel < 6; ++pixel) {
    const auto index = static_cast<std::size_t>(pixel);
    EXPECT_EQ(variance[index], static_cast<float>(film.variance_of_mean(pixel).y));
    EXPECT_EQ(samples[index], pixel < 5 ? 2U : 0U);
  }
  EXPECT_EQ(variance[0], 0.0625F);
  for (const char* name : {"R", "G", "B", "variance.R", "variance.G", "variance.B"}) {
    ASSERT_NE(file.header().channels().findChannel(name), nullptr) << name;
    EXPECT_EQ(file.header().channels().findChannel(name)->type, Imf::FLOAT);
  }
  EXPECT_EQ(file.header().channels().findChannel("samples")->type, Imf::UINT);
}

TEST_F(ImageFileTest, exr_bytes_are_the_same_every_time) {
  write_exr(directory_ / "a.exr", small_film(), {{"key", "value"}});
  write_exr(directory_ / "b.exr", small_film(), {{"key", "value"}});
  EXPECT_FALSE(read("a.exr").empty());
  EXPECT_EQ(read("a.exr"), read("b.exr"));
}

TEST_F(ImageFileTest, exr_refuses_reserved_attribute_names) {
  EXPECT_THROW(write_exr(directory_ / "a.exr", small_film(), {{"channels", "x"}}), std::invalid_argument);
  EXPECT_THROW(write_exr(directory_ / "a.exr", small_film(), {{"", "x"}}), std::invalid_argument);
  EXPECT_TRUE(files().empty());
}

std::vector<unsigned char> read_png(const fs::path& path, png_image& image) {
  image = {};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&image, path.c_str()), 0) << image.message;
  EXPECT_EQ(image.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
  std::vector<unsigned char> codes(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, codes.data(), 0, nullptr), 0) << image.message;
  return codes;
}

TEST_F(ImageFileTest, png_is_srgb_from_the_top_row_down) {
  Film film({2, 2}, 1.0);
  film.add(0, {1.0, 0.0, 0.0});
  film.add(1, {0.5, 7.0, 0.001});
  film.add(2, {0.0, 0.2158605, 0.0});
  write_png(directory_ / "a.png", film);
  png_image image;
  const std::vector<unsigned char> codes = read_png(directory_ / "a.png", image);
  EXPECT_EQ(image.width, 2U);
  EXPECT_EQ(image.height, 2U);
  EXPECT_EQ(codes, (std::vector<unsigned char>{255, 0, 0, 188, 255, 3, 0, 128, 0, 0, 0, 0}));
  EXPECT_EQ(files(), std::vector<std::string>{"a.png"});
}

TEST(SrgbCode, follows_the_curve_of_iec_61966_2_1) {
  EXPECT_EQ(testbench::srgb_code(-1.0), 0);
  EXPECT_EQ(testbench::srgb_code(0.0), 0);
  EXPECT_EQ(testbench::srgb_code(0.0031308), 10);  // 12.92 x 0.0031308 x 255 = 10.3
  EXPECT_EQ(testbench::srgb_code(0.18), 118);
  EXPECT_EQ(testbench::srgb_code(0.5), 188);
  EXPECT_EQ(testbench::srgb_code(1.0), 255);
  EXPECT_EQ(testbench::srgb_code(100.0), 255);
  for (int i = 0; i < 10000; ++i)
    EXPECT_LE(testbench::srgb_code(i / 1e4), testbench::srgb_code((i + 1) / 1e4));
}

TEST_F(ImageFileTest, exr_film_reads_back_mean_variance_and_attributes) {
  const fs::path path = directory_ / "a.exr";
  const Film film = small_film();
  write_exr(path, film, {{"csx600.seed", "7"}});
  const testbench::ExrFilm found = testbench::read_exr_film(path);
  EXPECT_EQ(found.width, 3);
  EXPECT_EQ(found.height, 2);
  EXPECT_EQ(found.attributes.at("csx600.seed"), "7");
  ASSERT_EQ(found.variance.size(), 18u);
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    for (int channel = 0; channel < 3; ++channel) {
      const std::size_t i = 3 * std::size_t(pixel) + std::size_t(channel);
      EXPECT_EQ(found.rgb[i], float(film.mean(pixel)[channel]));
      EXPECT_EQ(found.variance[i], float(film.variance_of_mean(pixel)[channel]));
    }
  }
  EXPECT_THROW(testbench::read_exr_film(directory_ / "none.exr"), InputError);
}

TEST_F(ImageFileTest, reading_refuses_what_is_no_rgb_exr) {
  EXPECT_THROW(testbench::read_exr_rgb(directory_ / "none.exr"), InputError);
  std::ofstream(directory_ / "text.exr") << "no image";
  EXPECT_THROW(testbench::read_exr_rgb(directory_ / "text.exr"), InputError);
  write_exr(directory_ / "cut.exr", small_film(), {});
  fs::resize_file(directory_ / "cut.exr", fs::file_size(directory_ / "cut.exr") - 20);
  EXPECT_THROW(testbench::read_exr_rgb(directory_ / "cut.exr"), InputError);

  Imf::Header header(1, 1);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  float grey = 0.5F;
  Imf::FrameBuffer buffer;
  buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&grey), sizeof grey, sizeof grey));
  {
    Imf::OutputFile file((directory_ / "grey.exr").c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(1);
  }
  test_support::expect_input_error([&] { testbench::read_exr_rgb(directory_ / "grey.exr"); },
                                   {"no channel R"});
}

TEST_F(ImageFileTest, atomic_write_replaces_the_old_content) {
  const fs::path path = directory_ / "a.txt";
  testbench::write_bytes_atomically(path, "old");
  testbench::write_bytes_atomically(path, std::string_view("new\0content", 11));
  EXPECT_EQ(test_support::read_file(path), std::string("new\0content", 11));
  EXPECT_EQ(files(), std::vector<std::string>{"a.txt"});
}

TEST_F(ImageFileTest, failing_writer_leaves_the_old_content_and_no_temporary_file) {
  const fs::path path = directory_ / "a.txt";
  testbench::write_bytes_atomically(path, "old");
  const auto failing = [](const fs::path& temporary) {
    std::ofstream(temporary) << "half";
    throw std::runtime_error("the writer broke");
  };
  try {
    testbench::write_atomically(path, failing);
    FAIL() << "no error";
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("the writer broke"), std::string::npos) << error.what();
  }
  EXPECT_EQ(test_support::read_file(path), "old");
  EXPECT_EQ(files(), std::vector<std::string>{"a.txt"});
}

/// Limits the size of files that this process may write, like a full disk. The destructor removes the limit.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_{};
  void (*old_handler_)(int);
};

TEST_F(ImageFileTest, short_write_is_a_run_error_and_leaves_nothing) {
  const FileSizeLimit limit(100);
  EXPECT_THROW(write_exr(directory_ / "a.exr", small_film(), {}), RunError);
  EXPECT_THROW(testbench::write_bytes_atomically(directory_ / "a.txt", std::string(1000, 'x')), RunError);
  EXPECT_TRUE(files().empty());
}

TEST_F(ImageFileTest, refuses_targets_that_cannot_be_written) {
  std::ofstream(directory_ / "file") << "x";
  fs::create_directory(directory_ / "folder");
  for (const fs::path& path :
       {directory_ / "none" / "a.exr", directory_ / "file" / "a.exr", directory_ / "folder",
        directory_ / "folder" / "", fs::path(""), fs::path("/dev/null"), fs::path("/proc/a.exr")}) {
    SCOPED_TRACE(path);
    EXPECT_THROW(testbench::require_writable(path), InputError);
    EXPECT_THROW(testbench::write_bytes_atomically(path, "x"), InputError);
    const auto write = [&] { write_exr(path, small_film(), {}); };
    test_support::expect_input_error(write, {"allowed: "});
    EXPECT_EQ(test_support::input_error_of(write).find(path.string()), 0u);
  }
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(ImageFileTest, require_writable_leaves_nothing_behind) {
  EXPECT_NO_THROW(testbench::require_writable(directory_ / "a.exr"));
  EXPECT_TRUE(files().empty());
  testbench::write_bytes_atomically(directory_ / "a.exr", "old");
  EXPECT_NO_THROW(testbench::require_writable(directory_ / "a.exr"));
  EXPECT_EQ(read("a.exr"), "old");
  const fs::path here = fs::current_path();
  fs::current_path(directory_);
  EXPECT_NO_THROW(testbench::require_writable("relative.exr"));
  fs::current_path(here);
}

}  // namespace image_file_test
