#pragma once

#include <openexr.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "testbench/texture/image.hpp"

namespace testbench {

/// The channels that hold a colour.
inline constexpr const char* kExrColour[3] = {"R", "G", "B"};

/// The largest OpenEXR image that is read.
struct ExrLimits {
  int side = 0;
  std::size_t pixels = 0;
  std::string allowed;  ///< says it in error messages
};

/// An OpenEXR image that is open for reading; of a file of several images, the first. OpenEXR's C functions
/// read it: unlike its C++ classes, they hold what a header announces against the file before they take
/// memory for it. DWA compression is refused: version 3.1 of these functions cannot read it.
class ExrFile {
 public:
  using ChannelNames = std::vector<std::string>;

  /// Throws InputError for a file that is no OpenEXR file, is larger than the limits, or holds fewer bytes
  /// than its pixels need.
  ExrFile(const std::filesystem::path& path, const ExrLimits& limits);
  ~ExrFile() { exr_finish(&context_); }
  ExrFile(const ExrFile&) = delete;
  ExrFile& operator=(const ExrFile&) = delete;

  /// Width and height in pixels.
  const glm::ivec2& size() const { return size_; }
  /// The names of all channels, in alphabetical order.
  ChannelNames channel_names() const;
  /// The channels of those names, interleaved, the top row first. Throws InputError if one is missing or a
  /// value is not finite.
  std::vector<float> channels(const ChannelNames& names) const;
  /// Attributes that are strings.
  std::map<std::string, std::string> texts() const;

 private:
  struct Decoder;

  static void keep_message(exr_const_context_t context, exr_result_t, const char* text);
  [[noreturn]] void refuse(const std::string& found, const std::string& allowed) const;
  void require(exr_result_t result) const;
  bool is_tiled() const;
  void require_compression() const;
  void require_size(const ExrLimits& limits);
  void require_bytes() const;
  void require_channel(const std::string& name, const ChannelNames& names) const;
  void require_finite(const ChannelNames& names, const std::vector<float>& values) const;
  void read_lines(const ChannelNames& names, std::vector<float>& values) const;
  void read_tiles(const ChannelNames& names, std::vector<float>& values) const;
  /// @param channels interleaved in `values`
  float* pixel(std::vector<float>& values, std::size_t channels, int column, int row) const;
  void read_chunk(const exr_chunk_info_t& chunk, const ChannelNames& names, float* first) const;

  std::filesystem::path path_;
  std::string message_;  ///< OpenEXR's, of the last error
  exr_context_t context_ = nullptr;
  exr_attr_box2i_t window_ = {};
  glm::ivec2 size_{0};
};

/// Reads channels R, G and B of an OpenEXR file. Throws InputError if it cannot be read or a channel is
/// missing.
RadianceImage read_exr_rgb(const std::filesystem::path& path, const ExrLimits& limits);

}  // namespace testbench
