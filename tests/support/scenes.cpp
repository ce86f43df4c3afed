#include "tests/support/scenes.hpp"

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "testbench/scene_file/scene_file.hpp"

namespace test_support {
namespace {

using testbench::Camera;
using testbench::Material;
using testbench::Triangle;

constexpr double kPi = 3.14159265358979323846;

Camera looking(const glm::dvec3& from, const glm::dvec3& towards, const glm::dvec3& up_hint,
               double field_of_view_degrees) {
  Camera camera;
  camera.position = from;
  camera.direction = glm::normalize(towards - from);
  camera.up = glm::normalize(up_hint - glm::dot(up_hint, camera.direction) * camera.direction);
  camera.vertical_field_of_view_radians = field_of_view_degrees * kPi / 180.0;
  return camera;
}

std::int32_t add_material(Scene& scene, const std::string& name, const glm::dvec3& reflectance,
                          const glm::dvec3& emission) {
  scene.materials.push_back({name, reflectance, emission});
  return static_cast<std::int32_t>(scene.materials.size()) - 1;
}

void add_triangle(Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                  std::int32_t material) {
  scene.triangles.push_back({{a, b, c}, material});
}

/// Adds two triangles, counter-clockwise as seen from the front.
void add_square(Scene& scene, const std::array<glm::dvec3, 4>& corners, std::int32_t material) {
  add_triangle(scene, corners[0], corners[1], corners[2], material);
  add_triangle(scene, corners[0], corners[2], corners[3], material);
}

Scene named(const char* name, FilmSize film) {
  Scene scene;
  scene.name = name;
  scene.film = film;
  return scene;
}

void add_plane_and_light(Scene& scene, const PlaneAndLight& values) {
  constexpr double kFar = 50.0;
  const std::int32_t plane = add_material(scene, "plane", values.reflectance, glm::dvec3(0.0));
  const std::int32_t light = add_material(scene, "light", glm::dvec3(0.0), values.radiance);
  constexpr double kSide = PlaneAndLight::kLightHalfSide;
  constexpr double kHeight = PlaneAndLight::kLightHeight;
  add_square(scene, {{{-kFar, 0, -kFar}, {-kFar, 0, kFar}, {kFar, 0, kFar}, {kFar, 0, -kFar}}}, plane);
  add_square(scene,
             {{{-kSide, kHeight, -kSide},
               {kSide, kHeight, -kSide},
               {kSide, kHeight, kSide},
               {-kSide, kHeight, kSide}}},
             light);
}

/// At the light's distance the film's height covers eight units of length.
Camera looking_at_light(double camera_height) {
  const double distance = std::abs(camera_height - PlaneAndLight::kLightHeight);
  Camera camera = looking({0, camera_height, 0}, {0, PlaneAndLight::kLightHeight, 0}, {0, 0, 1}, 0);
  camera.vertical_field_of_view_radians = 2.0 * std::atan(4.0 / distance);
  return camera;
}

void add_sphere(Scene& scene, const glm::dvec3& centre, double radius, int rings, std::int32_t material) {
  const auto point = [&](int ring, int side) {
    const double polar = kPi * ring / rings;
    const double around = kPi * side / rings;
    if (ring == 0 || ring == rings) return centre + glm::dvec3(0, ring == 0 ? radius : -radius, 0);
    return centre + radius * glm::dvec3(std::sin(polar) * std::sin(around), std::cos(polar),
                                        std::sin(polar) * std::cos(around));
  };
  const int sides = 2 * rings;
  for (int ring = 0; ring < rings; ++ring) {
    for (int side = 0; side < sides; ++side) {
      const int next = (side + 1) % sides;
      if (ring > 0)
        add_triangle(scene, point(ring, side), point(ring + 1, next), point(ring, next), material);
      if (ring + 1 < rings)
        add_triangle(scene, point(ring, side), point(ring + 1, side), point(ring + 1, next), material);
    }
  }
}

/// Winds the triangle so that the origin is in front of it.
void add_inward(Scene& scene, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, int levels) {
  if (levels == 0) {
    if (glm::dot(glm::cross(b - a, c - a), a) < 0) {
      add_triangle(scene, a, b, c, 0);
    } else {
      add_triangle(scene, a, c, b, 0);
    }
    return;
  }
  const glm::dvec3 ab = glm::normalize(a + b);
  const glm::dvec3 bc = glm::normalize(b + c);
  const glm::dvec3 ca = glm::normalize(c + a);
  add_inward(scene, a, ab, ca, levels - 1);
  add_inward(scene, ab, b, bc, levels - 1);
  add_inward(scene, ca, bc, c, levels - 1);
  add_inward(scene, ab, bc, ca, levels - 1);
}

}  // namespace

Scene closed_cube(double albedo, double emission, FilmSize film) {
  Scene scene = named("closed_cube", film);
  add_material(scene, "wall", glm::dvec3(albedo), glm::dvec3(emission));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 normal(0.0);
      glm::dvec3 u(0.0);
      normal[axis] = -side;  // points inwards
      u[(axis + 1) % 3] = 1.0;
      const glm::dvec3 v = glm::cross(normal, u);
      const glm::dvec3 centre = -normal;
      add_square(scene, {{centre - u - v, centre + u - v, centre + u + v, centre - u + v}}, 0);
    }
  }
  scene.camera = looking({-0.6, -0.3, -0.7}, {0.9, 0.8, 0.7}, {0, 1, 0}, 80);
  return scene;
}

Scene closed_sphere(double albedo, double emission, int levels, FilmSize film) {
  Scene scene = named("closed_sphere", film);
  add_material(scene, "wall", glm::dvec3(albedo), glm::dvec3(emission));
  for (int octant = 0; octant < 8; ++octant) {
    const auto axis = [octant](int i) {
      glm::dvec3 point(0.0);
      point[i] = (octant >> i) & 1 ? 1.0 : -1.0;
      return point;
    };
    add_inward(scene, axis(0), axis(1), axis(2), levels);
  }
  scene.camera = looking({-0.3, -0.1, -0.2}, {0.9, 0.8, 0.7}, {0, 1, 0}, 80);
  return scene;
}

Scene plane_under_light(const PlaneAndLight& values, FilmSize film) {
  Scene scene = named("plane_under_light", film);
  add_plane_and_light(scene, values);
  scene.camera = looking({0.2, 1.5, -2.5}, {0.5, 0.0, 0.3}, {0, 1, 0}, 50);
  return scene;
}

Scene light_from_below(const PlaneAndLight& values, FilmSize film) {
  Scene scene = named("light_from_below", film);
  add_plane_and_light(scene, values);
  scene.camera = looking_at_light(0.5);
  return scene;
}

Scene light_from_above(const PlaneAndLight& values, FilmSize film) {
  Scene scene = named("light_from_above", film);
  add_plane_and_light(scene, values);
  scene.camera = looking_at_light(6.0);
  return scene;
}

Scene plane_over_light(const PlaneAndLight& values, FilmSize film) {
  Scene scene = named("plane_over_light", film);
  add_plane_and_light(scene, values);
  for (std::size_t i = 0; i < 2; ++i) {
    for (glm::dvec3& vertex : scene.triangles[i].vertex) vertex.y = 2 * PlaneAndLight::kLightHeight;
    std::swap(scene.triangles[i].vertex[1], scene.triangles[i].vertex[2]);
  }
  scene.camera = looking({0.2, 3.0, -1.5}, {0.5, 4.0, 0.3}, {0, 1, 0}, 50);
  return scene;
}

Scene sphere_under_light(int rings, FilmSize film) {
  Scene scene = named("sphere_under_light", film);
  const std::int32_t white = add_material(scene, "white", glm::dvec3(0.75), glm::dvec3(0.0));
  const std::int32_t red = add_material(scene, "red", glm::dvec3(0.6, 0.1, 0.1), glm::dvec3(0.0));
  const std::int32_t light = add_material(scene, "light", glm::dvec3(0.0), glm::dvec3(8.0, 7.0, 6.0));
  add_sphere(scene, {0.1, 0.0, 0.0}, 0.7, rings, red);
  add_square(scene, {{{-2, -1, -2}, {-2, -1, 2}, {2, -1, 2}, {2, -1, -2}}}, white);
  add_square(scene, {{{-2, -1, 2}, {-2, 2, 2}, {2, 2, 2}, {2, -1, 2}}}, white);
  add_square(scene, {{{-0.5, 1.9, -0.5}, {0.5, 1.9, -0.5}, {0.5, 1.9, 0.5}, {-0.5, 1.9, 0.5}}}, light);
  scene.camera = looking({0, 0.2, -4}, {0, 0, 0}, {0, 1, 0}, 40);
  return scene;
}

Scene triangle_soup(int triangles, std::uint64_t seed, FilmSize film) {
  Scene scene = named("triangle_soup", film);
  const std::int32_t grey = add_material(scene, "grey", glm::dvec3(0.7, 0.5, 0.3), glm::dvec3(0.0));
  const std::int32_t glowing = add_material(scene, "glowing", glm::dvec3(0.2), glm::dvec3(1.0, 2.0, 3.0));
  std::mt19937_64 random(seed);
  const auto uniform = [&random](double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
  };
  const auto near = [&](const glm::dvec3& centre, double size) {
    const double x = uniform(-size, size);
    const double y = uniform(-size, size);
    return centre + glm::dvec3(x, y, uniform(-size, size));
  };
  for (int i = 0; i < triangles; ++i) {
    const glm::dvec3 a = near({0, 0, 0}, 2.0);
    const glm::dvec3 b = near(a, 0.8);
    add_triangle(scene, a, b, near(a, 0.8), i % 8 == 0 ? glowing : grey);
  }
  scene.camera = looking({0, 0, -5}, {0, 0, 0}, {0, 1, 0}, 45);
  return scene;
}

Scene small_cornell_box(FilmSize film) {
  Scene scene = testbench::load_scene(std::string(CSX600_SCENES_DIR) + "/cornell_box");
  scene.film = film;
  return scene;
}

testbench::Texture random_texture(int width, int height, int channels, testbench::TexelEncoding encoding) {
  testbench::Texture texture{"random", encoding, {width, height, channels, {}}};
  std::mt19937 random(static_cast<unsigned>(width * 100 + height));
  texture.image.texels.resize(std::size_t(width) * std::size_t(height) * std::size_t(channels));
  for (std::uint8_t& code : texture.image.texels) code = std::uint8_t(random());
  return texture;
}

void add_textured_square(testbench::Scene& scene, const std::array<glm::dvec3, 4>& corners,
                         std::int32_t material) {
  const glm::dvec2 place[4] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  scene.corners.coordinates[0].resize(scene.triangles.size());  // of triangles without a texture
  for (const auto& [b, c] : {std::pair{1, 2}, std::pair{2, 3}}) {
    scene.triangles.push_back({{corners[0], corners[std::size_t(b)], corners[std::size_t(c)]}, material});
    scene.corners.coordinates[0].push_back({place[0], place[b], place[c]});
  }
}

testbench::Scene textured_square(testbench::FilmSize film, testbench::TextureFilter filter) {
  testbench::Scene scene;
  scene.name = "textured square";
  scene.film = film;
  const double half_width = double(film.width) / film.height;
  scene.camera.position = {0, 0, 5};
  scene.camera.direction = {0, 0, -1};
  scene.camera.orthographic_height = 2.0;
  scene.textures.push_back(random_texture(film.width, film.height, 3, testbench::TexelEncoding::srgb));
  scene.materials.push_back({"textured", glm::dvec3(1.0)});
  scene.materials[0].textures.reflectance.texture = 0;
  scene.materials[0].textures.reflectance.filter = filter;
  add_textured_square(
      scene, {{{-half_width, -1, 0}, {half_width, -1, 0}, {half_width, 1, 0}, {-half_width, 1, 0}}}, 0);
  scene.environment.constant = glm::dvec3(1.0);
  return scene;
}

testbench::Scene textured_squares(testbench::FilmSize film, bool has_textured_light) {
  using testbench::TexelEncoding;
  using testbench::TextureWrap;
  testbench::Scene scene = textured_square(film, testbench::TextureFilter::linear);
  scene.name = "textured squares";
  scene.textures.push_back(random_texture(5, 3, 4, TexelEncoding::srgb));
  scene.textures.push_back(random_texture(4, 7, 3, TexelEncoding::linear));
  scene.textures.push_back(random_texture(1, 2, 1, TexelEncoding::linear));
  constexpr TextureWrap kWraps[] = {TextureWrap::repeat, TextureWrap::mirrored_repeat,
                                    TextureWrap::clamp_to_edge};
  for (int i = 0; i < 6; ++i) {
    testbench::Material material{"square", {0.9, 0.7, 0.5}};
    material.specular = i % 2;
    material.metallic = i > 3 ? 0.6 : 1.0;
    material.roughness = 1.0;
    if (i > 3) material.transmission = 0.9;
    testbench::MaterialTextures& textures = material.textures;
    if (i != 2) textures.reflectance.texture = 1;
    if (i != 1) textures.metallic.texture = 2;
    textures.roughness.texture = i % 2 == 0 ? 2 : 3;
    if (i == 5) textures.transmission.texture = 3;
    textures.metallic.channel = 2;
    textures.roughness.channel = i % 2 == 0 ? 1 : 0;
    testbench::for_each_texture(textures, [&](testbench::TextureReference& reference) {
      reference.wrap_u = kWraps[i % 3];
      reference.wrap_v = kWraps[(i + 1) % 3];
      reference.filter = i < 2 ? testbench::TextureFilter::nearest : testbench::TextureFilter::linear;
      reference.transform = {{0.3, -2.1}, 0.4 * i, {2.5, -1.5}};
    });
    scene.materials.push_back(material);
    const double z = 0.2 + 0.3 * i;
    const double x = -1.0 + 0.35 * i;
    add_textured_square(
        scene, {{{x, -0.8, z}, {x + 0.6, -0.7, z + 0.3}, {x + 0.6, 0.7, z + 0.2}, {x, 0.8, z - 0.1}}}, i + 1);
  }
  scene.materials.push_back({"light", glm::dvec3(0.0), glm::dvec3(3.0)});
  if (has_textured_light) scene.materials.back().textures.emission.texture = 1;
  add_textured_square(scene, {{{-1, 2, 3}, {-1, 2, 0}, {1, 2, 0}, {1, 2, 3}}}, 7);
  return scene;
}

}  // namespace test_support
