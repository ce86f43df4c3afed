#include "firmware/path_tracer/stages/camera_rays.hpp"

#include <numeric>
#include <string>

#include "firmware/path_tracer/program/program_config.hpp"

namespace path_tracer {

CameraRays::CameraRays(const Work& work, int pixels)
    : total_(work.listed_samples > 0 ? work.listed_samples
                                     : std::uint64_t(work.samples) * std::uint64_t(pixels)),
      first_sample_(work.first_sample),
      pixels_(pixels) {}

void require_pixel_stride(int stride, int pixels) {
  if (pixels > 1 && std::gcd(stride, pixels) != 1)
    throw ProgramError("pixel stride: found " + std::to_string(stride) +
                       ", which has a divisor in common with the " + std::to_string(pixels) +
                       " pixels of the film; allowed is any number without");
}

}  // namespace path_tracer
