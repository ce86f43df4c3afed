#include "testbench/mono_image/texture_images.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "testbench/mono_image/barycentric.hpp"
#include "testbench/texture/sample.hpp"

namespace testbench {
namespace {

using path_tracer::ChannelFootprint;
using path_tracer::ColourFootprint;
using path_tracer::TexelFootprint;
using path_tracer::TextureRecord;
using path_tracer::TextureSlot;

constexpr int kAlphaChannel = 3;

TexelFootprint footprint(const Image& image, int x, int y, int channel) {
  const int right = (x + 1) % image.width;
  const int below = (y + 1) % image.height;
  const auto code = [&](int column, int row) {
    const std::size_t texel = std::size_t(row) * std::size_t(image.width) + std::size_t(column);
    return TexelFootprint{code_of(image, texel, channel)};
  };
  return code(x, y) | code(right, y) << 8 | code(x, below) << 16 | code(right, below) << 24;
}

/// Calls footprint_at(x, y) for all texels and writes what it returns.
template <class FootprintAt>
void write_footprints(const Image& image, std::uint8_t* to, const FootprintAt& footprint_at) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto of_texel = footprint_at(x, y);
      std::memcpy(to, &of_texel, sizeof(of_texel));
      to += sizeof(of_texel);
    }
  }
}

std::int32_t to_record(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::repeat:
      return std::int32_t(path_tracer::TextureWrap::repeat);
    case TextureWrap::mirrored_repeat:
      return std::int32_t(path_tracer::TextureWrap::mirrored_repeat);
    case TextureWrap::clamp_to_edge:
      return std::int32_t(path_tracer::TextureWrap::clamp_to_edge);
  }
  throw std::logic_error("no such wrap mode");
}

/// The places along one axis at the corners, in texels.
using CornerPlaces = std::array<double, 3>;

/// Moves the corners by whole periods of the image, so that none is far from it and no digit of a place in
/// the image is lost. Coordinates that are not finite or, in an image that repeats, span more than 2^40
/// texels, count as 0: no double of that size tells where between two texels it lies.
CornerPlaces near_image(const CornerPlaces& corners, int size, TextureWrap wrap) {
  constexpr double kMostTexels = 0x1p40;
  if (!std::isfinite(corners[0] + corners[1] + corners[2])) return {};
  if (wrap == TextureWrap::clamp_to_edge) return corners;
  const double first = std::fmod(corners[0], wrap == TextureWrap::repeat ? size : 2.0 * size);
  CornerPlaces moved{};
  for (std::size_t i = 0; i < moved.size(); ++i) {
    moved[i] = first + (corners[i] - corners[0]);
    if (!(std::abs(moved[i]) < kMostTexels)) return {};
  }
  return moved;
}

struct AffinePlace {
  double at_origin;
  cn::vec3<double> along;
};

AffinePlace affine_place(const CornerPlaces& corners, const Triangle& triangle) {
  const Barycentric barycentric(triangle);
  const glm::dvec3 along =
      (corners[1] - corners[0]) * barycentric.to_u + (corners[2] - corners[0]) * barycentric.to_v;
  return {corners[0] - glm::dot(along, triangle.vertex[0]), {along.x, along.y, along.z}};
}

}  // namespace

std::uint8_t code_of(const Image& image, std::size_t texel, int channel) {
  const std::uint8_t* const codes = &image.texels[texel * std::size_t(image.channels)];
  if (channel == kAlphaChannel) return has_alpha(image) ? codes[image.channels - 1] : 255;
  return codes[image.channels <= 2 ? 0 : channel];
}

const TextureReference& shown_texture(const Material& material, TextureSlot slot) {
  static const TextureReference kNone;
  switch (slot) {
    case TextureSlot::reflectance:
      // A clear material shows transmission_colour, which the texture multiplies only where it is the same.
      return shows_transmission_colour(material) && material.transmission_colour != material.reflectance
                 ? kNone
                 : material.textures.reflectance;
    case TextureSlot::emission:
      return material.textures.emission;
    case TextureSlot::metallic:
      return material.textures.metallic;
    case TextureSlot::roughness:
      return material.textures.roughness;
    case TextureSlot::transmission:
      return material.textures.transmission;
    case TextureSlot::alpha:
      return material.alpha_mode == AlphaMode::opaque ? kNone : material.textures.alpha;
    case TextureSlot::normal:
      return material.textures.normal;
  }
  return kNone;
}

TexturedRange textured_range(const Scene& scene, double factor, const TextureReference& reference) {
  if (!reference) return {factor, factor};
  const Image& image = scene.textures[std::size_t(reference.texture)].image;
  int least = 255;
  int largest = 0;
  for (std::size_t texel = 0; texel < texels_of(image); ++texel) {
    const int code = code_of(image, texel, reference.channel);
    least = std::min(least, code);
    largest = std::max(largest, code);
  }
  return {factor * least / 255.0, factor * largest / 255.0};
}

bool shows_roughness_with_metallic(const Material& material) {
  const TextureReference& a = material.textures.metallic;
  const TextureReference& b = material.textures.roughness;
  if (!a || !b) return true;
  return a.texture == b.texture && a.coordinate_set == b.coordinate_set && a.wrap_u == b.wrap_u &&
         a.wrap_v == b.wrap_v && a.filter == b.filter && a.transform.offset == b.transform.offset &&
         a.transform.rotation_radians == b.transform.rotation_radians &&
         a.transform.scale == b.transform.scale;
}

TextureImages::TextureImages(const Scene& scene, const std::vector<Material>& materials,
                             const path_tracer::TextureSlots& slots)
    : scene_(scene), materials_(materials), slots_(slots) {
  if (!slots.any()) return;
  const std::vector<bool> is_used = materials_in_use(scene.triangles, materials.size());
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    for (int index = 0; index < path_tracer::kTextureSlots; ++index) {
      const auto slot = TextureSlot(index);
      const TextureReference& reference = reference_of(materials[i], slot);
      if (!is_used[i] || !slots.looks_up(slot) || !reference) continue;
      const Image& image = scene.textures[std::size_t(reference.texture)].image;
      if (place_of_.emplace(use_of(materials[i], slot), bytes_).second)
        bytes_ += texels_of(image) * std::uint64_t(path_tracer::footprint_bytes(slot));
    }
  }
}

const TextureReference& TextureImages::reference_of(const Material& material, TextureSlot slot) const {
  const TextureReference& reference = shown_texture(material, slot);
  const bool is_for_roughness = slot == TextureSlot::metallic && slots_.roughness_with_metallic;
  return is_for_roughness && !reference ? shown_texture(material, TextureSlot::roughness) : reference;
}

TextureImages::Use TextureImages::use_of(const Material& material, TextureSlot slot) const {
  const TextureReference& shown = shown_texture(material, slot);
  Use use{reference_of(material, slot).texture};
  if (path_tracer::has_three_channels(slot)) return use;
  use.channel = shown ? shown.channel : kWhite;
  if (slot == TextureSlot::metallic && slots_.roughness_with_metallic) {
    const TextureReference& roughness = shown_texture(material, TextureSlot::roughness);
    if (roughness) use.roughness = roughness.channel;
  }
  return use;
}

void TextureImages::write(std::uint8_t* to) const {
  for (const auto& [use, place] : place_of_) {
    const Image& image = scene_.textures[std::size_t(use.texture)].image;
    if (use.channel == kThree) {
      write_footprints(image, to + place, [&](int x, int y) {
        return ColourFootprint{footprint(image, x, y, 0), footprint(image, x, y, 1),
                               footprint(image, x, y, 2)};
      });
    } else {
      constexpr TexelFootprint kAllWhite = 0xffffffff;
      const auto of_channel = [&](int x, int y, int channel) {
        return channel == kWhite ? kAllWhite : footprint(image, x, y, channel);
      };
      const int channel = use.channel;
      const int roughness = use.roughness;
      write_footprints(image, to + place, [&](int x, int y) {
        return ChannelFootprint{of_channel(x, y, channel), of_channel(x, y, roughness)};
      });
    }
  }
}

TextureRecord TextureImages::record_of(std::size_t triangle, TextureSlot slot, cn::MonoAddress first) const {
  TextureRecord record;
  const Triangle& of = scene_.triangles[triangle];
  const Material& material = materials_[std::size_t(of.material)];
  const TextureReference& reference = reference_of(material, slot);
  if (!reference) return record;
  const Texture& texture = scene_.textures[std::size_t(reference.texture)];
  const TexelEncoding encoding = path_tracer::is_colour(slot) ? TexelEncoding::srgb : TexelEncoding::linear;
  const bool is_alpha_channel = !path_tracer::has_three_channels(slot) && reference.channel == kAlphaChannel;
  if (texture.encoding != encoding && !is_alpha_channel)
    throw std::logic_error(texture.name + ": colours have sRGB texels, other slots have linear ones");
  const auto& coordinates = scene_.corners.coordinates[std::size_t(reference.coordinate_set)];
  CornerPlaces x{};
  CornerPlaces y{};
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const glm::dvec2 given = coordinates.empty() ? glm::dvec2(0.0) : coordinates[triangle][corner];
    const glm::dvec2 place = transformed(reference.transform, given);
    x[corner] = place.x * texture.image.width;
    y[corner] = place.y * texture.image.height;
  }
  const AffinePlace column = affine_place(near_image(x, texture.image.width, reference.wrap_u), of);
  const AffinePlace row = affine_place(near_image(y, texture.image.height, reference.wrap_v), of);
  record.x_at_origin = column.at_origin;
  record.x_along = column.along;
  record.y_at_origin = row.at_origin;
  record.y_along = row.along;
  record.footprints = first + place_of_.at(use_of(material, slot));
  record.width = texture.image.width;
  record.height = texture.image.height;
  record.wrap_x = to_record(reference.wrap_u);
  record.wrap_y = to_record(reference.wrap_v);
  record.is_linear = reference.filter == TextureFilter::linear ? 1 : 0;
  return record;
}

}  // namespace testbench
