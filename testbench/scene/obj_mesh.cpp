#include "testbench/scene/obj_mesh.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "testbench/files/input_file.hpp"
#include "testbench/scene/mtl_file.hpp"
#include "testbench/scene/text_lines.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr std::int32_t kNoMaterial = -1;

/// What the first pass over an OBJ text finds: all that faces refer to, before or behind them.
struct ObjContent {
  std::vector<glm::dvec3> vertices;
  std::vector<glm::dvec3> colours;  ///< of the vertices, with NaN for one without; empty if none has one
  std::vector<MtlMaterial> materials;
  std::map<std::string, std::int32_t, std::less<>> material_of_name;
  std::size_t faces = 0;
  Notes notes;
};

/// A place in an OBJ file.
class ObjPlace {
 public:
  ObjPlace(const std::filesystem::path& file, const LineReader& lines) : file_(file), lines_(lines) {}

  std::string text() const { return file_.string() + ":" + std::to_string(lines_.number()); }

  [[noreturn]] void fail(const std::string& what, std::string_view found, const std::string& allowed) const {
    throw InputError(text() + ": " + (what.empty() ? "" : what + ": ") + "found " + in_quotes(found) +
                     "; allowed: " + allowed);
  }

 private:
  const std::filesystem::path& file_;
  const LineReader& lines_;
};

/// The first pass: vertices and material libraries.
class ObjContentReader {
 public:
  ObjContentReader(const std::filesystem::path& file, std::string_view text, const FileReach& reach)
      : file_(file), reach_(reach), lines_(text), place_(file, lines_) {}

  ObjContent read() {
    while (lines_.next()) {
      std::string_view line = lines_.line();
      const std::string_view keyword = take_word(line);
      if (keyword == "v")
        add_vertex(line);
      else if (keyword == "f")
        ++content_.faces;
      else if (keyword == "mtllib")
        add_libraries(line);
    }
    return std::move(content_);
  }

 private:
  /// x y z, x y z w, x y z r g b, or x y z r g b a. The weight w and the opacity a are not used.
  void add_vertex(std::string_view line) {
    const std::string_view found = trimmed(line = without_comment(line));
    double numbers[7];
    int count = 0;
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      if (count == 7 || !(parse_number(word, numbers[count]) || is_no_number(word, numbers[count])))
        fail_at_vertex(found);
      ++count;
    }
    if (count < 3 || count == 5 || (count == 4 && std::isnan(numbers[3]))) fail_at_vertex(found);
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(numbers[axis]) <= kMaxCoordinate)) fail_at_vertex(found);
    content_.vertices.emplace_back(numbers[0], numbers[1], numbers[2]);
    if (count >= 6) add_colour({numbers[3], numbers[4], numbers[5]});
    if (count < 6 && !content_.colours.empty()) content_.colours.emplace_back(NAN);
  }

  /// A program that has no colour for a vertex may write nan.
  static bool is_no_number(std::string_view word, double& value) {
    value = NAN;
    return word == "nan" || word == "-nan";
  }

  void add_colour(const glm::dvec3& colour) {
    content_.colours.resize(content_.vertices.size() - 1, glm::dvec3(NAN));
    const bool is_number = !std::isnan(colour.x + colour.y + colour.z);
    if (!is_number)
      content_.notes.add_at("a vertex colour that is no number is left out",
                            [this] { return place_.text(); });
    content_.colours.push_back(is_number ? colour : glm::dvec3(NAN));
  }

  [[noreturn]] void fail_at_vertex(std::string_view found) const {
    place_.fail("vertex " + std::to_string(content_.vertices.size() + 1), found,
                "3 finite numbers of at most 1e100, and none, one, 3 or 4 numbers behind them");
  }

  void add_libraries(std::string_view line) {
    if (add_library(trimmed(line)) || add_library(trimmed(without_comment(line)))) return;
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line))
      if (!add_library(word))
        content_.notes.add("an MTL file is missing", place_.text() + ": " + std::string(word.substr(0, 100)));
  }

  /// Returns false if there is no such file.
  bool add_library(std::string_view name) {
    std::string with_slashes(name);
    std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
    return add_library_at(std::string(name)) || add_library_at(with_slashes);
  }

  bool add_library_at(const std::string& path) {
    const std::filesystem::path library = file_.parent_path() / path;
    if (path.empty() || !reach_.holds(library, place_.text() + ": mtllib")) return false;
    if (read_libraries_.insert(library).second) add_materials(library);
    return true;
  }

  void add_materials(const std::filesystem::path& library) {
    const std::string text = read_input_file(library, "a readable MTL file");
    require_no_utf_16(library, text);
    for (MtlMaterial& material : scan_materials(library, text)) {
      const auto index = static_cast<std::int32_t>(content_.materials.size());
      const std::string& name = material.material.name;
      content_.material_of_name.emplace(name, index);
      content_.material_of_name.emplace(trimmed(without_comment(name)), index);
      content_.materials.push_back(std::move(material));
    }
  }

  const std::filesystem::path& file_;
  const FileReach& reach_;
  LineReader lines_;
  ObjPlace place_;
  ObjContent content_;
  std::set<std::filesystem::path> read_libraries_;
};

/// The second pass: faces and their materials.
class ObjFaceReader {
 public:
  ObjFaceReader(const std::filesystem::path& file, std::string_view text, const ObjContent& content,
                const MeshOptions& options, Mesh& mesh)
      : content_(content),
        options_(options),
        lines_(text),
        place_(file, lines_),
        mesh_(mesh),
        builder_(mesh),
        colour_materials_(materials_) {
    for (const MtlMaterial& material : content.materials) materials_.push_back(material.material);
    materials_.push_back(options.material.value_or(Material{"default", glm::dvec3(kDefaultReflectance)}));
    default_material_ = static_cast<std::int32_t>(content.materials.size());
  }

  void read() {
    mesh_.triangles.reserve(content_.faces);
    while (lines_.next()) read_line(lines_.line());
    note_left_out_of_materials();
    keep_used_materials(materials_, mesh_);
  }

 private:
  void read_line(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (keyword == "f")
      add_face(line);
    else if (keyword == "v")
      ++vertices_so_far_;
    else if (keyword == "usemtl")
      use_material(line);
    else if (keyword == "p")
      note("a point is left out");
    else if (keyword == "l")
      note("a line is left out");
    else if (keyword == "curv" || keyword == "curv2" || keyword == "surf")
      note("a free-form curve or surface is left out");
  }

  void use_material(std::string_view line) {
    material_name_ = trimmed(line);
    auto found = content_.material_of_name.find(material_name_);
    if (found == content_.material_of_name.end())
      found = content_.material_of_name.find(trimmed(without_comment(line)));
    material_ = found == content_.material_of_name.end() ? kNoMaterial : found->second;
  }

  void add_face(std::string_view line) {
    polygon_.clear();
    corners_.clear();
    for (std::string_view corner = take_word(line); !corner.empty(); corner = take_word(line)) {
      if (corner.front() == '#') break;
      corners_.push_back(vertex_index(corner));
      polygon_.push_back(content_.vertices[corners_.back()]);
    }
    if (polygon_.size() < 3)
      place_.fail("face", std::to_string(polygon_.size()) + " corners", "3 corners or more");
    builder_.add_polygon(polygon_, material_of_face(), [this] { return place_.text(); });
  }

  /// The vertex of a corner "v", "v/vt", "v//vn" or "v/vt/vn", counted from 0.
  std::size_t vertex_index(std::string_view corner) const {
    const char* const end = corner.data() + corner.size();
    std::int64_t index = 0;
    auto [rest, error] = std::from_chars(corner.data(), end, index);
    const auto vertices = static_cast<std::int64_t>(content_.vertices.size());
    const std::int64_t place = index < 0 ? static_cast<std::int64_t>(vertices_so_far_) + index : index - 1;
    if (error != std::errc() || index == 0 || place < 0 || place >= vertices || !are_indices(rest, end))
      fail_at_corner(corner);
    return static_cast<std::size_t>(place);
  }

  /// Whether the text is empty or at most two whole numbers, which may be missing, each behind a slash.
  static bool are_indices(const char* begin, const char* end) {
    int slashes = 0;
    while (begin != end) {
      if (*begin++ != '/' || ++slashes > 2) return false;
      const char* const number = begin != end && *begin == '-' ? begin + 1 : begin;
      begin = std::find_if(number, end, [](char digit) { return digit < '0' || digit > '9'; });
      if (begin == number && number[-1] == '-') return false;
    }
    return true;
  }

  [[noreturn]] void fail_at_corner(std::string_view corner) const {
    const std::string vertices = std::to_string(content_.vertices.size());
    const std::string behind = std::to_string(vertices_so_far_);
    place_.fail("face", corner,
                content_.vertices.empty()
                    ? "none, the file holds no vertex"
                    : "vertex 1 to " + vertices + (vertices_so_far_ > 0 ? ", or -1 to -" + behind : "") +
                          ", as v, v/vt, v//vn or v/vt/vn");
  }

  std::int32_t material_of_face() {
    const bool is_coloured =
        !content_.colours.empty() &&
        std::all_of(corners_.begin(), corners_.end(), [this](std::size_t vertex) {
          return vertex < content_.colours.size() && !std::isnan(content_.colours[vertex].x);
        });
    if (material_ != kNoMaterial) {
      if (is_coloured) note("vertex colours of a face with a material are left out");
      return material_;
    }
    if (is_coloured) {
      glm::dvec3 sum(0.0);
      for (const std::size_t vertex : corners_) sum += content_.colours[vertex];
      const glm::dvec3 colour = sum / double(corners_.size());
      if (is_reflectance(colour)) return colour_materials_.index_of(colour, glm::dvec3(0.0));
      note("vertex colours outside 0 to 1 are left out");
    }
    if (!options_.material) mesh_.note_default_material([this] { return why_default(); });
    return default_material_;
  }

  void note(const char* text) {
    mesh_.notes.add_at(text, [this] { return place_.text(); });
  }

  std::string why_default() const {
    return place_.text() + ": no material" + (material_name_.empty() ? "" : " " + in_quotes(material_name_));
  }

  void note_left_out_of_materials() {
    std::vector<bool> is_used(materials_.size(), false);
    for (const Triangle& triangle : mesh_.triangles) is_used[std::size_t(triangle.material)] = true;
    for (std::size_t i = 0; i < content_.materials.size(); ++i)
      if (is_used[i]) mesh_.notes.add(content_.materials[i].notes);
  }

  const ObjContent& content_;
  const MeshOptions& options_;
  LineReader lines_;
  ObjPlace place_;
  Mesh& mesh_;
  MeshBuilder builder_;
  std::vector<Material> materials_;
  ColourMaterials colour_materials_;
  std::int32_t default_material_ = 0;
  std::int32_t material_ = kNoMaterial;
  std::string material_name_;
  std::size_t vertices_so_far_ = 0;
  Polygon polygon_;
  std::vector<std::size_t> corners_;
};

}  // namespace

Mesh load_obj_mesh(const std::filesystem::path& obj_file, const MeshOptions& options) {
  options.reach.require(obj_file, obj_file.string());
  const std::string text = read_input_file(obj_file, "a readable OBJ file");
  require_no_utf_16(obj_file, text);
  ObjContent content = ObjContentReader(obj_file, text, options.reach).read();
  Mesh mesh;
  mesh.notes = std::move(content.notes);
  ObjFaceReader(obj_file, text, content, options, mesh).read();
  require_triangles(mesh, obj_file);
  return mesh;
}

Mesh load_obj_mesh(const std::filesystem::path& obj_file) {
  return load_obj_mesh(obj_file, {FileReach(obj_file.parent_path()), std::nullopt});
}

}  // namespace testbench
