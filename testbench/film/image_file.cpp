#include "testbench/film/image_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <stdexcept>

#include "testbench/files/atomic_file.hpp"
#include "testbench/files/checked_file.hpp"
#include "testbench/files/input_file.hpp"
#include "testbench/film/film_size.hpp"
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

namespace {

/// Reads three float channels of an open file, interleaved.
std::vector<float> read_channels(Imf::InputFile& file, const char* const (&names)[3],
                                 const std::filesystem::path& path) {
  const Imath::Box2i window = file.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
  const auto height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
  std::vector<float> values(3 * width * height);
  Imf::FrameBuffer buffer;
  // Chunks that the file does not hold leave NaN behind, which is refused below.
  std::fill(values.begin(), values.end(), std::numeric_limits<float>::quiet_NaN());
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

/// The first header of a file. Imf::InputFile would take memory for the lines that it announces.
Imf::Header read_header(const std::filesystem::path& path) {
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

/// Throws InputError for an image that is larger than a film may be, before memory is taken for its pixels: a
/// header of a few bytes can ask for any size.
void require_film_size(const Imf::Header& header, const std::filesystem::path& path) {
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  const auto allowed = [](std::int64_t side) { return side >= 1 && side <= kMaxFilmSide; };
  if (!allowed(width) || !allowed(height))
    throw InputError(path.string() + ": dataWindow: found " + std::to_string(width) + "x" +
                     std::to_string(height) + " pixels; allowed: " + allowed_film_size());
}

/// What compression can make of a pixel at most: zlib expands by a factor below 1032, and a whole chunk of
/// pixels is behind each entry of the line table, so a file holds at least a byte for each 1032 of its
/// pixels'.
void require_pixels_in_file(const Imf::Header& header, const std::filesystem::path& path) {
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

/// Calls `read` with the open file. Errors become InputError that name the file.
template <class Read>
auto read_exr(const std::filesystem::path& path, Read&& read) {
  try {
    require_input_file(path, "an OpenEXR file with channels R, G and B");
    const Imf::Header header = read_header(path);
    require_film_size(header, path);
    require_pixels_in_file(header, path);
    Imf::InputFile file(path.c_str());
    return read(file);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    const std::string what = error.what();
    throw InputError(path.string() + ": cannot be read (" + what.substr(0, what.find('\n')) +
                     "); allowed: an OpenEXR file with channels R, G and B");
  }
}

template <class Image>
void read_size(const Imf::InputFile& file, Image& image) {
  const Imath::Box2i window = file.header().dataWindow();
  image.width = window.max.x - window.min.x + 1;
  image.height = window.max.y - window.min.y + 1;
}

}  // namespace

ExrImage read_exr_rgb(const std::filesystem::path& path) {
  return read_exr(path, [&](Imf::InputFile& file) {
    ExrImage image;
    read_size(file, image);
    image.rgb = read_channels(file, kMeanChannels, path);
    return image;
  });
}

ExrFilm read_exr_film(const std::filesystem::path& path) {
  return read_exr(path, [&](Imf::InputFile& file) {
    ExrFilm film;
    read_size(file, film);
    film.rgb = read_channels(file, kMeanChannels, path);
    film.variance = read_channels(file, kVarianceChannels, path);
    for (auto entry = file.header().begin(); entry != file.header().end(); ++entry)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&entry.attribute()))
        film.attributes[entry.name()] = text->value();
    return film;
  });
}

}  // namespace testbench
