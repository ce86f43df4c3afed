#include "testbench/scene_file/generated_scene.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "testbench/scene/mesh.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

enum RoomMaterial : std::int32_t { kWhite, kRed, kGreen, kLight, kObject };

constexpr double kRoom = 556.0;  // edge of the Cornell box, in millimetres
const glm::dvec3 kCentre{0.5 * kRoom, 0.5 * kRoom, 0.5 * kRoom};

std::vector<Material> materials() {
  return {{"white", glm::dvec3(0.74), glm::dvec3(0.0)},
          {"red", {0.47, 0.05, 0.05}, glm::dvec3(0.0)},
          {"green", {0.09, 0.40, 0.08}, glm::dvec3(0.0)},
          {"light", glm::dvec3(0.78), {17.0, 11.5, 3.0}},
          {"object", {0.65, 0.62, 0.55}, glm::dvec3(0.0)}};
}

void add_quad(Scene& scene, const glm::dvec3& corner, const glm::dvec3& edge1, const glm::dvec3& edge2,
              std::int32_t material) {
  scene.triangles.push_back({{corner, corner + edge1, corner + edge1 + edge2}, material});
  scene.triangles.push_back({{corner, corner + edge1 + edge2, corner + edge2}, material});
}

/// Adds floor, ceiling, back and sides that face inwards. The side towards the camera is open.
void add_walls(Scene& scene) {
  const glm::dvec3 x{kRoom, 0, 0};
  const glm::dvec3 y{0, kRoom, 0};
  const glm::dvec3 z{0, 0, kRoom};
  add_quad(scene, {0, 0, 0}, z, x, kWhite);
  add_quad(scene, y, x, z, kWhite);
  add_quad(scene, z, y, x, kWhite);
  add_quad(scene, x, z, y, kRed);
  add_quad(scene, {0, 0, 0}, y, z, kGreen);
}

/// Adds a light just below the ceiling.
void add_ceiling_light(Scene& scene) {
  constexpr double kLightSize = 0.24 * kRoom;
  add_quad(scene, {0.5 * (kRoom - kLightSize), 0.998 * kRoom, 0.5 * (kRoom - kLightSize)}, {kLightSize, 0, 0},
           {0, 0, kLightSize}, kLight);
}

/// Without a light.
Scene room() {
  Scene scene;
  scene.materials = materials();
  scene.film = {kDefaultFilmSide, kDefaultFilmSide};
  scene.camera.position = {0.5 * kRoom, 0.5 * kRoom, -800.0};
  scene.camera.vertical_field_of_view_radians = 2.0 * std::atan2(0.0125, 0.035);
  add_walls(scene);
  return scene;
}

/// Adds a ball: a cube with cells * cells squares on each face, whose points are moved to radius(direction)
/// from the centre.
template <class Radius>
void add_ball(Scene& scene, const glm::dvec3& centre, int cells, const Radius& radius) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto across = [cells](int i) {  // steps of equal angle; exactly +-1 where faces meet
        return i == 0       ? -1.0
               : i == cells ? 1.0
                            : std::tan(glm::quarter_pi<double>() * (2.0 * i / cells - 1.0));
      };
      const auto point = [&](int i, int j) {
        glm::dvec3 on_cube;
        on_cube[axis] = side;
        on_cube[(axis + 1) % 3] = across(i);
        on_cube[(axis + 2) % 3] = side * across(j);
        const glm::dvec3 direction = glm::normalize(on_cube);
        return centre + direction * radius(direction);
      };
      for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j) {
          const glm::dvec3 corner[4] = {point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)};
          scene.triangles.push_back({{corner[0], corner[1], corner[2]}, kObject});
          scene.triangles.push_back({{corner[0], corner[2], corner[3]}, kObject});
        }
    }
}

constexpr int kTrianglesACell = 12;  // two on each of six faces

int cells_for(double triangles) {
  return std::max(1, static_cast<int>(std::lround(std::sqrt(triangles / kTrianglesACell))));
}

/// Adds a ball with dents and bumps of three sizes.
void add_blob(Scene& scene, const glm::dvec3& centre, double radius, double triangles) {
  add_ball(scene, centre, cells_for(triangles), [radius](const glm::dvec3& d) {
    return radius * (0.8 + 0.12 * std::sin(3.0 * d.x + 1.0) * std::cos(4.0 * d.y) +
                     0.06 * std::sin(11.0 * d.y + 2.0) * std::sin(9.0 * d.z) +
                     0.02 * std::cos(31.0 * d.z) * std::sin(29.0 * d.x));
  });
}

struct Ball {
  glm::dvec3 centre;
  double radius;
  glm::dvec3 up;
};

/// The balls that sit on `ball`: six around its waist and three on its upper half, a third of its size.
std::vector<Ball> balls_on(const Ball& ball) {
  const glm::dvec3 other = std::abs(ball.up.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 side = glm::normalize(glm::cross(ball.up, other));
  const glm::dvec3 front = glm::cross(side, ball.up);
  std::vector<Ball> balls;
  const auto add = [&](double latitude, double longitude) {
    const glm::dvec3 direction =
        ball.up * std::sin(latitude) +
        (side * std::cos(longitude) + front * std::sin(longitude)) * std::cos(latitude);
    balls.push_back({ball.centre + direction * (ball.radius * 4.0 / 3.0), ball.radius / 3.0, direction});
  };
  for (int i = 0; i < 6; ++i) add(0.0, i * glm::third<double>() * glm::pi<double>());
  for (int i = 0; i < 3; ++i)
    add(glm::third<double>() * glm::pi<double>(), (i + 0.25) * glm::two_thirds<double>() * glm::pi<double>());
  return balls;
}

void add_sphere_flake(Scene& scene, double triangles) {
  constexpr double kLeastBallTriangles = 4.0 * 4.0 * kTrianglesACell;
  std::vector<Ball> balls{{kCentre, 0.2 * kRoom, {0, 1, 0}}};
  std::size_t first = 0;
  while (double(balls.size() + 9 * (balls.size() - first)) * kLeastBallTriangles <= triangles) {
    const std::size_t last = balls.size();
    for (; first < last; ++first)
      for (const Ball& ball : balls_on(balls[first])) balls.push_back(ball);
  }
  const int cells = cells_for(triangles / double(balls.size()));
  for (const Ball& ball : balls)
    add_ball(scene, ball.centre, cells, [&](const glm::dvec3&) { return ball.radius; });
}

/// A random number in [0, 1), the same on every machine, which the standard library's distributions do not
/// guarantee.
double uniform(std::mt19937_64& random) {
  return double(random() >> 11) * 0x1p-53;
}

void add_needles(Scene& scene, int triangles) {
  std::mt19937_64 random(1);
  const auto point = [&] { return glm::dvec3(uniform(random), uniform(random), uniform(random)); };
  for (int i = 0; i < triangles; ++i) {
    const glm::dvec3 start = (0.1 + 0.8 * point()) * kRoom;
    const glm::dvec3 along = (point() - 0.5) * (0.4 * kRoom);
    const glm::dvec3 across = (point() - 0.5) * (0.0004 * kRoom);
    scene.triangles.push_back({{start, start + along, start + across}, kObject});
  }
}

/// Adds rows of seats around the lawn of a stadium of the given radius, `sides` seats per row.
void add_stands(Scene& scene, double radius, int sides, int rows) {
  const auto point = [&](int side, double row, double height) {
    const double angle = side * glm::two_pi<double>() / sides;
    const double distance = radius * (0.5 + 0.5 * row / rows);
    return glm::dvec3(distance * std::cos(angle), radius * height / rows, distance * std::sin(angle));
  };
  const auto add_strip = [&](int side, double row, double height, double next_row, double next_height) {
    const glm::dvec3 corner[4] = {point(side, row, height), point(side, next_row, next_height),
                                  point(side + 1, next_row, next_height), point(side + 1, row, height)};
    scene.triangles.push_back({{corner[0], corner[1], corner[2]}, kWhite});
    scene.triangles.push_back({{corner[0], corner[2], corner[3]}, kWhite});
  };
  for (int side = 0; side < sides; ++side)
    for (int row = 0; row < rows; ++row) {
      add_strip(side, row, 0.4 * row, row + 1, 0.4 * row);            // the floor in front of the seats
      add_strip(side, row + 1, 0.4 * row, row + 1, 0.4 * (row + 1));  // the front of the next row
    }
}

Scene stadium(int triangles) {
  constexpr double kRadius = 1e5;
  constexpr double kBlobRadius = 1.0;
  constexpr int kRows = 12;
  Scene scene;
  scene.materials = materials();
  scene.film = {kDefaultFilmSide, kDefaultFilmSide};
  scene.camera.position = {0.0, 1.5 * kBlobRadius, -4.0 * kBlobRadius};
  scene.camera.vertical_field_of_view_radians = glm::radians(40.0);
  scene.materials[kLight].emission = {1.7, 1.6,
                                      1.4};  // less than a room's light, because the lamp is so large
  const double lamp = 0.4 * kRadius;
  // The lamp is first because the lawn and the stands' lowest floor coincide (order_coincident_triangles()).
  add_quad(scene, {-lamp, 0.8 * kRadius, -lamp}, {2 * lamp, 0, 0}, {0, 0, 2 * lamp}, kLight);
  add_quad(scene, {-kRadius, 0, -kRadius}, {0, 0, 2 * kRadius}, {2 * kRadius, 0, 0}, kGreen);
  const int sides = std::max(8, triangles / 4 / (4 * kRows));
  add_stands(scene, kRadius, sides, kRows);
  add_blob(scene, {0, kBlobRadius, 0}, kBlobRadius, triangles - double(scene.triangles.size()));
  return scene;
}

/// Adds the materials of lights: six hues, each with four radiances, which differ by a factor of 4. Returns
/// the first one's index.
std::int32_t add_light_materials(Scene& scene) {
  const auto first = static_cast<std::int32_t>(scene.materials.size());
  constexpr double kLeastRadiance = 2.0;
  for (const glm::dvec3& hue : {glm::dvec3(1, 0.3, 0.2), glm::dvec3(1, 0.7, 0.2), glm::dvec3(0.4, 1, 0.3),
                                glm::dvec3(0.2, 0.8, 1), glm::dvec3(0.3, 0.4, 1), glm::dvec3(1, 0.9, 0.8)})
    for (double radiance = kLeastRadiance; radiance < 200 * kLeastRadiance; radiance *= 4) {
      const std::string name = "light" + std::to_string(scene.materials.size() - std::size_t(first));
      scene.materials.push_back({name, glm::dvec3(0.0), hue * radiance});
    }
  return first;
}

/// Adds a square light of a random size that looks in a random direction.
void add_small_light(Scene& scene, const glm::dvec3& centre, std::mt19937_64& random, std::int32_t material) {
  const double height = 2 * uniform(random) - 1;
  const double angle = glm::two_pi<double>() * uniform(random);
  const double waist = std::sqrt(1 - height * height);
  const glm::dvec3 normal(waist * std::cos(angle), height, waist * std::sin(angle));
  const glm::dvec3 other = std::abs(height) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const double side = (0.01 + 0.02 * uniform(random)) * kRoom;
  const glm::dvec3 edge1 = side * glm::normalize(glm::cross(normal, other));
  const glm::dvec3 edge2 = glm::cross(normal, edge1);
  add_quad(scene, centre - 0.5 * (edge1 + edge2), edge1, edge2, material);
}

/// Adds a ball, a wall across the back of the room, and lights all over the room: most in front of the wall,
/// every eighth behind it, where the camera sees none of their light.
void add_many_lights(Scene& scene, int triangles) {
  constexpr double kWall = 0.8;  // its distance from the open side, of the room's edge
  add_quad(scene, {0, 0, kWall * kRoom}, {0, kRoom, 0}, {kRoom, 0, 0}, kWhite);
  add_ball(scene, {kRoom / 2, 0.2 * kRoom, kRoom / 2}, 3, [](const glm::dvec3&) { return 0.2 * kRoom; });
  const std::int32_t first = add_light_materials(scene);
  const auto kinds = static_cast<std::int32_t>(scene.materials.size()) - first;
  std::mt19937_64 random(2);
  const int lights = (triangles - static_cast<int>(scene.triangles.size())) / 2;
  for (int i = 0; i < lights; ++i) {
    const bool is_hidden = i % 8 == 0;
    const double depth = is_hidden ? kWall + (1 - kWall) * (0.2 + 0.6 * uniform(random))
                                   : kWall * (0.05 + 0.9 * uniform(random));
    const double x = 0.05 + 0.9 * uniform(random);
    const double y = 0.5 + 0.45 * uniform(random);
    add_small_light(scene, kRoom * glm::dvec3(x, y, depth), random, first + i % kinds);
  }
}

}  // namespace

std::string name_of(GeneratedScene scene) {
  constexpr const char* kNames[] = {"blob", "sphere_flake", "stadium", "needles", "many_lights"};
  return kNames[std::size_t(scene)];
}

Scene generate_scene(GeneratedScene kind, int triangles) {
  if (triangles < kLeastGeneratedTriangles || triangles > kMostGeneratedTriangles)
    throw InputError("generated scene: found " + std::to_string(triangles) +
                     " triangles; allowed: " + std::to_string(kLeastGeneratedTriangles) + " to " +
                     std::to_string(kMostGeneratedTriangles));
  Scene scene = kind == GeneratedScene::stadium ? stadium(triangles) : room();
  if (kind != GeneratedScene::stadium && kind != GeneratedScene::many_lights) add_ceiling_light(scene);
  const int rest = triangles - static_cast<int>(scene.triangles.size());
  if (kind == GeneratedScene::blob) add_blob(scene, kCentre, 0.35 * kRoom, rest);
  if (kind == GeneratedScene::sphere_flake) add_sphere_flake(scene, rest);
  if (kind == GeneratedScene::needles) add_needles(scene, rest);
  if (kind == GeneratedScene::many_lights) add_many_lights(scene, triangles);
  scene.name = name_of(kind);
  return scene;
}

}  // namespace testbench
