#include "testbench/material/mtl_texture.hpp"

#include <algorithm>

#include "testbench/files/text_lines.hpp"
#include "testbench/system/error.hpp"
#include "testbench/texture/height_map.hpp"

namespace testbench {
namespace {

/// One kind of texture of MTL.
struct MtlTextureKind {
  std::string_view keyword;
  TextureReference MaterialTextures::*slot;
  TexelEncoding encoding;
  bool may_be_height;
};

constexpr MtlTextureKind kMtlTextureKinds[] = {
    {"map_kd", &MaterialTextures::reflectance, TexelEncoding::srgb, false},
    {"map_ke", &MaterialTextures::emission, TexelEncoding::srgb, false},
    {"map_pr", &MaterialTextures::roughness, TexelEncoding::linear, false},
    {"map_pm", &MaterialTextures::metallic, TexelEncoding::linear, false},
    {"map_d", &MaterialTextures::alpha, TexelEncoding::linear, false},
    {"norm", &MaterialTextures::normal, TexelEncoding::linear, false},
    {"bump", &MaterialTextures::normal, TexelEncoding::linear, true},
    {"map_bump", &MaterialTextures::normal, TexelEncoding::linear, true},
};

/// Reads the options in front of a texture's file.
class MtlOptions {
 public:
  MtlOptions(std::string_view line, MtlTexture& texture) : rest_(trimmed(line)), texture_(texture) {}

  /// Returns what stands behind the options.
  std::string_view read() {
    while (!rest_.empty() && rest_.front() == '-') {
      std::string_view behind = rest_;
      const std::string option = lower_case(take_word(behind));
      if (!is_option(option)) break;  // a file whose name begins with -
      rest_ = trimmed(behind);
      read_option(option);
    }
    // MTL's v grows upwards, a texture coordinate's downwards: v = 1 - v of MTL, before and behind.
    texture_.reference.transform.offset = {offset_.x, 1.0 - scale_.y - offset_.y};
    texture_.reference.transform.scale = scale_;
    return rest_;
  }

 private:
  static bool is_option(const std::string& word) {
    static constexpr const char* kOptions[] = {"-o",      "-s",      "-t",      "-mm",     "-bm",
                                               "-blendu", "-blendv", "-boost",  "-texres", "-clamp",
                                               "-cc",     "-type",   "-imfchan"};
    return std::find(std::begin(kOptions), std::end(kOptions), word) != std::end(kOptions);
  }

  void read_option(const std::string& option) {
    if (option == "-o") {
      take_numbers(offset_);
    } else if (option == "-s") {
      take_numbers(scale_);
    } else if (option == "-t" || option == "-mm") {
      glm::dvec2 unused;
      take_numbers(unused);
    } else {
      read_word(option, take());
    }
  }

  void read_word(const std::string& option, const std::string& value) {
    if (option == "-clamp" && value == "on")
      texture_.reference.wrap_u = texture_.reference.wrap_v = TextureWrap::clamp_to_edge;
    double number = 0.0;
    if (option == "-bm" && parse_number(value, number)) texture_.bump_multiplier = number;
    if (option != "-imfchan") return;
    const std::size_t channel = std::string_view("rgbm").find(value);
    if (value.size() == 1 && channel != std::string_view::npos) texture_.channel = static_cast<int>(channel);
  }

  std::string take() {
    std::string word = lower_case(take_word(rest_));
    rest_ = trimmed(rest_);
    return word;
  }

  /// One to three numbers; the third is for textures of three dimensions.
  void take_numbers(glm::dvec2& numbers) {
    for (int axis = 0; axis < 3; ++axis) {
      std::string_view behind = rest_;
      double number = 0.0;
      if (!parse_number(take_word(behind), number)) break;
      rest_ = trimmed(behind);
      if (axis < 2) numbers[axis] = number;
    }
  }

  std::string_view rest_;
  MtlTexture& texture_;
  glm::dvec2 offset_{0.0};
  glm::dvec2 scale_{1.0};
};

/// The file that a name means, whose backslashes may stand for slashes; std::nullopt if there is none.
std::optional<std::filesystem::path> find_texture(const MtlTexture& texture, const MtlTextureFiles& files) {
  std::string with_slashes = texture.file;
  std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
  for (const std::string& name : {texture.file, with_slashes})
    if (const std::filesystem::path path = files.folder / name; files.reach.holds(path, texture.where))
      return path;
  if (files.must_exist)
    throw InputError(texture.where + ": found no file " + in_quotes(texture.file) +
                     ", it cannot be read; allowed: a PNG or JPEG file");
  return std::nullopt;
}

bool is_grey(const Image& image) {
  const auto channels = std::size_t(image.channels);
  if (channels <= 2) return true;
  for (std::size_t i = 0; i < image.texels.size(); i += channels)
    if (image.texels[i] != image.texels[i + 1] || image.texels[i] != image.texels[i + 2]) return false;
  return true;
}

/// Whether all texels have the same grey.
bool is_of_one_height(const Image& image) {
  const auto channels = std::size_t(image.channels);
  for (std::size_t i = 0; i < image.texels.size(); i += channels)
    if (image.texels[i] != image.texels[0]) return false;
  return true;
}

/// Adds the normal texture of a height map to the store. @param heights index of the map there
std::int32_t add_normals_of(const MtlTexture& texture, std::int32_t heights, TextureStore& store) {
  const HeightMap map{0, texture.bump_multiplier, texture.reference.wrap_u, texture.reference.wrap_v};
  const bool is_clamped = map.wrap_u == TextureWrap::clamp_to_edge;
  const std::string name = store.at(heights).name + ", heights times " + std::to_string(map.white_texels) +
                           (is_clamped ? ", clamped" : "");
  const Image image = store.at(heights).image;  // the store's own moves when it grows
  return store.index_of(name, TexelEncoding::linear, [&] { return normals_of_heights(image, map); });
}

/// A texture of roughness or metallic makes a material one of Pr and Pm, not of Ks and Ns.
void set_factors(const MtlTexture& texture, Material& material) {
  if (texture.slot != &MaterialTextures::roughness && texture.slot != &MaterialTextures::metallic) return;
  material.specular = 1.0;
  material.specular_colour = glm::dvec3(1.0);
  if (texture.factor != nullptr) material.*texture.factor = 1.0;
}

/// The channel of a texture that stands for one number: alpha's own if the image has one.
int channel_of(const MtlTexture& texture, const Image& image) {
  if (texture.channel) return *texture.channel;
  return texture.slot == &MaterialTextures::alpha && has_alpha(image) ? 3 : 0;
}

}  // namespace

std::optional<MtlTexture> parse_mtl_texture(std::string_view keyword, std::string_view line,
                                            const std::string& where) {
  for (const MtlTextureKind& kind : kMtlTextureKinds) {
    if (kind.keyword != keyword) continue;
    MtlTexture texture;
    texture.slot = kind.slot;
    texture.encoding = kind.encoding;
    texture.may_be_height = kind.may_be_height;
    texture.where = where;
    texture.file = MtlOptions(line, texture).read();
    if (texture.file.empty()) return std::nullopt;
    return texture;
  }
  return std::nullopt;
}

void load_mtl_textures(const std::vector<MtlTexture>& textures, const MtlTextureFiles& files,
                       Material& material, Notes& notes) {
  for (const MtlTexture& texture : textures) {
    const std::optional<std::filesystem::path> file = find_texture(texture, files);
    if (!file) {
      notes.add("a texture is missing", texture.where + ": " + texture.file);
      continue;
    }
    if (texture.slot == &MaterialTextures::emission && material.emission == glm::dvec3(0.0))
      notes.add("map_Ke without Ke shows nothing", texture.where);
    std::int32_t index = files.store.index_of_file(*file, texture.encoding);
    const bool is_height_map = texture.may_be_height && is_grey(files.store.at(index).image);
    if (is_height_map && is_of_one_height(files.store.at(index).image)) {
      notes.add("a height map (bump) of one height shows nothing", texture.where + ": " + texture.file);
      continue;
    }
    if (is_height_map) index = add_normals_of(texture, index, files.store);
    TextureReference& reference = material.textures.*texture.slot;
    reference = texture.reference;
    reference.texture = index;
    reference.channel = channel_of(texture, files.store.at(index).image);
    set_factors(texture, material);
    if (texture.slot == &MaterialTextures::normal)
      material.normal_scale = is_height_map ? 1.0 : texture.bump_multiplier;
    if (texture.slot == &MaterialTextures::alpha) material.alpha_mode = AlphaMode::blend;
  }
}

}  // namespace testbench
