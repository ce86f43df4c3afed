#include <openexr.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>

#include "testbench/files/input_file.hpp"
#include "testbench/film/film_size.hpp"
#include "testbench/film/image_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr int kPart = 0;  // files of several images: the first counts
constexpr std::size_t kChannels = 3;
constexpr const char* kMeanNames[kChannels] = {"R", "G", "B"};
constexpr const char* kVarianceNames[kChannels] = {"variance.R", "variance.G", "variance.B"};
constexpr const char* kAllowedFile = "an OpenEXR file with channels R, G and B";

/// An image that is open for reading. OpenEXR's C functions read it: unlike its C++ classes, they hold what a
/// header announces against the file before they take memory for it.
class ExrFile {
 public:
  explicit ExrFile(const std::filesystem::path& path) : path_(path) {
    require_input_file(path, kAllowedFile);
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = &message_;
    settings.error_handler_fn = keep_message;
    require(exr_start_read(&context_, path.c_str(), &settings));
    try {
      if (!message_.empty()) require(EXR_ERR_INVALID_ATTR);  // OpenEXR leaves an attribute out and goes on
      require_film();
      require_compression();
    } catch (...) {
      exr_finish(&context_);
      throw;
    }
  }
  ~ExrFile() { exr_finish(&context_); }
  ExrFile(const ExrFile&) = delete;
  ExrFile& operator=(const ExrFile&) = delete;

  FilmSize size() const { return size_; }

  /// Three channels, interleaved; all values are finite.
  std::vector<float> channels(const char* const (&names)[kChannels]) const {
    for (const char* const name : names) require_channel(name, names);
    // Chunks that end too early leave NaN behind, which is refused below.
    std::vector<float> values(kChannels * std::size_t(size_.width) * std::size_t(size_.height),
                              std::numeric_limits<float>::quiet_NaN());
    if (is_tiled())
      read_tiles(names, values);
    else
      read_lines(names, values);
    require_finite(names, values);
    return values;
  }

  /// Attributes that are strings.
  std::map<std::string, std::string> texts() const {
    std::map<std::string, std::string> texts;
    std::int32_t count = 0;
    require(exr_get_attribute_count(context_, kPart, &count));
    for (std::int32_t i = 0; i < count; ++i) {
      const exr_attribute_t* attribute = nullptr;
      require(exr_get_attribute_by_index(context_, kPart, EXR_ATTR_LIST_FILE_ORDER, i, &attribute));
      if (attribute->type == EXR_ATTR_STRING)
        texts[attribute->name] = std::string(attribute->string->str, std::size_t(attribute->string->length));
    }
    return texts;
  }

 private:
  static void keep_message(exr_const_context_t context, exr_result_t, const char* text) {
    void* message = nullptr;
    if (context != nullptr && exr_get_user_data(context, &message) == EXR_ERR_SUCCESS && message != nullptr)
      *static_cast<std::string*>(message) = text;
  }

  [[noreturn]] void refuse(const std::string& found, const std::string& allowed) const {
    throw InputError(path_.string() + ": " + found + "; allowed: " + allowed);
  }

  void require(exr_result_t result) const {
    if (result == EXR_ERR_SUCCESS) return;
    const std::string why = message_.empty() ? exr_get_default_error_message(result) : message_;
    refuse("cannot be read (" + first_line(why) + ")", kAllowedFile);
  }

  bool is_tiled() const {
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    require(exr_get_storage(context_, kPart, &storage));
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
      refuse("found an image with several samples at a depth", "one of lines or tiles");
    return storage == EXR_STORAGE_TILED;
  }

  void require_compression() const {
    exr_compression_t compression = EXR_COMPRESSION_NONE;
    require(exr_get_compression(context_, kPart, &compression));
    if (compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB)
      refuse("compression: found DWA", "any other of OpenEXR's");
  }

  /// Before memory is taken for pixels: a header of a few bytes can ask for any size.
  void require_film() {
    require(exr_get_data_window(context_, kPart, &window_));
    const std::int64_t width = std::int64_t{window_.max.x} - window_.min.x + 1;
    const std::int64_t height = std::int64_t{window_.max.y} - window_.min.y + 1;
    const auto allowed = [](std::int64_t side) { return side >= 1 && side <= kMaxFilmSide; };
    if (!allowed(width) || !allowed(height))
      refuse("dataWindow: found " + std::to_string(width) + "x" + std::to_string(height) + " pixels",
             allowed_film_size());
    size_ = {static_cast<int>(width), static_cast<int>(height)};
    require_bytes();
  }

  /// What compression can make of a pixel at most: zlib expands by a factor below 1032, and a whole chunk of
  /// pixels is behind each entry of the chunk table, so a file holds at least a byte for each 1032 of its
  /// pixels'.
  void require_bytes() const {
    constexpr std::uint64_t kMostExpansion = 1032;
    constexpr std::uint64_t kLeastPixelBytes = 2;
    const std::uint64_t pixels = std::uint64_t(size_.width) * std::uint64_t(size_.height);
    const std::uint64_t bytes = std::filesystem::file_size(path_);
    std::int32_t chunks = 0;
    const bool has_chunks = exr_get_chunk_count(context_, kPart, &chunks) == EXR_ERR_SUCCESS;
    const std::uint64_t table_bytes =
        has_chunks ? sizeof(std::uint64_t) * std::uint64_t(std::max(chunks, 0)) : 0;
    if (bytes < pixels * kLeastPixelBytes / kMostExpansion || bytes < table_bytes)
      refuse("found " + std::to_string(bytes) + " bytes for " + std::to_string(pixels) + " pixels",
             "a whole OpenEXR file");
  }

  void require_channel(const char* name, const char* const (&names)[kChannels]) const {
    const exr_attr_chlist_t* list = nullptr;
    require(exr_get_channels(context_, kPart, &list));
    for (int i = 0; i < list->num_channels; ++i) {
      const exr_attr_chlist_entry_t& channel = list->entries[i];
      if (std::string_view(channel.name.str, std::size_t(channel.name.length)) != name) continue;
      if (channel.x_sampling != 1 || channel.y_sampling != 1)
        refuse(std::string(name) + ": found a channel without a value in some pixels", "a value in each");
      return;
    }
    refuse("found no channel " + std::string(name),
           std::string("an OpenEXR file with channels ") + names[0] + ", " + names[1] + " and " + names[2]);
  }

  void read_lines(const char* const (&names)[kChannels], std::vector<float>& values) const {
    std::int32_t lines = 0;
    require(exr_get_scanlines_per_chunk(context_, kPart, &lines));
    for (int row = 0; row < size_.height; row += lines) {
      exr_chunk_info_t chunk = {};
      require(exr_read_scanline_chunk_info(context_, kPart, window_.min.y + row, &chunk));
      read_chunk(chunk, names, pixel(values, 0, row));
    }
  }

  /// Of images in several resolutions, the full one.
  void read_tiles(const char* const (&names)[kChannels], std::vector<float>& values) const {
    std::int32_t width = 0;
    std::int32_t height = 0;
    require(exr_get_tile_sizes(context_, kPart, 0, 0, &width, &height));
    for (int y = 0; y * std::int64_t{height} < size_.height; ++y)
      for (int x = 0; x * std::int64_t{width} < size_.width; ++x) {
        exr_chunk_info_t chunk = {};
        require(exr_read_tile_chunk_info(context_, kPart, x, y, 0, 0, &chunk));
        read_chunk(chunk, names, pixel(values, x * width, y * height));
      }
  }

  float* pixel(std::vector<float>& values, int column, int row) const {
    return values.data() + kChannels * (std::size_t(row) * std::size_t(size_.width) + std::size_t(column));
  }

  struct Decoder : exr_decode_pipeline_t {
    explicit Decoder(exr_const_context_t file) : exr_decode_pipeline_t(), file_(file) {}
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;
    ~Decoder() { exr_decoding_destroy(file_, this); }
    exr_const_context_t file_;
  };

  /// @param first where the chunk's first pixel goes
  void read_chunk(const exr_chunk_info_t& chunk, const char* const (&names)[kChannels], float* first) const {
    Decoder decoder(context_);
    require(exr_decoding_initialize(context_, kPart, &chunk, &decoder));
    for (std::int16_t i = 0; i < decoder.channel_count; ++i) {
      exr_coding_channel_info_t& channel = decoder.channels[i];
      const auto* const wanted = std::find_if(std::begin(names), std::end(names), [&](const char* name) {
        return std::string_view(name) == channel.channel_name;
      });
      if (wanted == std::end(names)) continue;
      channel.decode_to_ptr = reinterpret_cast<std::uint8_t*>(first + (wanted - std::begin(names)));
      channel.user_data_type = EXR_PIXEL_FLOAT;
      channel.user_bytes_per_element = sizeof(float);
      channel.user_pixel_stride = kChannels * sizeof(float);
      channel.user_line_stride = channel.user_pixel_stride * size_.width;
    }
    require(exr_decoding_choose_default_routines(context_, kPart, &decoder));
    require(exr_decoding_run(context_, kPart, &decoder));
  }

  void require_finite(const char* const (&names)[kChannels], const std::vector<float>& values) const {
    const auto width = std::size_t(size_.width);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i]))
        refuse(std::string(names[i % kChannels]) + ": found a value that is not finite in pixel (" +
                   std::to_string(i / kChannels % width) + ", " + std::to_string(i / kChannels / width) + ")",
               "finite numbers in every pixel");
  }

  std::filesystem::path path_;
  std::string message_;  ///< OpenEXR's, of the last error
  exr_context_t context_ = nullptr;
  exr_attr_box2i_t window_ = {};
  FilmSize size_;
};

}  // namespace

ExrImage read_exr_rgb(const std::filesystem::path& path) {
  const ExrFile file(path);
  return {file.size().width, file.size().height, file.channels(kMeanNames)};
}

ExrFilm read_exr_film(const std::filesystem::path& path) {
  const ExrFile file(path);
  return {file.size().width, file.size().height, file.channels(kMeanNames), file.channels(kVarianceNames),
          file.texts()};
}

}  // namespace testbench
