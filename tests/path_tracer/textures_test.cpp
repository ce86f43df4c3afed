// Textures as kernels look them up and filter them, against testbench/texture/sample.hpp.

#include "firmware/path_tracer/kernels/textures.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "testbench/mono_image/mono_image.hpp"
#include "testbench/texture/sample.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/strip_fixture.hpp"

namespace textures_test {

using cn::MonoAddress;
using cn::PolyPointer;
using path_tracer::HitRecord;
using path_tracer::RecordSizes;
using path_tracer::SurfaceRecord;
using path_tracer::TextureLookUp;
using path_tracer::TextureRecord;
using path_tracer::TextureSlot;
using test_support::load;
using test_support::PerPe;
using test_support::random_texture;
using testbench::Scene;
using testbench::TexelEncoding;
using testbench::TextureFilter;
using testbench::TextureReference;
using testbench::TextureWrap;

constexpr TextureWrap kWraps[] = {TextureWrap::repeat, TextureWrap::mirrored_repeat,
                                  TextureWrap::clamp_to_edge};
constexpr TextureFilter kFilters[] = {TextureFilter::nearest, TextureFilter::linear};

/// One triangle whose texture coordinates run from -3 to 4, with the same reference for colour and roughness.
Scene textured_triangle(const TextureReference& reference, int width, int height) {
  Scene scene;
  scene.film = {1, 1};
  scene.textures.push_back(random_texture(width, height, 3, TexelEncoding::srgb));
  scene.textures.push_back(random_texture(width, height, 3, TexelEncoding::linear));
  testbench::Material material{"textured", glm::dvec3(1.0)};
  material.specular = 1.0;
  material.textures.reflectance = material.textures.roughness = reference;
  material.textures.reflectance.texture = 0;
  material.textures.roughness.texture = 1;
  scene.materials.push_back(material);
  scene.triangles.push_back({{{0.3, -0.2, 0.9}, {1.5, 0.1, 0.4}, {-0.1, 0.8, -0.7}}, 0});
  scene.corners.coordinates[0].push_back({glm::dvec2{-3, -2.5}, {4, -1}, {0.5, 4}});
  scene.environment.constant = glm::dvec3(1.0);
  return scene;
}

/// Looks textures up at one point of the only triangle for each PE.
class Textures : public test_support::StripFixture {
 protected:
  struct Shown {
    glm::dvec3 reflectance;
    double roughness;
  };

  void look_at(const Scene& scene) {
    path_tracer::ProgramConfig config;
    config.folds_constant_textures = false;
    image_ = testbench::make_mono_image(scene, num_pes(), config);
    sizes_ = image_.layout.sizes;
    ASSERT_LE(kHit + int{sizeof(HitRecord)} + sizes_.surface + sizes_.look_ups, 1024);
  }

  /// @param place of the hits, one for each PE
  std::vector<Shown> shown_at(const std::vector<glm::dvec3>& place) {
    const PolyPointer<SurfaceRecord> surface(kSurface);
    const PolyPointer<TextureLookUp> look_ups(kSurface + sizes_.surface);
    copy_to_all(image_.layout.surfaces.address, kSurface, sizes_.surface);
    const PolyPointer<HitRecord> hit(kHit);
    for (int axis = 0; axis < 3; ++axis)
      for (int pe = 0; pe < num_pes(); ++pe)
        std::memcpy(&memory.word(pe, kHit + 8 * axis), &place[std::size_t(pe)][axis], 8);
    for (const TextureSlot slot : {TextureSlot::reflectance, TextureSlot::roughness}) {
      cn::LaneMask needs;
      const path_tracer::LookUpArguments arguments{
          hit, PolyPointer<TextureRecord>(kSurface + sizes_.texture[int(slot)]),
          path_tracer::footprint_bytes(slot),
          PolyPointer<TextureLookUp>(look_ups.span().offset_bytes + sizes_.look_up[int(slot)]), &needs};
      run([&] { path_tracer::look_up(arguments); });
      EXPECT_EQ(needs, cn::LaneMask::first(num_pes()));
      const int at = arguments.look_up.span().offset_bytes;
      for (int pe = 0; pe < num_pes(); ++pe)
        copy(memory.word(pe, at), pe, at + int{sizeof(TextureLookUp)}, path_tracer::footprint_bytes(slot));
    }
    PerPe<double> red = per_pe<double>(), green = red, blue = red, roughness = red;
    run([&] {
      const path_tracer::TexturesAtHit textures(surface, sizes_, look_ups);
      const path_tracer::Rgb colour = textures.colour(TextureSlot::reflectance);
      test_support::store(red, colour.x);
      test_support::store(green, colour.y);
      test_support::store(blue, colour.z);
      test_support::store(roughness, textures.channel(TextureSlot::roughness));
    });
    std::vector<Shown> shown;
    for (std::size_t pe = 0; pe < place.size(); ++pe)
      shown.push_back({{red[pe], green[pe], blue[pe]}, roughness[pe]});
    return shown;
  }

 private:
  static constexpr int kHit = 0;
  static constexpr int kSurface = 64;

  void copy(MonoAddress from, int pe, int to, int bytes) {
    ASSERT_LE(from + MonoAddress(bytes), image_.bytes.size());
    for (int word = 0; word < bytes; word += 8)
      std::memcpy(&memory.word(pe, to + word), &image_.bytes[from + std::size_t(word)], 8);
  }
  void copy_to_all(MonoAddress from, int to, int bytes) {
    for (int pe = 0; pe < num_pes(); ++pe) copy(from, pe, to, bytes);
  }

  testbench::MonoImage image_;
  RecordSizes sizes_{path_tracer::Features{}};
};

/// sRGB is a polynomial of relative error 2.2e-7 (kernels/textures.hpp); all else is rounding.
constexpr double kSrgbError = 2.3e-7;
constexpr double kRounding = 1e-11;

TEST_F(Textures, ShowWhatTheReferenceShowsForEveryWrapFilterAndTransform) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  const testbench::TextureTransform transforms[] = {{},
                                                    {{0.25, -0.4}, 0.7, {1.5, -2.0}},
                                                    {{100.5, -2000.75}, 0.0, {0.1, 0.1}},
                                                    {{0.5, 0.5}, 0.0, {0.0, 0.0}}};
  for (const auto& [width, height] : {std::pair{5, 3}, std::pair{1, 1}, std::pair{8, 2}, std::pair{1, 6}}) {
    for (const TextureFilter filter : kFilters) {
      for (const TextureWrap wrap_u : kWraps) {
        for (const TextureWrap wrap_v : kWraps) {
          for (const testbench::TextureTransform& transform : transforms) {
            TextureReference reference;
            reference.filter = filter;
            reference.wrap_u = wrap_u;
            reference.wrap_v = wrap_v;
            reference.transform = transform;
            reference.channel = 1;
            // Constant coordinates of nearest texels must not lie on a border, which rounding decides.
            if (transform.scale == glm::dvec2(0.0)) reference.transform.offset = {0.43, 0.61};
            const Scene scene = textured_triangle(reference, width, height);
            look_at(scene);
            std::vector<glm::dvec3> places;
            std::vector<glm::dvec2> coordinates;
            for (int pe = 0; pe < num_pes(); ++pe) {
              const double u = uniform(random);
              const double v = uniform(random) * (1.0 - u);
              const auto& vertex = scene.triangles[0].vertex;
              const auto& corner = scene.corners.coordinates[0][0];
              places.push_back(vertex[0] + u * (vertex[1] - vertex[0]) + v * (vertex[2] - vertex[0]));
              coordinates.push_back(corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]));
            }
            const std::vector<Shown> shown = shown_at(places);
            for (std::size_t i = 0; i < shown.size(); ++i) {
              const glm::dvec4 colour = sample_texture(scene.textures[0], reference, coordinates[i]);
              const double roughness = sample_texture(scene.textures[1], reference, coordinates[i])[1];
              for (int channel = 0; channel < 3; ++channel)
                ASSERT_NEAR(shown[i].reflectance[channel], colour[channel],
                            kSrgbError * colour[channel] + kRounding)
                    << width << " x " << height << ", filter " << int(filter) << ", wraps " << int(wrap_u)
                    << int(wrap_v) << " at " << coordinates[i].x << ", " << coordinates[i].y;
              ASSERT_NEAR(shown[i].roughness, roughness, kRounding);
            }
          }
        }
      }
    }
  }
}

/// Each texel, on its centre, where both filters show it alone, and on its upper left corner, which belongs
/// to it.
TEST_F(Textures, NearestTexelsBeginAtTheirUpperLeftCorner) {
  for (const TextureWrap wrap : kWraps) {
    TextureReference reference;
    reference.filter = TextureFilter::nearest;
    reference.wrap_u = reference.wrap_v = wrap;
    Scene scene = textured_triangle(reference, 4, 2);
    scene.triangles[0] = {{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, 0};
    scene.corners.coordinates[0][0] = {glm::dvec2{-4, -4}, {4, -4}, {-4, 4}};  // place - 4
    look_at(scene);
    std::vector<glm::dvec3> places;
    for (int pe = 0; pe < num_pes(); ++pe) places.push_back({2.0 + pe / 4.0, 3.0 + pe % 5 / 2.0, 0});
    const std::vector<Shown> shown = shown_at(places);
    for (std::size_t i = 0; i < shown.size(); ++i)
      EXPECT_NEAR(shown[i].roughness,
                  sample_texture(scene.textures[1], reference, {places[i].x - 4.0, places[i].y - 4.0}).x,
                  1e-15)
          << int(wrap) << " at " << places[i].x << ", " << places[i].y;
  }
}

TEST_F(Textures, DecodeEveryCodeOfSrgbAndAddNoLight) {
  for (int first = 0; first < 256; first += num_pes()) {
    PerPe<double> codes = per_pe<double>();
    for (int pe = 0; pe < num_pes(); ++pe) codes[std::size_t(pe)] = std::min(first + pe, 255);
    PerPe<double> linear = per_pe<double>();
    run([&] { test_support::store(linear, path_tracer::linear_of_srgb(load(codes))); });
    for (std::size_t pe = 0; pe < codes.size(); ++pe) {
      const double expected = testbench::linear_of_srgb(std::uint8_t(codes[pe]));
      EXPECT_NEAR(linear[pe], expected, 2.2e-7 * expected) << codes[pe];
      EXPECT_LE(linear[pe], expected * (1.0 + 1e-15)) << codes[pe];
      EXPECT_EQ(linear[pe], path_tracer::linear_of_srgb(codes[pe])) << codes[pe];  // on the host
    }
  }
}

/// Whatever a hit's place is, the texel that is asked for lies in the image; copy() checks that.
TEST_F(Textures, StayInTheImageAtPlacesThatAreNone) {
  for (const TextureFilter filter : kFilters) {
    for (const TextureWrap wrap : kWraps) {
      TextureReference reference;
      reference.filter = filter;
      reference.wrap_u = reference.wrap_v = wrap;
      look_at(textured_triangle(reference, 5, 3));
      std::vector<glm::dvec3> places(std::size_t(num_pes()), glm::dvec3(0.0));
      const double numbers[] = {1e300,
                                -1e300,
                                1e17,
                                -1e17,
                                1e15,
                                std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::quiet_NaN(),
                                0x1p-1074};
      for (std::size_t i = 0; i < std::size(numbers); ++i) {
        places[2 * i][0] = numbers[i];
        places[2 * i + 1] = glm::dvec3(numbers[i], -numbers[i], numbers[i]);
      }
      for (const Shown& shown : shown_at(places)) {
        EXPECT_GE(shown.roughness, 0.0);
        EXPECT_LE(shown.roughness, 1.0);
      }
    }
  }
}

/// All corners at one place, so that the image's period decides which texel it is.
TEST_F(Textures, FarCoordinatesLoseNoDigitOfTheirPlaceInTheImage) {
  for (const TextureWrap wrap : kWraps) {
    for (const double far : {1e9 + 0.3, -1e9 - 0.3, 0x1p30}) {
      TextureReference reference;
      reference.wrap_u = reference.wrap_v = wrap;
      Scene scene = textured_triangle(reference, 5, 3);
      scene.corners.coordinates[0][0] = {glm::dvec2{far, far}, {far, far}, {far, far}};
      look_at(scene);
      const std::vector<glm::dvec3> places(std::size_t(num_pes()), scene.triangles[0].vertex[0]);
      EXPECT_NEAR(shown_at(places)[0].roughness, sample_texture(scene.textures[1], reference, {far, far}).x,
                  1e-6)
          << far;
    }
  }
}

TEST_F(Textures, TrianglesWithoutCoordinatesShowTheUpperLeftCorner) {
  const TextureReference reference;
  Scene scene = textured_triangle(reference, 5, 3);
  scene.corners.coordinates[0].clear();
  look_at(scene);
  const std::vector<glm::dvec3> places(std::size_t(num_pes()), scene.triangles[0].vertex[1]);
  EXPECT_NEAR(shown_at(places)[0].roughness, sample_texture(scene.textures[1], reference, {0, 0}).x,
              kRounding);
}

}  // namespace textures_test
