#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "testbench/files/file_reach.hpp"
#include "testbench/scene/polygon.hpp"
#include "testbench/scene/scene.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/notes.hpp"

namespace testbench {

/// The grey of faces for which no file names a material, and of materials for which it names no colour:
/// linear reflectance of all three channels, as Blender's default material.
inline constexpr double kDefaultReflectance = 0.8;

/// The triangles of one file. `materials` holds only the materials that its triangles use, in the file's
/// order.
struct Mesh {
  std::vector<Material> materials;
  std::vector<Triangle> triangles;
  std::size_t degenerate_triangles =
      0;        ///< number of triangles dropped because they have no area; see is_degenerate()
  Notes notes;  ///< what the loader left out or replaced
  bool has_default_material = false;  ///< whether a face has the default material

  /// Notes that a face has the default material. @param where the place and why, a function
  template <class Where>
  void note_default_material(const Where& where) {
    static_assert(kDefaultReflectance == 0.8, "the note says 0.8");
    has_default_material = true;
    notes.add_at("a face has the default material of reflectance 0.8 (material of [[mesh]] sets another)",
                 where);
  }
};

/// The largest |coordinate| that a mesh may have: its cube is still a finite double.
inline constexpr double kMaxCoordinate = 1e100;
/// The largest radiance that a material may emit: the largest that a Film can hold.
inline constexpr double kMaxEmission = 1e12;

/// How a mesh file is read.
struct MeshOptions {
  FileReach reach;                   ///< of the files that it names
  std::optional<Material> material;  ///< in place of the default one
};

/// Whether a triangle has no area in double precision: its height is less than 1e-12 of its longest edge.
bool is_degenerate(const Triangle& triangle);

/// Whether all channels lie in [0, 1].
bool is_reflectance(const glm::dvec3& colour);

/// Whether all coordinates are numbers whose absolute value is at most kMaxCoordinate.
bool is_in_range(const Triangle& triangle);

/// Sets the materials of `mesh` to those of `all` that its triangles use, and renumbers the triangles'
/// indices into `all` accordingly.
void keep_used_materials(const std::vector<Material>& all, Mesh& mesh);

/// Finds and makes materials by their colour, for meshes whose faces have colours of their own.
class ColourMaterials {
 public:
  /// @param materials where new ones are appended
  explicit ColourMaterials(std::vector<Material>& materials) : materials_(materials) {}

  /// The index of the material of this reflectance, and of an emission that is always the same.
  std::int32_t index_of(const glm::dvec3& reflectance, const glm::dvec3& emission);

 private:
  struct Hash {
    std::size_t operator()(const glm::dvec3& colour) const;
  };
  std::vector<Material>& materials_;
  std::unordered_map<glm::dvec3, std::int32_t, Hash> index_of_;
};

/// Adds polygons to a mesh as triangles.
class MeshBuilder {
 public:
  explicit MeshBuilder(Mesh& mesh) : mesh_(mesh) {}

  /// Triangles without area are counted, and noted is a polygon that crosses itself. Throws InputError for
  /// one that crosses itself so often that its triangles would be far more than its vertices.
  /// @param polygon three vertices or more
  /// @param where file and line, or file and face: a function, because it is seldom called
  template <class Where>
  void add_polygon(const Polygon& polygon, std::int32_t material, const Where& where) {
    if (polygon.size() == 3) return add_triangle({{polygon[0], polygon[1], polygon[2]}, material});
    triangles_.triangles.clear();
    triangles_.crosses_itself = false;
    triangles_.is_too_tangled = false;
    triangulate(polygon, triangles_);
    if (triangles_.is_too_tangled)
      throw InputError(where() + ": found a polygon of " + std::to_string(polygon.size()) +
                       " vertices that crosses itself too often; allowed: eight times an edge");
    if (triangles_.crosses_itself) mesh_.notes.add("a polygon that crosses itself is filled", where());
    for (const auto& triangle : triangles_.triangles)
      add_triangle({{triangle[0], triangle[1], triangle[2]}, material});
  }

 private:
  void add_triangle(const Triangle& triangle) {
    if (is_degenerate(triangle)) {
      ++mesh_.degenerate_triangles;
    } else {
      mesh_.triangles.push_back(triangle);
    }
  }

  Mesh& mesh_;
  PolygonTriangles triangles_;
};

/// Throws InputError if the mesh of `file` has no triangle.
void require_triangles(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace testbench
