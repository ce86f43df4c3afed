#include "testbench/sampling/importance_map.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/input_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace importance_map_test {

using test_support::expect_input_error;
using testbench::FilmSize;
using testbench::read_importance;

constexpr FilmSize kFilm{3, 2};

using Channels = std::map<std::string, std::vector<float>>;

class ImportanceMap : public test_support::DirectoryFixture {
 protected:
  std::string write_map(Channels channels, FilmSize size = kFilm) const {
    const std::string path = (directory_ / "map.exr").string();
    Imf::Header header(size.width, size.height);
    Imf::FrameBuffer buffer;
    for (auto& [name, values] : channels) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                     sizeof(float) * std::size_t(size.width)));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(size.height);
    return path;
  }
};

TEST_F(ImportanceMap, IsTheOnlyChannelWhateverItsName) {
  const std::vector<float> values = {0, 0.5f, 1, 2, 0.25f, 3};
  const std::vector<double> expected(values.begin(), values.end());
  EXPECT_EQ(read_importance(write_map({{"gaze", values}}), kFilm), expected);
  EXPECT_EQ(read_importance(write_map({{"Y", values}, {"A", std::vector<float>(6, 9)}}), kFilm), expected);
}

TEST_F(ImportanceMap, IsTheLuminanceOfAColour) {
  const std::vector<float> zero(6, 0);
  std::vector<float> one = zero;
  one[4] = 1;
  const double expected[3] = {0.2126, 0.7152, 0.0722};
  const char* const names[3] = {"R", "G", "B"};
  for (int channel = 0; channel < 3; ++channel) {
    Channels channels = {{"R", zero}, {"G", zero}, {"B", zero}};
    channels[names[channel]] = one;
    const std::vector<double> importance = read_importance(write_map(channels), kFilm);
    EXPECT_EQ(importance[4], expected[channel]);
    EXPECT_EQ(importance[3], 0);
  }
}

TEST_F(ImportanceMap, SaysWhatIsWrong) {
  const auto refused = [&](const Channels& channels, const std::vector<std::string>& parts,
                           FilmSize size = kFilm) {
    const std::string path = write_map(channels, size);
    expect_input_error([&] { read_importance(path, kFilm); }, parts);
  };
  std::vector<float> values(6, 1);
  refused({{"Z", std::vector<float>(4, 1)}}, {"map.exr", "2x2", "allowed", "3x2"}, {2, 2});
  refused({{"Z", std::vector<float>(6, 0)}}, {"map.exr", "0 in every pixel", "allowed"});
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), -0.5f}) {
    values[5] = bad;
    refused({{"Z", values}}, {"map.exr", "pixel (2, 1)", "allowed: finite"});
    refused({{"R", values}, {"G", values}, {"B", values}}, {"map.exr", "pixel (2, 1)", "allowed: finite"});
  }
  // A negative part is refused even where the luminance is positive.
  values[5] = -0.5f;
  refused({{"R", std::vector<float>(6, 1)}, {"G", std::vector<float>(6, 1)}, {"B", values}},
          {"B: found -0.5", "pixel (2, 1)"});
  refused({{"A", std::vector<float>(6, 1)}, {"Z", std::vector<float>(6, 1)}}, {"no channel R", "allowed"});
  expect_input_error([&] { read_importance(write("map.exr", "P6 3 2 255"), kFilm); }, {"map.exr", "allowed"});
  expect_input_error([&] { read_importance(write("map.exr", ""), kFilm); }, {"map.exr", "allowed"});
  expect_input_error([&] { read_importance(directory_ / "none.exr", kFilm); }, {"none.exr", "allowed"});
}

TEST_F(ImportanceMap, RefusesMorePathsThanCanBeNumbered) {
  testbench::require_countable({1, 2}, 1 << 29, "map.exr", {2, 1});
  expect_input_error(
      [] {
        testbench::require_countable({1, 2.5}, 1 << 29, "map.exr", {2, 1});
      },
      {"map.exr", "2.5", "pixel (1, 0)", "allowed"});
}

}  // namespace importance_map_test
