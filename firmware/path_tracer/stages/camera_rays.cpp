#include "firmware/path_tracer/stages/camera_rays.hpp"

namespace path_tracer {

CameraRays::CameraRays(const Work& work, int pixels)
    : total_(work.listed_samples > 0 ? work.listed_samples
                                     : std::uint64_t(work.samples) * std::uint64_t(pixels)),
      first_sample_(work.first_sample),
      pixels_(pixels) {}

}  // namespace path_tracer
