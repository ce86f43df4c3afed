#include "testbench/scene/obj_mesh.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "testbench/files/input_file.hpp"
#include "testbench/files/text_lines.hpp"
#include "testbench/material/mtl_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr std::int32_t kNoMaterial = -1;

/// What the first pass over an OBJ text finds: all that faces refer to, before or behind them.
struct ObjContent {
  std::vector<glm::dvec3> vertices;
  std::vector<glm::dvec3> colours;      ///< of the vertices, with NaN for one without; empty if none has one
  std::vector<glm::dvec3> normals;      ///< zero for one that is no direction
  std::vector<glm::dvec2> coordinates;  ///< of textures, from the upper left; empty if no material has any
  std::vector<MtlMaterial> materials;
  std::vector<std::filesystem::path> folders;  ///< of the materials' files
  std::map<std::string, std::int32_t, std::less<>> material_of_name;
  std::size_t faces = 0;
  Notes notes;
};

/// Whether a line holds a face. "fo" is the older word for "f" (Wavefront's description of the format,
/// version 3.0).
bool is_face(std::string_view keyword) {
  return keyword == "f" || keyword == "fo";
}

/// Lines of the same description that change nothing of a mesh's triangles and materials: names, groups, how
/// a program displays or approximates, and what belongs to free-form curves, whose own lines are noted.
constexpr std::string_view kLinesWithoutEffect[] = {
    "g",         "o",    "s",     "mg",     "bevel", "c_interp", "d_interp", "lod",   "shadow_obj",
    "trace_obj", "bmat", "con",   "cstype", "ctech", "deg",      "end",      "hole",  "parm",
    "scrv",      "sp",   "stech", "step",   "trim",  "vp",       "maplib",   "usemap"};

bool is_without_effect(std::string_view keyword) {
  return keyword.empty() || keyword.front() == '#' ||
         std::find(std::begin(kLinesWithoutEffect), std::end(kLinesWithoutEffect), keyword) !=
             std::end(kLinesWithoutEffect);
}

/// A line of numbers up to its comment, which needs no blank before it.
std::string_view without_any_comment(std::string_view line) {
  return line.substr(0, line.find('#'));
}

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

/// Reads the numbers of a line as far as they go; returns how many, at most `size`.
int read_numbers(std::string_view line, double* numbers, int size) {
  int count = 0;
  while (count < size && parse_number(take_word(line), numbers[count])) ++count;
  return count;
}

/// The first pass: vertices, normals and material libraries.
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
      else if (is_face(keyword))
        ++content_.faces;
      else if (keyword == "vn")
        add_normal(line);
      else if (keyword == "mtllib")
        add_libraries(line);
    }
    return std::move(content_);
  }

 private:
  /// x y z, x y z w, x y z r g b, or x y z r g b a. The weight w and the opacity a are not used.
  void add_vertex(std::string_view line) {
    const std::string_view found = trimmed(line = without_any_comment(line));
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

  void add_normal(std::string_view line) {
    glm::dvec3 normal(0.0);
    double numbers[3];
    if (read_numbers(line, numbers, 3) == 3) normal = {numbers[0], numbers[1], numbers[2]};
    if (normal == glm::dvec3(0.0))
      content_.notes.add_at("a normal that is no direction is left out", [this] { return place_.text(); });
    content_.normals.push_back(normal);
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
      content_.folders.push_back(library.parent_path());
    }
  }

  const std::filesystem::path& file_;
  const FileReach& reach_;
  LineReader lines_;
  ObjPlace place_;
  ObjContent content_;
  std::set<std::filesystem::path> read_libraries_;
};

/// Reads the texture coordinates, of which OBJ counts v from the lower edge of an image: a pass of their own,
/// for the files whose materials have textures.
void read_coordinates(const std::filesystem::path& file, std::string_view text, ObjContent& content) {
  LineReader lines(text);
  const ObjPlace place(file, lines);
  while (lines.next()) {
    std::string_view line = lines.line();
    if (take_word(line) != "vt") continue;
    double numbers[2] = {0.0, 0.0};
    if (read_numbers(line, numbers, 2) == 0)
      content.notes.add_at("a texture coordinate that is no number is 0", [&] { return place.text(); });
    content.coordinates.emplace_back(numbers[0], 1.0 - numbers[1]);
  }
}

/// The indices of a face's corner, counted from 0.
struct ObjCorner {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  std::size_t vertex = kNone;
  std::size_t coordinate = kNone;
  std::size_t normal = kNone;
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
    for (const MtlMaterial& material : content.materials) is_textured_.push_back(!material.textures.empty());
    is_textured_.push_back(has_texture(materials_.back()));
  }

  void read() {
    mesh_.triangles.reserve(content_.faces);
    while (lines_.next()) read_line(lines_.line());
    finish_used_materials();
    keep_used_materials(materials_, mesh_);
  }

 private:
  void read_line(std::string_view line) {
    const std::string_view keyword = take_word(line);
    if (is_face(keyword))
      add_face(without_any_comment(line));
    else if (keyword == "v")
      ++vertices_so_far_;
    else if (keyword == "vt")
      ++coordinates_so_far_;
    else if (keyword == "vn")
      ++normals_so_far_;
    else if (keyword == "usemtl")
      use_material(line);
    else if (keyword == "p")
      note("a point is left out");
    else if (keyword == "l")
      note("a line is left out");
    else if (keyword == "curv" || keyword == "curv2" || keyword == "surf")
      note("a free-form curve or surface is left out");
    else if (keyword != "mtllib" && !is_without_effect(keyword))
      mesh_.notes.add_at("an unknown keyword of OBJ is left out",
                         [&] { return place_.text() + ": " + std::string(keyword.substr(0, 40)); });
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
      corners_.push_back(corner_of(corner));
      polygon_.push_back(content_.vertices[corners_.back().vertex]);
    }
    if (polygon_.size() < 3)
      place_.fail("face", std::to_string(polygon_.size()) + " corners", "3 corners or more");
    const std::int32_t material = material_of_face();
    collect_attributes(std::size_t(material) < is_textured_.size() && is_textured_[std::size_t(material)]);
    builder_.add_polygon(polygon_, material, attributes_, [this] { return place_.text(); });
  }

  /// A corner "v", "v/vt", "v//vn" or "v/vt/vn".
  ObjCorner corner_of(std::string_view text) {
    const char* const end = text.data() + text.size();
    std::int64_t index = 0;
    auto [rest, error] = std::from_chars(text.data(), end, index);
    ObjCorner corner;
    corner.vertex = place_of(index, vertices_so_far_, content_.vertices.size());
    if (error != std::errc() || corner.vertex == ObjCorner::kNone || !read_indices(rest, end, corner))
      fail_at_corner(text);
    return corner;
  }

  /// The place that an index means, from 1 or back from the last one; kNone if there is no such.
  static std::size_t place_of(std::int64_t index, std::size_t so_far, std::size_t size) {
    const std::int64_t place = index < 0 ? static_cast<std::int64_t>(so_far) + index : index - 1;
    return index == 0 || place < 0 || place >= static_cast<std::int64_t>(size)
               ? ObjCorner::kNone
               : static_cast<std::size_t>(place);
  }

  /// Reads the indices behind the vertex: whether the text is empty or at most two whole numbers, which may
  /// be missing, each behind a slash.
  bool read_indices(const char* begin, const char* end, ObjCorner& corner) {
    int slashes = 0;
    while (begin != end) {
      if (*begin++ != '/' || ++slashes > 2) return false;
      const char* const first = begin;
      const char* const number = begin != end && *begin == '-' ? begin + 1 : begin;
      begin = std::find_if(number, end, [](char digit) { return digit < '0' || digit > '9'; });
      if (begin == number && number[-1] == '-') return false;
      if (begin == number) continue;
      if (slashes == 1 && !content_.coordinates.empty())
        corner.coordinate = attribute_place({first, std::size_t(begin - first)}, coordinates_so_far_,
                                            content_.coordinates.size());
      if (slashes == 2 && !content_.normals.empty())
        corner.normal =
            attribute_place({first, std::size_t(begin - first)}, normals_so_far_, content_.normals.size());
    }
    return true;
  }

  std::size_t attribute_place(std::string_view text, std::size_t so_far, std::size_t size) {
    std::int64_t index = 0;
    const bool is_number = std::from_chars(text.data(), text.data() + text.size(), index).ec == std::errc();
    const std::size_t place = is_number ? place_of(index, so_far, size) : ObjCorner::kNone;
    if (place == ObjCorner::kNone) note("an index of no texture coordinate or normal is left out");
    return place;
  }

  /// What all corners have, of which texture coordinates count if the material has textures.
  void collect_attributes(bool is_textured) {
    attributes_.clear();
    const auto have_all = [this](std::size_t ObjCorner::*place) {
      return std::all_of(corners_.begin(), corners_.end(),
                         [&](const ObjCorner& corner) { return corner.*place != ObjCorner::kNone; });
    };
    if (!content_.normals.empty() && have_all(&ObjCorner::normal))
      for (const ObjCorner& corner : corners_) attributes_.normals.push_back(content_.normals[corner.normal]);
    if (is_textured && have_all(&ObjCorner::coordinate))
      for (const ObjCorner& corner : corners_)
        attributes_.coordinates[0].push_back(content_.coordinates[corner.coordinate]);
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
        std::all_of(corners_.begin(), corners_.end(), [this](const ObjCorner& corner) {
          return corner.vertex < content_.colours.size() && !std::isnan(content_.colours[corner.vertex].x);
        });
    if (material_ != kNoMaterial) {
      if (is_coloured) note("vertex colours of a face with a material are left out");
      return material_;
    }
    if (is_coloured) {
      glm::dvec3 sum(0.0);
      for (const ObjCorner& corner : corners_) sum += content_.colours[corner.vertex];
      const glm::dvec3 colour = sum / double(corners_.size());
      if (is_reflectance(colour)) return colour_materials_.index_of(glm::dvec4(colour, 1.0), Material());
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

  /// Reads the textures of the materials that faces have, and notes what of these is left out.
  void finish_used_materials() {
    const std::vector<bool> is_used = materials_in_use(mesh_.triangles, materials_.size());
    for (std::size_t i = 0; i < content_.materials.size(); ++i) {
      if (!is_used[i]) continue;
      const MtlTextureFiles files{content_.folders[i], options_.reach, *options_.textures,
                                  options_.must_have_textures};
      mesh_.notes.add(content_.materials[i].notes);
      load_mtl_textures(content_.materials[i].textures, files, materials_[i], mesh_.notes);
    }
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
  std::vector<bool> is_textured_;  ///< by material of the MTL files, then the default one
  std::size_t vertices_so_far_ = 0;
  std::size_t coordinates_so_far_ = 0;
  std::size_t normals_so_far_ = 0;
  Polygon polygon_;
  std::vector<ObjCorner> corners_;
  PolygonAttributes attributes_;
};

}  // namespace

Mesh load_obj_mesh(const std::filesystem::path& obj_file, const MeshOptions& options) {
  options.reach.require(obj_file, obj_file.string());
  const std::string text = read_input_file(obj_file, "a readable OBJ file");
  require_no_utf_16(obj_file, text);
  ObjContent content = ObjContentReader(obj_file, text, options.reach).read();
  const bool has_textures =
      std::any_of(content.materials.begin(), content.materials.end(),
                  [](const MtlMaterial& material) { return !material.textures.empty(); }) ||
      (options.material && has_texture(*options.material));
  if (has_textures) read_coordinates(obj_file, text, content);
  Mesh mesh;
  mesh.notes = std::move(content.notes);
  ObjFaceReader(obj_file, text, content, options, mesh).read();
  require_triangles(mesh, obj_file);
  complete_corner_attributes(mesh.corners, mesh.triangles.size());
  return mesh;
}

Mesh load_obj_mesh(const std::filesystem::path& obj_file) {
  return load_obj_mesh(obj_file, {FileReach(obj_file.parent_path()), std::nullopt});
}

}  // namespace testbench
