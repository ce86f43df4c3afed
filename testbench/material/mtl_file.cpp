#include "testbench/material/mtl_file.hpp"

#include <algorithm>
#include <initializer_list>
#include <set>

#include "testbench/files/text_lines.hpp"
#include "testbench/material/mtl_surface.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// The range that the numbers of a colour must lie in, and its description for error messages.
struct ColourRange {
  double high;
  const char* allowed;
};

constexpr ColourRange kReflectanceRange{1.0, "3 numbers from 0 to 1"};
constexpr ColourRange kEmissionRange{kMaxEmission, "3 numbers from 0 to 1e30"};

bool is_one_of(std::string_view word, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Notes a keyword that is not read. @param note takes a text
template <class Note>
void note_unread(std::string_view keyword, const Note& note) {
  if (keyword.substr(0, 4) == "map_" || is_one_of(keyword, {"disp", "decal", "refl"}))
    note("a texture of a kind that is not read is left out");
  else if (is_one_of(keyword, {"aniso", "anisor"}))
    note("anisotropy is left out");
  else if (!is_one_of(keyword, {"ka", "ks", "tf", "illum", "sharpness"}))
    note("an unknown keyword of MTL is left out");
}

/// One number of MtlSurface.
struct MtlNumber {
  std::string_view keyword;
  std::optional<double> MtlSurface::*member;
  double least;
  double most;
};

constexpr MtlNumber kMtlNumbers[] = {
    {"ns", &MtlSurface::phong_exponent, 0.0, 1e12},
    {"ni", &MtlSurface::ior, 1.0, 100.0},
    {"d", &MtlSurface::opacity, 0.0, 1.0},
    {"tr", &MtlSurface::transparency, 0.0, 1.0},
    {"pr", &MtlSurface::roughness, 0.0, 1.0},
    {"pm", &MtlSurface::metallic, 0.0, 1.0},
    {"ps", &MtlSurface::sheen, 0.0, 1.0},
    {"pc", &MtlSurface::clearcoat, 0.0, 1.0},
    {"pcr", &MtlSurface::clearcoat_roughness, 0.0, 1.0},
};

/// Reads one MTL text.
class MtlReader {
 public:
  explicit MtlReader(const std::filesystem::path& file, std::string_view text) : file_(file), lines_(text) {}

  std::vector<MtlMaterial> read() {
    while (lines_.next()) read_line(lines_.line());
    finish_material();
    return std::move(materials_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, std::string_view found, const char* allowed) const {
    throw InputError(where() + ": " + what + ": found " + in_quotes(found) + "; allowed: " + allowed);
  }

  std::string where() const { return file_.string() + ":" + std::to_string(lines_.number()); }

  void read_line(std::string_view line) {
    const std::string_view word = take_word(line);
    if (word.empty() || word.front() == '#') return;
    const std::string keyword = lower_case(word);
    if (keyword == "newmtl") return begin_material(std::string(trimmed(line)));
    if (materials_.empty()) fail("MTL line", word, "newmtl before it");
    const std::string_view value = trimmed(without_comment(line));
    if (keyword == "kd") {
      material().reflectance = colour(word, value, kReflectanceRange);
      has_reflectance_ = true;
    } else if (keyword == "ke") {
      material().emission = colour(word, value, kEmissionRange);
    } else {
      read_surface(keyword, word, value);
    }
  }

  void read_surface(const std::string& keyword, std::string_view word, std::string_view value) {
    for (const MtlNumber& number : kMtlNumbers)
      if (number.keyword == keyword) return read_number(number, word, value);
    if (keyword == "ks") surface_.specular_colour = colour_within(1.0, word, value);
    if (keyword == "tf") surface_.transmission_colour = colour_within(1.0, word, value);
    double model = 0.0;
    if (keyword == "illum" && parse_number(value, model) && model >= 0.0 && model <= 10.0)
      surface_.illumination_model = static_cast<int>(model);
    if (std::optional<MtlTexture> texture = parse_mtl_texture(keyword, value, where_of(word)))
      materials_.back().textures.push_back(std::move(*texture));
    else
      note_unread(keyword, [&](const char* text) { note(text, word); });
  }

  void read_number(const MtlNumber& number, std::string_view word, std::string_view value) {
    double found = 0.0;
    if (parse_number(value, found) && found >= number.least && found <= number.most)
      surface_.*number.member = found;
    else
      note("a number of MTL that is out of range is left out", word);
  }

  std::optional<glm::dvec3> colour_within(double high, std::string_view word, std::string_view value) {
    glm::dvec3 result;
    if (parse_colour(value, high, result)) return result;
    note("a colour of MTL that is out of range is left out", word);
    return std::nullopt;
  }

  void note(const char* text, std::string_view word) { materials_.back().notes.add(text, where_of(word)); }

  std::string where_of(std::string_view word) const {
    return where() + ": " + std::string(word.substr(0, 40));
  }

  Material& material() { return materials_.back().material; }

  void begin_material(const std::string& name) {
    if (!materials_.empty()) finish_material();
    if (!names_.insert(name).second) fail("newmtl", name, "each name defined once");
    materials_.emplace_back();
    material().name = name;
    has_reflectance_ = false;
    surface_ = MtlSurface();
    begin_ = where();
  }

  void finish_material() {
    if (materials_.empty()) return;
    set_mtl_surface(surface_, material());
    for (MtlTexture& texture : materials_.back().textures) {
      if (texture.slot == &MaterialTextures::roughness && !surface_.roughness)
        texture.factor = &Material::roughness;
      if (texture.slot == &MaterialTextures::metallic && !surface_.metallic)
        texture.factor = &Material::metallic;
    }
    if (has_reflectance_ || material().emission != glm::dvec3(0.0)) return;
    material().reflectance = glm::dvec3(kDefaultReflectance);
    static_assert(kDefaultReflectance == 0.8, "the note says 0.8");
    materials_.back().notes.add("a material without Kd has the default reflectance of 0.8", begin_);
  }

  glm::dvec3 colour(std::string_view keyword, std::string_view line, const ColourRange& range) {
    glm::dvec3 result;
    if (!parse_colour(line, range.high, result))
      fail("material '" + material().name + "': " + std::string(keyword), line, range.allowed);
    return result;
  }

  /// Whether the line begins with three numbers from 0 to `high`; sets `result` to them.
  static bool parse_colour(std::string_view line, double high, glm::dvec3& result) {
    for (int channel = 0; channel < 3; ++channel) {
      double value = 0.0;
      if (!parse_number(take_word(line), value) || value < 0.0 || value > high) return false;
      result[channel] = value;
    }
    return true;
  }

  const std::filesystem::path& file_;
  LineReader lines_;
  std::vector<MtlMaterial> materials_;
  std::set<std::string> names_;
  MtlSurface surface_;  ///< of the last material
  std::string begin_;   ///< file and line of the last newmtl
  bool has_reflectance_ = false;
};

}  // namespace

std::vector<MtlMaterial> scan_materials(const std::filesystem::path& file, std::string_view text) {
  return MtlReader(file, text).read();
}

}  // namespace testbench
