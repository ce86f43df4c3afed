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
#include "testbench/files/checked_file.hpp"
#include "testbench/film/film_size.hpp"
#include "testbench/system/error.hpp"
#include "testbench/texture/exr_file.hpp"

namespace testbench {
namespace {

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

ExrLimits film_limits() {
  return {kMaxFilmSide, std::size_t{kMaxFilmSide} * kMaxFilmSide, allowed_film_size()};
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
    header.channels().insert(kExrColour[channel], Imf::Channel(Imf::FLOAT));
    header.channels().insert(kVarianceChannels[channel], Imf::Channel(Imf::FLOAT));
  }
  header.channels().insert(kSamplesChannel, Imf::Channel(Imf::UINT));
  return header;
}

bool has_variance(const ExrFile& file) {
  const ExrFile::ChannelNames names = file.channel_names();
  return std::all_of(std::begin(kVarianceChannels), std::end(kVarianceChannels), [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  });
}

/// Where OpenEXR finds the channels of one row: every row lies at the same place, so its byte stride is 0.
Imf::FrameBuffer one_row(ExrPixel* first) {
  const auto slice = [](Imf::PixelType type, auto* element) {
    return Imf::Slice(type, reinterpret_cast<char*>(element), sizeof(ExrPixel), 0);
  };
  Imf::FrameBuffer buffer;
  for (int channel = 0; channel < 3; ++channel) {
    buffer.insert(kExrColour[channel], slice(Imf::FLOAT, &first->mean[channel]));
    buffer.insert(kVarianceChannels[channel], slice(Imf::FLOAT, &first->variance[channel]));
  }
  buffer.insert(kSamplesChannel, slice(Imf::UINT, &first->samples));
  return buffer;
}

/// OpenEXR writes through it. OutputFile's destructor writes the line table and hides errors, so that the
/// file keeps them.
class ExrStream : public Imf::OStream {
 public:
  ExrStream(CheckedFile& file, const std::filesystem::path& target)
      : Imf::OStream(target.c_str()), file_(file) {}

  void write(const char bytes[], int count) override {
    if (!file_.write(bytes, std::size_t(count))) throw std::runtime_error("the file cannot be written");
  }
  std::uint64_t tellp() override { return file_.place(); }
  void seekp(std::uint64_t place) override { file_.seek(place); }

 private:
  CheckedFile& file_;
};

/// Row by row: of a large film a copy takes more memory than the machine may have.
void write_rows(const Film& film, const Imf::Header& header, ExrStream& stream) {
  Imf::OutputFile file(stream, header);
  for (int row = 0; row < film.size().height; ++row) {
    std::vector<ExrPixel> pixels = exr_pixels(film, row);
    file.setFrameBuffer(one_row(pixels.data()));
    file.writePixels(1);
  }
}

}  // namespace

void write_exr(const std::filesystem::path& path, const Film& film,
               const std::map<std::string, std::string>& attributes) {
  const Imf::Header header = exr_header(film, attributes);
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    CheckedFile file(temporary, path);
    ExrStream stream(file, path);
    try {
      write_rows(film, header, stream);
    } catch (const std::exception&) {
      file.finish();  // says why, if it is the file
      throw;
    }
    file.finish();
  });
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
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    CheckedFile file(temporary, path);
    const bool is_written = file.stream() != nullptr &&
                            png_image_write_to_stdio(&image, file.stream(), 0, codes.data(), 0, nullptr) != 0;
    file.finish();
    if (!is_written) throw RunError(path.string() + ": libpng could not encode it: " + image.message);
  });
}

RadianceImage read_exr_rgb(const std::filesystem::path& path) {
  return read_exr_rgb(path, film_limits());
}

ExrFilm read_exr_film(const std::filesystem::path& path) {
  const ExrFile file(path, film_limits());
  ExrFilm film;
  film.width = file.size().x;
  film.height = file.size().y;
  film.rgb = file.channels({std::begin(kExrColour), std::end(kExrColour)});
  film.variance = has_variance(file)
                      ? file.channels({std::begin(kVarianceChannels), std::end(kVarianceChannels)})
                      : std::vector<float>(film.rgb.size(), 0.0F);
  film.attributes = file.texts();
  return film;
}

}  // namespace testbench
