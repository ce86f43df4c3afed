#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "testbench/files/file_reach.hpp"
#include "testbench/scene/polygon.hpp"
#include "testbench/scene/scene.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/notes.hpp"
#include "testbench/texture/texture_store.hpp"

namespace testbench {

/// The triangles of one file. `materials` holds only the materials that its triangles use, in the file's
/// order.
struct Mesh {
  std::vector<Material> materials;
  std::vector<Triangle> triangles;
  CornerAttributes corners;   ///< of the triangles
  std::vector<Light> lights;  ///< that are no triangles
  std::size_t degenerate_triangles =
      0;        ///< number of triangles dropped because they have no area; see is_degenerate()
  Notes notes;  ///< what the loader left out or replaced

  /// Notes that a face has the default material. @param where the place and why, a function
  template <class Where>
  void note_default_material(const Where& where) {
    static_assert(kDefaultReflectance == 0.8, "the note says 0.8");
    notes.add_at("a face has the default material of reflectance 0.8 (material of [[mesh]] sets another)",
                 where);
  }
};

/// The largest |coordinate| that a mesh may have: its cube is still a finite double.
inline constexpr double kMaxCoordinate = 1e100;

/// How a mesh file is read.
struct MeshOptions {
  FileReach reach;                                   ///< of the files that it names
  std::optional<Material> material;                  ///< in place of the default one
  std::optional<std::string> camera = std::nullopt;  ///< name of the camera to take, or of its node
  std::shared_ptr<TextureStore> textures = std::make_shared<TextureStore>();  ///< where its textures go
  bool must_have_textures = false;  ///< whether a texture of an MTL file that is missing is an error
};

/// Whether a triangle has no area in double precision: its height is less than 1e-12 of its longest edge.
bool is_degenerate(const Triangle& triangle);

/// Whether all coordinates are numbers whose absolute value is at most kMaxCoordinate.
bool is_point_in_range(const glm::dvec3& point);
bool is_in_range(const Triangle& triangle);

/// Sets the materials of `mesh` to those of `all` that its triangles use, and renumbers the triangles'
/// indices into `all` accordingly.
void keep_used_materials(const std::vector<Material>& all, Mesh& mesh);

/// Drops the textures that no material of the scene uses or that show nothing, and the sets of texture
/// coordinates that no texture uses.
void keep_used_textures(Scene& scene);

/// Finds and makes materials by their colour, for meshes whose faces have colours of their own.
class ColourMaterials {
 public:
  /// @param materials where new ones are appended
  explicit ColourMaterials(std::vector<Material>& materials) : materials_(materials) {}

  /// The index of the material that is `plain`, always the same, with this reflectance and alpha.
  std::int32_t index_of(const glm::dvec4& colour, const Material& plain);

 private:
  struct Hash {
    std::size_t operator()(const glm::dvec4& colour) const;
  };
  std::vector<Material>& materials_;
  std::unordered_map<glm::dvec4, std::int32_t, Hash> index_of_;
};

/// What the corners of a polygon have: each list is empty or has an entry for each corner.
struct PolygonAttributes {
  std::vector<glm::dvec3> normals;
  std::array<std::vector<glm::dvec2>, kTextureCoordinateSets> coordinates;

  void clear() {
    normals.clear();
    for (std::vector<glm::dvec2>& of_set : coordinates) of_set.clear();
  }
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
  void add_polygon(const Polygon& polygon, std::int32_t material, const PolygonAttributes& attributes,
                   const Where& where) {
    if (polygon.size() == 3)
      return add_triangle({{polygon[0], polygon[1], polygon[2]}, material}, attributes, {0, 1, 2});
    triangles_.clear();
    triangulate(polygon, triangles_);
    if (triangles_.is_too_tangled)
      throw InputError(where() + ": found a polygon of " + std::to_string(polygon.size()) +
                       " vertices that crosses itself too often; allowed: eight times an edge");
    if (triangles_.crosses_itself) mesh_.notes.add("a polygon that crosses itself is filled", where());
    for (std::size_t i = 0; i < triangles_.triangles.size(); ++i) {
      const std::array<glm::dvec3, 3>& vertex = triangles_.triangles[i];
      add_triangle({{vertex[0], vertex[1], vertex[2]}, material}, attributes, triangles_.corners[i]);
    }
  }

 private:
  void add_triangle(const Triangle& triangle, const PolygonAttributes& attributes,
                    const std::array<std::uint32_t, 3>& corners);

  Mesh& mesh_;
  PolygonTriangles triangles_;
};

/// Throws InputError if the mesh of `file` has no triangle.
void require_triangles(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace testbench
