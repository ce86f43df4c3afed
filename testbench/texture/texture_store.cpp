#include "testbench/texture/texture_store.hpp"

#include "testbench/files/input_file.hpp"
#include "testbench/texture/image_decoder.hpp"

namespace testbench {
namespace {

constexpr std::uint64_t kMostImageBytes = std::uint64_t{1} << 30;

}  // namespace

std::int32_t TextureStore::index_of_file(const std::filesystem::path& file, TexelEncoding encoding) {
  return index_of(file.lexically_normal().string(), encoding, [&] {
    return decode_image(read_input_file(file, "a readable PNG or JPEG file", kMostImageBytes), file.string());
  });
}

}  // namespace testbench
