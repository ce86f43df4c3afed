#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "firmware/path_tracer/program/layout.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// The code of a channel; grey is red, green and blue, and alpha is 255 in an image without.
std::uint8_t code_of(const Image& image, std::size_t texel, int channel);

inline std::size_t texels_of(const Image& image) {
  return std::size_t(image.width) * std::size_t(image.height);
}

/// The texture that the firmware shows in a slot of a material; an empty reference if there is none.
const TextureReference& shown_texture(const Material& material, path_tracer::TextureSlot slot);

/// Whether roughness can be looked up together with metallic: no material has textures of both that differ in
/// more than the channel.
bool shows_roughness_with_metallic(const Material& material);

/// The least and the largest value of a material's field over its texture.
struct TexturedRange {
  double low;
  double high;
};
/// @param factor what the texture multiplies @param reference of one channel, may be empty
TexturedRange textured_range(const Scene& scene, double factor, const TextureReference& reference);

/// The textures of a scene in mono memory: for each texture and use of its channels an array of footprints
/// (firmware/path_tracer/records/tails.hpp).
class TextureImages {
 public:
  /// @param materials as the firmware is told them @param slots that it is built for
  TextureImages(const Scene& scene, const std::vector<Material>& materials,
                const path_tracer::TextureSlots& slots);

  std::uint64_t bytes() const { return bytes_; }
  /// Writes bytes() bytes.
  void write(std::uint8_t* to) const;
  /// @param first address of the textures in mono memory, not 0
  path_tracer::TextureRecord record_of(std::size_t triangle, path_tracer::TextureSlot slot,
                                       cn::MonoAddress first) const;

 private:
  static constexpr int kThree = -1;
  static constexpr int kWhite = -2;
  /// What an array of footprints shows.
  struct Use {
    std::int32_t texture = kNoTexture;
    int channel = kThree;    ///< red, green and blue; or one channel, or kWhite
    int roughness = kWhite;  ///< channel of roughness, where it is looked up with metallic

    bool operator<(const Use& other) const {
      return std::tie(texture, channel, roughness) < std::tie(other.texture, other.channel, other.roughness);
    }
  };
  /// The reference that a slot's look-up follows; an empty one if there is none.
  const TextureReference& reference_of(const Material& material, path_tracer::TextureSlot slot) const;
  Use use_of(const Material& material, path_tracer::TextureSlot slot) const;

  const Scene& scene_;
  const std::vector<Material>& materials_;
  path_tracer::TextureSlots slots_;
  std::map<Use, std::uint64_t> place_of_;  ///< in bytes from the first texture
  std::uint64_t bytes_ = 0;
};

}  // namespace testbench
