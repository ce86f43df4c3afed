#include "testbench/scene/obj_mesh.hpp"

#define TINYOBJLOADER_USE_DOUBLE  // must agree with the library linked: libtinyobjloader_double
#include <tiny_obj_loader.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>

#include "testbench/scene/obj_numbers.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

std::string read_text(const std::filesystem::path& file, const std::string& named_by) {
  std::error_code error;
  std::ifstream stream(file, std::ios::binary);
  if (!std::filesystem::is_regular_file(file, error) || !stream) {
    throw InputError(file.string() + ": cannot be read" + named_by + "; allowed: a readable file");
  }
  std::ostringstream text;
  if (stream.peek() != std::ifstream::traits_type::eof()) text << stream.rdbuf();
  if (stream.bad() || !text)
    throw InputError(file.string() + ": cannot be read to its end; allowed: a readable file");
  return std::move(text).str();
}

/// Passes MTL files to tinyobjloader, which maps names to indices, and keeps their checked colours in the
/// same order.
class CheckedMaterialReader : public tinyobj::MaterialReader {
 public:
  explicit CheckedMaterialReader(std::filesystem::path obj_file) : obj_file_(std::move(obj_file)) {}

  bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                  std::map<std::string, int>* indices, std::string* /*warning*/,
                  std::string* error) override {
    const std::filesystem::path file = obj_file_.parent_path() / name;
    files_.push_back(file);
    const std::string text = read_text(file, " (named by mtllib in " + obj_file_.string() + ")");
    const std::vector<Material> scanned = scan_materials(file, text);
    materials_.insert(materials_.end(), scanned.begin(), scanned.end());
    std::istringstream stream(text);
    std::string ignored;  // LoadMtl warns only of transparency, which the renderer does not model
    tinyobj::LoadMtl(indices, materials, &stream, &ignored, error);
    if (materials->size() != materials_.size()) {
      throw InputError(
          file.string() + ": found " + std::to_string(scanned.size()) +
          " materials where tinyobjloader found a different number; allowed: plain newmtl blocks");
    }
    return true;
  }

  std::vector<Material>& materials() { return materials_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }

 private:
  std::filesystem::path obj_file_;
  std::vector<Material> materials_;
  std::vector<std::filesystem::path> files_;
};

using Polygon = std::vector<glm::dvec3>;

glm::dvec3 area_vector(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::cross(b - a, c - a);
}

/// Whether the fan from vertex `start` covers the polygon with triangles that all face the same way as the
/// polygon.
bool is_fan_start(const Polygon& polygon, std::size_t start, const glm::dvec3& normal, double tolerance) {
  const std::size_t count = polygon.size();
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const glm::dvec3 area =
        area_vector(polygon[start], polygon[(start + i) % count], polygon[(start + i + 1) % count]);
    const double facing = glm::dot(area, normal);
    if (!(tolerance == 0.0 ? facing > 0.0 : facing >= -tolerance * glm::dot(normal, normal))) return false;
  }
  return true;
}

/// The vertex whose fan triangulates the polygon, which is the first one for every convex polygon;
/// std::nullopt if no fan does. A fan of proper triangles is preferred to one with collinear vertices.
std::optional<std::size_t> fan_start(const Polygon& polygon) {
  if (polygon.size() == 3) return 0;
  glm::dvec3 normal(0.0);  // Newell's normal: twice the vector area, for any planar or bent polygon
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    normal += area_vector(polygon[0], polygon[i], polygon[i + 1]);
  }
  if (normal == glm::dvec3(0.0)) {  // a line, or a polygon that crosses itself and whose parts cancel
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      if (!is_degenerate({{polygon[0], polygon[i], polygon[i + 1]}, 0})) return std::nullopt;
    }
    return 0;
  }
  for (const double tolerance : {0.0, 1e-12}) {
    for (std::size_t start = 0; start < polygon.size(); ++start) {
      if (is_fan_start(polygon, start, normal, tolerance)) return start;
    }
  }
  return std::nullopt;
}

/// Converts tinyobjloader's polygons into triangles of a mesh.
class MeshBuilder {
 public:
  MeshBuilder(const std::filesystem::path& file, const std::vector<glm::dvec3>& vertices, Mesh& mesh)
      : file_(file), vertices_(vertices), mesh_(mesh) {}

  void add_shape(const tinyobj::shape_t& shape) {
    std::size_t first_index = 0;
    for (std::size_t face = 0; face < shape.mesh.num_face_vertices.size(); ++face) {
      const std::size_t corners = shape.mesh.num_face_vertices[face];
      polygon_.clear();
      for (std::size_t corner = 0; corner < corners; ++corner) {
        polygon_.push_back(vertex(shape, shape.mesh.indices[first_index + corner].vertex_index));
      }
      first_index += corners;
      add_polygon(shape, shape.mesh.material_ids[face]);
    }
  }

 private:
  [[noreturn]] void fail(const tinyobj::shape_t& shape, const std::string& what) const {
    throw InputError(file_.string() + ": object '" + shape.name + "': " + what);
  }

  const glm::dvec3& vertex(const tinyobj::shape_t& shape, int index) const {
    if (index < 0 || static_cast<std::size_t>(index) >= vertices_.size()) {
      fail(shape, "found a face with vertex index " + std::to_string(index + 1) + "; allowed: 1 to " +
                      std::to_string(vertices_.size()));
    }
    return vertices_[static_cast<std::size_t>(index)];
  }

  void add_polygon(const tinyobj::shape_t& shape, int material) {
    const std::optional<std::size_t> start = fan_start(polygon_);
    if (!start) {
      fail(shape, "found a face with " + std::to_string(polygon_.size()) +
                      " vertices that no fan of triangles covers; allowed: convex polygons, or triangulate "
                      "it on export");
    }
    const std::size_t count = polygon_.size();
    for (std::size_t i = 1; i + 1 < count; ++i) {
      const Triangle triangle{
          {polygon_[*start], polygon_[(*start + i) % count], polygon_[(*start + i + 1) % count]}, material};
      if (is_degenerate(triangle)) {
        ++mesh_.degenerate_triangles;
      } else {
        mesh_.triangles.push_back(triangle);
      }
    }
  }

  const std::filesystem::path& file_;
  const std::vector<glm::dvec3>& vertices_;
  Mesh& mesh_;
  Polygon polygon_;
};

void require_materials(const std::filesystem::path& file, const tinyobj::shape_t& shape) {
  const std::vector<int>& ids = shape.mesh.material_ids;
  if (std::any_of(ids.begin(), ids.end(), [](int id) { return id < 0; })) {
    throw InputError(
        file.string() + ": object '" + shape.name +
        "': found a face without a material; allowed: faces after a usemtl that names one of the MTL file");
  }
}

}  // namespace

Mesh load_obj_mesh(const std::filesystem::path& obj_file) {
  const std::string text = read_text(obj_file, "");
  const std::vector<glm::dvec3> vertices = scan_vertices(obj_file, text);

  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> tinyobj_materials;
  CheckedMaterialReader material_reader(obj_file);
  std::string warning;
  std::string error;
  std::istringstream stream(text);
  // MeshBuilder triangulates, because tinyobjloader cuts quads along the shorter diagonal even where it lies
  // outside the quad.
  const bool parsed =
      tinyobj::LoadObj(&attributes, &shapes, &tinyobj_materials, &warning, &error, &stream, &material_reader,
                       /*triangulate=*/false, /*default_vcols_fallback=*/false);
  if (!parsed || !error.empty()) {
    throw InputError(obj_file.string() + ": " + first_line(error) + "; allowed: a valid OBJ file");
  }
  if (attributes.vertices.size() != 3 * vertices.size()) {
    throw InputError(obj_file.string() + ": found " + std::to_string(vertices.size()) + " vertices where " +
                     "tinyobjloader found a different number; allowed: plain 'v x y z' lines");
  }

  Mesh mesh;
  MeshBuilder builder(obj_file, vertices, mesh);
  for (const tinyobj::shape_t& shape : shapes) builder.add_shape(shape);
  if (!warning.empty())
    throw InputError(obj_file.string() + ": " + first_line(warning) + "; allowed: a valid OBJ file");
  for (const tinyobj::shape_t& shape : shapes) require_materials(obj_file, shape);
  if (mesh.triangles.empty()) {
    throw InputError(obj_file.string() + ": found no triangle (" + std::to_string(mesh.degenerate_triangles) +
                     " without area); allowed: a mesh of one triangle or more");
  }
  mesh.files = material_reader.files();
  mesh.files.push_back(obj_file);
  keep_used_materials(material_reader.materials(), mesh);
  return mesh;
}

}  // namespace testbench
