#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "firmware/path_tracer/program/layout.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// The texture that the firmware shows in a slot of a material; an empty reference if there is none.
const TextureReference& shown_texture(const Material& material, path_tracer::TextureSlot slot);

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
  /// @param slots that the firmware is built for
  TextureImages(const Scene& scene, const path_tracer::TextureSlots& slots);

  std::uint64_t bytes() const { return bytes_; }
  /// Writes bytes() bytes.
  void write(std::uint8_t* to) const;
  /// @param first address of the textures in mono memory, not 0
  path_tracer::TextureRecord record_of(std::size_t triangle, path_tracer::TextureSlot slot,
                                       cn::MonoAddress first) const;

 private:
  static constexpr int kColour = -1;
  /// Index of a texture, and its channel or kColour.
  using Use = std::pair<std::int32_t, int>;
  static Use use_of(const TextureReference& reference, path_tracer::TextureSlot slot);

  const Scene& scene_;
  std::map<Use, std::uint64_t> place_of_;  ///< in bytes from the first texture
  std::uint64_t bytes_ = 0;
};

}  // namespace testbench
