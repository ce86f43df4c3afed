#pragma once

#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <new>
#include <string>
#include <vector>

#include "testbench/system/error.hpp"
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

/// Throws InputError for a file that is no OpenEXR file, is larger than the limits, or holds fewer bytes than
/// its pixels need: a header of a few bytes can ask for any memory.
void require_exr(const std::filesystem::path& path, const ExrLimits& limits);

/// Width and height of an open file, in pixels.
glm::ivec2 exr_size(const Imf::InputFile& file);

/// Reads three float channels of an open file, interleaved, the top row first. Throws InputError if one is
/// missing or a value is not finite.
std::vector<float> read_exr_channels(Imf::InputFile& file, const char* const (&names)[3],
                                     const std::filesystem::path& path);

/// Calls `read` with the open file, after require_exr(). Errors become InputError that name the file.
template <class Read>
auto read_exr(const std::filesystem::path& path, const ExrLimits& limits, Read&& read) {
  try {
    require_exr(path, limits);
    Imf::InputFile file(path.c_str());
    return read(file);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(path.string() + ": cannot be read (" + first_line(error.what()) +
                     "); allowed: an OpenEXR file with channels R, G and B");
  }
}

/// Reads channels R, G and B of an OpenEXR file. Throws InputError if it cannot be read or a channel is
/// missing.
RadianceImage read_exr_rgb(const std::filesystem::path& path, const ExrLimits& limits);

}  // namespace testbench
