#include "testbench/texture/exr_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfStdIO.h>
#include <ImfVersion.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "testbench/files/input_file.hpp"

namespace testbench {
namespace {

/// The first header of a file. Imf::InputFile would take memory for the lines that it announces.
Imf::Header read_exr_header(const std::filesystem::path& path) {
  constexpr int kVersionAt = 4;  // behind the magic number; four bytes, the lowest first
  Imf::StdIFStream stream(path.c_str());
  char start[8];
  stream.read(start, sizeof start);
  int version = 0;
  for (int i = 3; i >= 0; --i) version = version << 8 | static_cast<unsigned char>(start[kVersionAt + i]);
  if (!Imf::isImfMagic(start)) throw std::invalid_argument("not an OpenEXR file");
  Imf::Header header;
  header.readFrom(stream, version);
  return header;
}

void require_exr_size(const Imf::Header& header, const std::filesystem::path& path, const ExrLimits& limits) {
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  const auto allowed = [&](std::int64_t side) { return side >= 1 && side <= limits.side; };
  if (!allowed(width) || !allowed(height) || std::uint64_t(width) * std::uint64_t(height) > limits.pixels)
    throw InputError(path.string() + ": dataWindow: found " + std::to_string(width) + "x" +
                     std::to_string(height) + " pixels; allowed: " + limits.allowed);
}

/// What compression can make of a pixel at most: zlib expands by a factor below 1032, and a whole chunk of
/// pixels is behind each entry of the line table, so a file holds at least a byte for each 1032 of its
/// pixels'.
void require_exr_pixels(const Imf::Header& header, const std::filesystem::path& path) {
  constexpr double kMostExpansion = 1032;
  constexpr double kLeastPixelBytes = 2;
  const Imath::Box2i& window = header.dataWindow();
  const double pixels = (double(window.max.x) - window.min.x + 1) * (double(window.max.y) - window.min.y + 1);
  const double needed = pixels * kLeastPixelBytes / kMostExpansion;
  const auto bytes = double(std::filesystem::file_size(path));
  if (bytes < needed)
    throw InputError(path.string() + ": found " + std::to_string(std::uint64_t(bytes)) + " bytes for " +
                     std::to_string(std::uint64_t(pixels)) + " pixels; allowed: a whole OpenEXR file");
}

}  // namespace

void require_exr(const std::filesystem::path& path, const ExrLimits& limits) {
  require_input_file(path, "an OpenEXR file with channels R, G and B");
  const Imf::Header header = read_exr_header(path);
  require_exr_size(header, path, limits);
  require_exr_pixels(header, path);
}

glm::ivec2 exr_size(const Imf::InputFile& file) {
  const Imath::Box2i window = file.header().dataWindow();
  return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
}

std::vector<float> read_exr_channels(Imf::InputFile& file, const char* const (&names)[3],
                                     const std::filesystem::path& path) {
  const Imath::Box2i window = file.header().dataWindow();
  const auto width = std::size_t(exr_size(file).x);
  const auto height = std::size_t(exr_size(file).y);
  // Chunks that the file does not hold leave NaN behind, which is refused below.
  std::vector<float> values(3 * width * height, std::numeric_limits<float>::quiet_NaN());
  Imf::FrameBuffer buffer;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    if (file.header().channels().findChannel(names[channel]) == nullptr)
      throw InputError(path.string() + ": found no channel " + names[channel] +
                       "; allowed: an OpenEXR file with channels " + names[0] + ", " + names[1] + " and " +
                       names[2]);
    buffer.insert(names[channel], Imf::Slice::Make(Imf::FLOAT, &values[channel], window, 3 * sizeof(float),
                                                   3 * sizeof(float) * width));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      throw InputError(path.string() + ": " + names[i % 3] + ": found a value that is not finite in pixel (" +
                       std::to_string(i / 3 % width) + ", " + std::to_string(i / 3 / width) +
                       "); allowed: finite numbers in every pixel");
  return values;
}

RadianceImage read_exr_rgb(const std::filesystem::path& path, const ExrLimits& limits) {
  return read_exr(path, limits, [&](Imf::InputFile& file) {
    RadianceImage image;
    image.width = exr_size(file).x;
    image.height = exr_size(file).y;
    image.rgb = read_exr_channels(file, kExrColour, path);
    return image;
  });
}

}  // namespace testbench
