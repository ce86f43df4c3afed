#include "testbench/scene/ply_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "testbench/files/input_file.hpp"
#include "testbench/files/text_lines.hpp"
#include "testbench/scene/ply_header.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

template <class Number>
double number_in(const unsigned char* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof(number));
  return static_cast<double>(number);
}

/// Reads the numbers behind a PLY header, one after the other.
class PlyBody {
 public:
  PlyBody(const std::filesystem::path& file, std::string_view text, const PlyHeader& header)
      : file_(file),
        format_(header.format),
        rest_(text.substr(header.bytes)),
        lines_(format_ == PlyFormat::ascii ? rest_ : std::string_view()),
        lines_of_header_(header.lines) {}

  /// Moves on to the next element. An ASCII file has one on each line that is not blank.
  void begin(const PlyElement& element, std::uint64_t index) {
    element_ = &element;
    index_ = index;
    if (format_ != PlyFormat::ascii || element.properties.empty()) return;
    do {
      if (!lines_.next()) fail("the end of the file", "all that the header announces");
      line_ = lines_.line();
    } while (trimmed(line_).empty());
  }

  /// @param may_be_any whether text that is no number is accepted, because the number is not used
  double number(const PlyType& type, bool may_be_any = false) {
    return format_ == PlyFormat::ascii ? ascii_number(type, may_be_any) : binary_number(type);
  }

  /// The number of entries of a list. Fails if the file is too short for them.
  std::size_t length(const PlyProperty& list) {
    const double length = number(*list.length_type);
    const double bytes = format_ == PlyFormat::ascii ? 2.0 : double(list.type.bytes);
    const double present = double(format_ == PlyFormat::ascii ? line_.size() : rest_.size());
    if (!(length >= 0.0 && length * bytes <= present))
      fail("a list of " + std::to_string(std::int64_t(length)) + " numbers", "as many as the file holds");
    return static_cast<std::size_t>(length);
  }

  void end() const {
    if (format_ == PlyFormat::ascii && !trimmed(line_).empty())
      fail(in_quotes(trimmed(line_)) + " behind the last property",
           "as many numbers as the header announces");
  }

  std::string where() const {
    if (format_ == PlyFormat::ascii)
      return file_.string() + ":" + std::to_string(lines_of_header_ + lines_.number());
    return file_.string() + ": " + element_->name + " " + std::to_string(index_);
  }

  [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
    throw InputError(where() + ": " + (format_ == PlyFormat::ascii ? element_->name + ": " : "") + "found " +
                     found + "; allowed: " + allowed);
  }

 private:
  double ascii_number(const PlyType& type, bool may_be_any) {
    const std::string_view word = take_word(line_);
    double value = 0.0;
    if (word.empty()) fail("too few numbers", "as many as the header announces");
    const bool is_right =
        parse_number(word, value) &&
        (!type.is_integer || (value == std::floor(value) && value >= type.low && value <= type.high));
    if (!is_right && !may_be_any)
      fail(in_quotes(word), type.is_integer ? "a whole number in the range of its type" : "a finite number");
    return value;
  }

  double binary_number(const PlyType& type) {
    if (rest_.size() < type.bytes) fail("the end of the file", "all that the header announces");
    unsigned char bytes[8] = {};
    const std::size_t count = std::min<std::size_t>(type.bytes, 8);
    for (std::size_t i = 0; i < count; ++i)
      bytes[i] =
          static_cast<unsigned char>(rest_[format_ == PlyFormat::binary_big_endian ? count - 1 - i : i]);
    rest_.remove_prefix(count);
    const bool is_signed = type.low < 0.0;
    if (!type.is_integer) return type.bytes == 4 ? number_in<float>(bytes) : number_in<double>(bytes);
    if (type.bytes == 1) return is_signed ? number_in<std::int8_t>(bytes) : number_in<std::uint8_t>(bytes);
    if (type.bytes == 2) return is_signed ? number_in<std::int16_t>(bytes) : number_in<std::uint16_t>(bytes);
    return is_signed ? number_in<std::int32_t>(bytes) : number_in<std::uint32_t>(bytes);
  }

  const std::filesystem::path& file_;
  PlyFormat format_;
  std::string_view rest_;
  LineReader lines_;
  std::size_t lines_of_header_;
  std::string_view line_;
  const PlyElement* element_ = nullptr;
  std::uint64_t index_ = 0;
};

/// Where an element keeps three numbers, such as x, y and z: the places of its properties.
using ThreePlaces = std::optional<std::array<std::size_t, 3>>;

ThreePlaces places_of(const PlyElement& element, const std::array<const char*, 3>& names) {
  std::array<std::size_t, 3> places{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto has_name = [&](const PlyProperty& p) { return p.name == names[i] && !p.length_type; };
    const auto found = std::find_if(element.properties.begin(), element.properties.end(), has_name);
    if (found == element.properties.end()) return std::nullopt;
    places[i] = std::size_t(found - element.properties.begin());
  }
  return places;
}

ThreePlaces colour_places_of(const PlyElement& element) {
  const ThreePlaces places = places_of(element, {"red", "green", "blue"});
  return places ? places : places_of(element, {"diffuse_red", "diffuse_green", "diffuse_blue"});
}

/// The places of one of several names for a texture coordinate.
std::optional<std::array<std::size_t, 2>> coordinate_places_of(const PlyElement& element) {
  constexpr const char* kNames[][2] = {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};
  for (const auto& [u, v] : kNames)
    if (const ThreePlaces places = places_of(element, {u, v, v})) return {{(*places)[0], (*places)[1]}};
  return std::nullopt;
}

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& file, std::string_view text, const MeshOptions& options, Mesh& mesh)
      : file_(file),
        options_(options),
        header_(read_ply_header(file, text)),
        body_(file, text, header_),
        mesh_(mesh),
        builder_(mesh),
        colour_materials_(materials_) {
    materials_.push_back(options.material.value_or(Material{"default", glm::dvec3(kDefaultReflectance)}));
  }

  void read() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        skip(element);
    }
    keep_used_materials(materials_, mesh_);
  }

 private:
  [[noreturn]] void fail_in_header(const std::string& found, const std::string& allowed) const {
    throw InputError(file_.string() + ": header: found " + found + "; allowed: " + allowed);
  }

  /// Reads the numbers of the next element into scalars_, and the list in place `list` into entries_.
  void read_element(const PlyElement& element, std::uint64_t index, std::size_t list) {
    body_.begin(element, index);
    scalars_.resize(element.properties.size());
    for (std::size_t place = 0; place < element.properties.size(); ++place) {
      const PlyProperty& property = element.properties[place];
      if (!property.length_type) {
        scalars_[place] = body_.number(property.type, !is_used_[place]);
        continue;
      }
      const std::size_t length = body_.length(property);
      if (place == list) entries_.clear();
      for (std::size_t i = 0; i < length; ++i) {
        const double entry = body_.number(property.type, place != list);
        if (place == list) entries_.push_back(entry);
      }
    }
    body_.end();
  }

  void skip(const PlyElement& element) {
    mesh_.notes.add("an element other than vertex and face is left out",
                    file_.string() + ": " + element.name);
    is_used_.assign(element.properties.size(), false);
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) read_element(element, i, kNoList);
  }

  void choose_used(const PlyElement& element, const ThreePlaces& some, const ThreePlaces& others) {
    is_used_.assign(element.properties.size(), false);
    for (const ThreePlaces& places : {some, others})
      if (places)
        for (const std::size_t place : *places) is_used_[place] = true;
  }

  void read_vertices(const PlyElement& element) {
    const ThreePlaces xyz = places_of(element, {"x", "y", "z"});
    if (!xyz) fail_in_header("no x, y and z of element vertex", "all three");
    const ThreePlaces colour = colour_places_of(element);
    const ThreePlaces normal = places_of(element, {"nx", "ny", "nz"});
    const bool is_textured = has_texture(materials_.front());
    const auto coordinate = is_textured ? coordinate_places_of(element) : std::nullopt;
    choose_used(element, xyz, colour);
    vertices_.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      read_element(element, i, kNoList);
      const glm::dvec3 vertex(scalars_[(*xyz)[0]], scalars_[(*xyz)[1]], scalars_[(*xyz)[2]]);
      for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(vertex[axis]) <= kMaxCoordinate))
          body_.fail("coordinate " + std::to_string(vertex[axis]), "finite numbers of at most 1e100");
      vertices_.push_back(vertex);
      if (colour) colours_.push_back(colour_in(element, *colour));
      if (normal)
        normals_.emplace_back(scalars_[(*normal)[0]], scalars_[(*normal)[1]], scalars_[(*normal)[2]]);
      // PLY's v grows upwards by convention, as OBJ's.
      if (coordinate) coordinates_.emplace_back(scalars_[(*coordinate)[0]], 1.0 - scalars_[(*coordinate)[1]]);
    }
  }

  glm::dvec3 colour_in(const PlyElement& element, const std::array<std::size_t, 3>& places) const {
    glm::dvec3 colour;
    for (int channel = 0; channel < 3; ++channel) {
      const std::size_t place = places[std::size_t(channel)];
      const PlyType& type = element.properties[place].type;
      colour[channel] = scalars_[place] / (type.is_integer ? type.high : 1.0);
    }
    if (!is_reflectance(colour))
      body_.fail("a colour out of range",
                 "channels from 0 to 1, or from 0 to the largest integer of the type");
    return colour;
  }

  std::size_t index_list_of(const PlyElement& element) const {
    for (std::size_t place = 0; place < element.properties.size(); ++place) {
      const PlyProperty& property = element.properties[place];
      if (property.name != "vertex_indices" && property.name != "vertex_index") continue;
      if (!property.length_type || !property.type.is_integer)
        fail_in_header(property.name + " of another type", "a list of integers");
      return place;
    }
    fail_in_header("no list vertex_indices of element face", "one");
  }

  void read_faces(const PlyElement& element) {
    const std::size_t list = index_list_of(element);
    const ThreePlaces colour = colour_places_of(element);
    choose_used(element, colour, std::nullopt);
    mesh_.triangles.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      read_element(element, i, list);
      add_face(colour ? std::optional(colour_in(element, *colour)) : std::nullopt);
    }
  }

  void add_face(std::optional<glm::dvec3> colour) {
    polygon_.clear();
    for (const double index : entries_) {
      if (!(index >= 0.0 && index < double(vertices_.size()))) fail_at_index(index);
      polygon_.push_back(vertices_[std::size_t(index)]);
    }
    if (polygon_.size() < 3)
      body_.fail("a face of " + std::to_string(polygon_.size()) + " corners", "3 or more");
    const auto where = [this] { return body_.where(); };
    if (!colour && !colours_.empty()) colour = average_colour();
    if (!colour && !options_.material) mesh_.note_default_material([&] { return where() + ": no colour"; });
    const std::int32_t material =
        colour ? colour_materials_.index_of(glm::dvec4(*colour, 1.0), Material()) : std::int32_t{0};
    collect_attributes();
    builder_.add_polygon(polygon_, material, attributes_, where);
  }

  void collect_attributes() {
    attributes_.clear();
    for (const double index : entries_) {
      if (!normals_.empty()) attributes_.normals.push_back(normals_[std::size_t(index)]);
      if (!coordinates_.empty()) attributes_.coordinates[0].push_back(coordinates_[std::size_t(index)]);
    }
  }

  [[noreturn]] void fail_at_index(double index) const {
    body_.fail("vertex index " + std::to_string(std::int64_t(index)),
               vertices_.empty() ? "none, there is no vertex before the faces"
                                 : "0 to " + std::to_string(vertices_.size() - 1));
  }

  glm::dvec3 average_colour() const {
    glm::dvec3 sum(0.0);
    for (const double index : entries_) sum += colours_[std::size_t(index)];
    return sum / double(entries_.size());
  }

  static constexpr std::size_t kNoList = static_cast<std::size_t>(-1);

  const std::filesystem::path& file_;
  const MeshOptions& options_;
  PlyHeader header_;
  PlyBody body_;
  Mesh& mesh_;
  MeshBuilder builder_;
  std::vector<Material> materials_;
  ColourMaterials colour_materials_;
  std::vector<glm::dvec3> vertices_;
  std::vector<glm::dvec3> colours_;      ///< of the vertices, or empty
  std::vector<glm::dvec3> normals_;      ///< the same
  std::vector<glm::dvec2> coordinates_;  ///< the same, of textures
  std::vector<bool> is_used_;            ///< by property, of the element that is read
  std::vector<double> scalars_;          ///< by property, of the element that was read last
  std::vector<double> entries_;          ///< of its list of vertices
  Polygon polygon_;
  PolygonAttributes attributes_;
};

}  // namespace

Mesh load_ply_mesh(const std::filesystem::path& file, const MeshOptions& options) {
  options.reach.require(file, file.string());
  const std::string text = read_input_file(file, "a readable PLY file");
  Mesh mesh;
  PlyReader(file, without_byte_order_mark(text), options, mesh).read();
  require_triangles(mesh, file);
  complete_corner_attributes(mesh.corners, mesh.triangles.size());
  return mesh;
}

}  // namespace testbench
