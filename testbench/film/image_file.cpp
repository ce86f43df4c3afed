#include "testbench/film/image_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "testbench/files/atomic_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr const char* kMeanChannels[3] = {"R", "G", "B"};
constexpr const char* kVarianceChannels[3] = {"variance.R", "variance.G", "variance.B"};
constexpr const char* kSamplesChannel = "samples";

/// One pixel of the EXR channels, interleaved for the frame buffer.
struct ExrPixel {
  float mean[3];
  float variance[3];
  std::uint32_t samples;
};

/// The pixels of a row.
std::vector<ExrPixel> exr_pixels(const Film& film, int row) {
  const int width = film.size().width;
  std::vector<ExrPixel> pixels;
  pixels.reserve(static_cast<std::size_t>(width));
  for (int index = row * width; index < (row + 1) * width; ++index) {
    const glm::dvec3 mean = film.mean(index);
    const glm::dvec3 variance = film.variance_of_mean(index);
    ExrPixel& pixel = pixels.emplace_back();
    for (int channel = 0; channel < 3; ++channel) {
      pixel.mean[channel] = static_cast<float>(mean[channel]);
      pixel.variance[channel] = static_cast<float>(variance[channel]);
    }
    const std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    pixel.samples = static_cast<std::uint32_t>(std::min(film.sample_count(index), most));
  }
  return pixels;
}

Imf::Header exr_header(const Film& film, const std::map<std::string, std::string>& attributes) {
  Imf::Header header(film.size().width, film.size().height);
  for (const auto& [name, value] : attributes) {
    if (name.empty() || header.find(name) != header.end()) {
      throw std::invalid_argument("EXR attribute name '" + name + "' is empty or used by OpenEXR itself");
    }
    header.insert(name, Imf::StringAttribute(value));
  }
  for (int channel = 0; channel < 3; ++channel) {
    header.channels().insert(kMeanChannels[channel], Imf::Channel(Imf::FLOAT));
    header.channels().insert(kVarianceChannels[channel], Imf::Channel(Imf::FLOAT));
  }
  header.channels().insert(kSamplesChannel, Imf::Channel(Imf::UINT));
  return header;
}

/// Where OpenEXR finds the channels of one row: every row lies at the same place, so its byte stride is 0.
Imf::FrameBuffer one_row(ExrPixel* first) {
  const auto slice = [](Imf::PixelType type, auto* element) {
    return Imf::Slice(type, reinterpret_cast<char*>(element), sizeof(ExrPixel), 0);
  };
  Imf::FrameBuffer buffer;
  for (int channel = 0; channel < 3; ++channel) {
    buffer.insert(kMeanChannels[channel], slice(Imf::FLOAT, &first->mean[channel]));
    buffer.insert(kVarianceChannels[channel], slice(Imf::FLOAT, &first->variance[channel]));
  }
  buffer.insert(kSamplesChannel, slice(Imf::UINT, &first->samples));
  return buffer;
}

std::string encode_exr(const Film& film, const Imf::Header& header) {
  Imf::StdOSStream stream;
  {
    // OutputFile's destructor writes the line table and hides errors, so it writes to memory; the whole file
    // is written afterwards, with checks.
    Imf::OutputFile file(stream, header);
    for (int row = 0; row < film.size().height; ++row) {
      std::vector<ExrPixel> pixels = exr_pixels(film, row);
      file.setFrameBuffer(one_row(pixels.data()));
      file.writePixels(1);
    }
  }
  return stream.str();
}

}  // namespace

void write_exr(const std::filesystem::path& path, const Film& film,
               const std::map<std::string, std::string>& attributes) {
  write_bytes_atomically(path, encode_exr(film, exr_header(film, attributes)));
}

int srgb_code(double linear) {
  const double clamped = std::clamp(linear, 0.0, 1.0);
  const double encoded =
      clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * std::pow(clamped, 1.0 / 2.4) - 0.055;
  return static_cast<int>(std::lround(255.0 * encoded));
}

void write_png(const std::filesystem::path& path, const Film& film) {
  std::vector<unsigned char> codes;
  codes.reserve(3 * static_cast<std::size_t>(film.pixel_count()));
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    const glm::dvec3 mean = film.mean(pixel);
    for (int channel = 0; channel < 3; ++channel)
      codes.push_back(static_cast<unsigned char>(srgb_code(mean[channel])));
  }

  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(film.size().width);
  image.height = static_cast<png_uint_32>(film.size().height);
  image.format = PNG_FORMAT_RGB;
  const auto encode = [&](void* memory, png_alloc_size_t& bytes) {
    if (png_image_write_to_memory(&image, memory, &bytes, 0, codes.data(), 0, nullptr) == 0) {
      throw RunError(path.string() + ": libpng could not encode it: " + image.message);
    }
  };
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string file(bytes, '\0');
  encode(file.data(), bytes);
  write_bytes_atomically(path, std::string_view(file).substr(0, bytes));
}

}  // namespace testbench
