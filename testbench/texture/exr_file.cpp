#include "testbench/texture/exr_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "testbench/files/input_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr int kPart = 0;
constexpr const char* kAllowedFile = "an OpenEXR file with channels R, G and B";

}  // namespace

ExrFile::ExrFile(const std::filesystem::path& path, const ExrLimits& limits) : path_(path) {
  require_input_file(path, kAllowedFile);
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.user_data = &message_;
  settings.error_handler_fn = keep_message;
  require(exr_start_read(&context_, path.c_str(), &settings));
  try {
    if (!message_.empty()) require(EXR_ERR_INVALID_ATTR);  // OpenEXR leaves an attribute out and goes on
    require_size(limits);
    require_compression();
  } catch (...) {
    exr_finish(&context_);
    throw;
  }
}
std::vector<float> ExrFile::channels(const ChannelNames& names) const {
  for (const std::string& name : names) require_channel(name, names);
  // Chunks that end too early leave NaN behind, which is refused below.
  std::vector<float> values(names.size() * std::size_t(size_.x) * std::size_t(size_.y),
                            std::numeric_limits<float>::quiet_NaN());
  if (is_tiled())
    read_tiles(names, values);
  else
    read_lines(names, values);
  require_finite(names, values);
  return values;
}

std::map<std::string, std::string> ExrFile::texts() const {
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

void ExrFile::keep_message(exr_const_context_t context, exr_result_t, const char* text) {
  void* message = nullptr;
  if (context != nullptr && exr_get_user_data(context, &message) == EXR_ERR_SUCCESS && message != nullptr)
    *static_cast<std::string*>(message) = text;
}

void ExrFile::refuse(const std::string& found, const std::string& allowed) const {
  throw InputError(path_.string() + ": " + found + "; allowed: " + allowed);
}

void ExrFile::require(exr_result_t result) const {
  if (result == EXR_ERR_SUCCESS) return;
  const std::string why = message_.empty() ? exr_get_default_error_message(result) : message_;
  refuse("cannot be read (" + first_line(why) + ")", kAllowedFile);
}

bool ExrFile::is_tiled() const {
  exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
  require(exr_get_storage(context_, kPart, &storage));
  if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
    refuse("found an image with several samples at a depth", "one of lines or tiles");
  return storage == EXR_STORAGE_TILED;
}

void ExrFile::require_compression() const {
  exr_compression_t compression = EXR_COMPRESSION_NONE;
  require(exr_get_compression(context_, kPart, &compression));
  if (compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB)
    refuse("compression: found DWA", "any other of OpenEXR's");
}

/// Before memory is taken for pixels: a header of a few bytes can ask for any size.
void ExrFile::require_size(const ExrLimits& limits) {
  require(exr_get_data_window(context_, kPart, &window_));
  const std::int64_t width = std::int64_t{window_.max.x} - window_.min.x + 1;
  const std::int64_t height = std::int64_t{window_.max.y} - window_.min.y + 1;
  const auto allowed = [&](std::int64_t side) { return side >= 1 && side <= limits.side; };
  if (!allowed(width) || !allowed(height) || std::uint64_t(width) * std::uint64_t(height) > limits.pixels)
    refuse("dataWindow: found " + std::to_string(width) + "x" + std::to_string(height) + " pixels",
           limits.allowed);
  size_ = {static_cast<int>(width), static_cast<int>(height)};
  require_bytes();
}

/// What compression can make of a pixel at most: zlib expands by a factor below 1032, and a whole chunk of
/// pixels is behind each entry of the chunk table, so a file holds at least a byte for each 1032 of its
/// pixels'.
void ExrFile::require_bytes() const {
  constexpr std::uint64_t kMostExpansion = 1032;
  constexpr std::uint64_t kLeastPixelBytes = 2;
  const std::uint64_t pixels = std::uint64_t(size_.x) * std::uint64_t(size_.y);
  const std::uint64_t bytes = std::filesystem::file_size(path_);
  std::int32_t chunks = 0;
  const bool has_chunks = exr_get_chunk_count(context_, kPart, &chunks) == EXR_ERR_SUCCESS;
  const std::uint64_t table_bytes =
      has_chunks ? sizeof(std::uint64_t) * std::uint64_t(std::max(chunks, 0)) : 0;
  if (bytes < pixels * kLeastPixelBytes / kMostExpansion || bytes < table_bytes)
    refuse("found " + std::to_string(bytes) + " bytes for " + std::to_string(pixels) + " pixels",
           "a whole OpenEXR file");
}

ExrFile::ChannelNames ExrFile::channel_names() const {
  const exr_attr_chlist_t* list = nullptr;
  require(exr_get_channels(context_, kPart, &list));
  ChannelNames names;
  for (int i = 0; i < list->num_channels; ++i)
    names.emplace_back(list->entries[i].name.str, std::size_t(list->entries[i].name.length));
  return names;
}

void ExrFile::require_channel(const std::string& name, const ChannelNames& names) const {
  const exr_attr_chlist_t* list = nullptr;
  require(exr_get_channels(context_, kPart, &list));
  for (int i = 0; i < list->num_channels; ++i) {
    const exr_attr_chlist_entry_t& channel = list->entries[i];
    if (std::string_view(channel.name.str, std::size_t(channel.name.length)) != name) continue;
    if (channel.x_sampling != 1 || channel.y_sampling != 1)
      refuse(name + ": found a channel without a value in some pixels", "a value in each");
    return;
  }
  std::string wanted = names.front();
  for (std::size_t i = 1; i < names.size(); ++i) wanted += (i + 1 < names.size() ? ", " : " and ") + names[i];
  refuse("found no channel " + name, "an OpenEXR file with channels " + wanted);
}

void ExrFile::read_lines(const ChannelNames& names, std::vector<float>& values) const {
  std::int32_t lines = 0;
  require(exr_get_scanlines_per_chunk(context_, kPart, &lines));
  for (int row = 0; row < size_.y; row += lines) {
    exr_chunk_info_t chunk = {};
    require(exr_read_scanline_chunk_info(context_, kPart, window_.min.y + row, &chunk));
    read_chunk(chunk, names, pixel(values, names.size(), 0, row));
  }
}

/// Of images in several resolutions, the full one.
void ExrFile::read_tiles(const ChannelNames& names, std::vector<float>& values) const {
  std::int32_t width = 0;
  std::int32_t height = 0;
  require(exr_get_tile_sizes(context_, kPart, 0, 0, &width, &height));
  for (int y = 0; y * std::int64_t{height} < size_.y; ++y)
    for (int x = 0; x * std::int64_t{width} < size_.x; ++x) {
      exr_chunk_info_t chunk = {};
      require(exr_read_tile_chunk_info(context_, kPart, x, y, 0, 0, &chunk));
      read_chunk(chunk, names, pixel(values, names.size(), x * width, y * height));
    }
}

float* ExrFile::pixel(std::vector<float>& values, std::size_t channels, int column, int row) const {
  return values.data() + channels * (std::size_t(row) * std::size_t(size_.x) + std::size_t(column));
}

struct ExrFile::Decoder : exr_decode_pipeline_t {
  explicit Decoder(exr_const_context_t file) : exr_decode_pipeline_t(), file_(file) {}
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { exr_decoding_destroy(file_, this); }
  exr_const_context_t file_;
};

/// @param first where the chunk's first pixel goes
void ExrFile::read_chunk(const exr_chunk_info_t& chunk, const ChannelNames& names, float* first) const {
  Decoder decoder(context_);
  require(exr_decoding_initialize(context_, kPart, &chunk, &decoder));
  for (std::int16_t i = 0; i < decoder.channel_count; ++i) {
    exr_coding_channel_info_t& channel = decoder.channels[i];
    const auto wanted = std::find(names.begin(), names.end(), channel.channel_name);
    if (wanted == names.end()) continue;
    channel.decode_to_ptr = reinterpret_cast<std::uint8_t*>(first + (wanted - names.begin()));
    channel.user_data_type = EXR_PIXEL_FLOAT;
    channel.user_bytes_per_element = sizeof(float);
    channel.user_pixel_stride = static_cast<std::int32_t>(names.size() * sizeof(float));
    channel.user_line_stride = channel.user_pixel_stride * size_.x;
  }
  require(exr_decoding_choose_default_routines(context_, kPart, &decoder));
  require(exr_decoding_run(context_, kPart, &decoder));
}

void ExrFile::require_finite(const ChannelNames& names, const std::vector<float>& values) const {
  const auto width = std::size_t(size_.x);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      refuse(names[i % names.size()] + ": found a value that is not finite in pixel (" +
                 std::to_string(i / names.size() % width) + ", " + std::to_string(i / names.size() / width) +
                 ")",
             "finite numbers in every pixel");
}

RadianceImage read_exr_rgb(const std::filesystem::path& path, const ExrLimits& limits) {
  const ExrFile file(path, limits);
  RadianceImage image;
  image.width = file.size().x;
  image.height = file.size().y;
  image.rgb = file.channels({std::begin(kExrColour), std::end(kExrColour)});
  return image;
}

}  // namespace testbench
