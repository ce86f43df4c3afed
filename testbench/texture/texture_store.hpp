#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "testbench/texture/texture.hpp"

namespace testbench {

/// The textures of a scene while its files are read: each is decoded once, however many materials and meshes
/// use it.
class TextureStore {
 public:
  /// The index of a texture. @param name the file, or the part of a file; equal names are equal textures
  /// @param decode returns its Image, called when the name comes for the first time
  template <class Decode>
  std::int32_t index_of(const std::string& name, TexelEncoding encoding, const Decode& decode) {
    const auto found = index_of_.find({name, encoding});
    if (found != index_of_.end()) return found->second;
    textures_.push_back({name, encoding, decode()});
    const auto index = static_cast<std::int32_t>(textures_.size() - 1);
    index_of_[{name, encoding}] = index;
    return index;
  }

  /// The index of the texture in a PNG or JPEG file. Throws InputError if it cannot be read; see
  /// decode_image().
  std::int32_t index_of_file(const std::filesystem::path& file, TexelEncoding encoding);

  const Texture& at(std::int32_t index) const { return textures_[std::size_t(index)]; }
  /// Hands over all textures.
  std::vector<Texture> take() { return std::move(textures_); }

 private:
  std::vector<Texture> textures_;
  std::map<std::pair<std::string, TexelEncoding>, std::int32_t> index_of_;
};

}  // namespace testbench
