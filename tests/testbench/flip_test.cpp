// FLIP against values of its authors' program.

#include "testbench/film/flip.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace flip_test {

using testbench::DisplayImage;
using testbench::FilmSize;
using testbench::flip;

template <class Colour>
DisplayImage picture(FilmSize size, Colour&& colour) {
  DisplayImage image{size, {}};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) image.rgb.push_back(colour(x, y));
  return image;
}

DisplayImage plain(FilmSize size, const glm::dvec3& colour) {
  return picture(size, [&](int, int) { return colour; });
}

/// Ramps of red and green, and a blue that changes from pixel to pixel.
DisplayImage pattern() {
  return picture({24, 16},
                 [](int x, int y) { return glm::dvec3(x / 23.0, y / 15.0, (x * 7 + y * 5) % 11 / 10.0); });
}

/// The pattern, moved and darker.
DisplayImage changed_pattern() {
  return picture({24, 16}, [](int x, int y) {
    return glm::dvec3((x + 2) % 24 / 23.0, y / 15.0 * 0.8, (x * 7 + y * 5 + 3) % 11 / 10.0);
  });
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / double(values.size());
}

// The authors' program has the white and the inverse of the matrix in nine digits, which differences amplify.
constexpr double kNineDigits = 5e-8;

TEST(Flip, IsZeroOfEqualPictures) {
  for (const double value : flip(pattern(), pattern())) EXPECT_EQ(value, 0);
}

/// Values of FLIP.h 1.6 (github.com/NVlabs/flip, commit 1eb247c), which takes linear colours; its float
/// replaced by double, as rounding alone moves those of plain pictures by 5e-5.
TEST(Flip, PlainPicturesOfAnySizeHaveTheAuthorsValues) {
  const struct {
    glm::dvec3 a, b;
    double value;
  } pairs[] = {{{0, 0, 0}, {1, 1, 1}, 0.967379763337},
               {{0, 1, 0}, {0, 0, 1}, 1},
               {{0.5, 0.5, 0.5}, {0.6, 0.5, 0.4}, 0.280887531073}};
  for (const FilmSize size : {FilmSize{1, 1}, FilmSize{8, 8}, FilmSize{3, 50}})
    for (const auto& pair : pairs)
      for (const double value : flip(plain(size, pair.a), plain(size, pair.b)))
        EXPECT_NEAR(value, pair.value, kNineDigits);
}

/// The same program's mean and three pixels of the pattern, at the default distance and at half of it.
TEST(Flip, APatternHasTheAuthorsValues) {
  const std::vector<double> near = flip(changed_pattern(), pattern());
  EXPECT_NEAR(mean(near), 0.479973991969, kNineDigits);
  EXPECT_NEAR(near[0], 0.524432526991, kNineDigits);
  EXPECT_NEAR(near[7 * 24 + 11], 0.453552040213, kNineDigits);
  EXPECT_NEAR(near[15 * 24 + 23], 0.928007874527, kNineDigits);
  const std::vector<double> far = flip(changed_pattern(), pattern(), 30);
  EXPECT_NEAR(mean(far), 0.488962406257, kNineDigits);
  EXPECT_NEAR(far[15 * 24 + 23], 0.953737065037, kNineDigits);
}

TEST(Flip, DoesNotDependOnTheOrder) {
  EXPECT_EQ(flip(pattern(), changed_pattern()), flip(changed_pattern(), pattern()));
}

TEST(Flip, TheDefaultIsThatOfThePaper) {
  EXPECT_NEAR(testbench::kPixelsPerDegree, 67.02, 0.001);
}

TEST(Flip, PicturesOfDifferentSizesAreRefused) {
  EXPECT_THROW(flip(plain({2, 3}, {}), plain({3, 2}, {})), std::invalid_argument);
  EXPECT_THROW(flip(DisplayImage{}, DisplayImage{}), std::invalid_argument);
}

TEST(DisplayImage, IsWhatAPngShows) {
  const DisplayImage image = testbench::display_image({2, 1}, {-1, 0.25, 1, 2, 1e300, 0});
  EXPECT_EQ(image.rgb, (std::vector<glm::dvec3>{{0, 0.25, 1}, {1, 1, 0}}));
}

}  // namespace flip_test
