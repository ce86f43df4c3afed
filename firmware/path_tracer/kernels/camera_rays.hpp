#pragma once

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/sampling/sampler.hpp"

/// Camera rays, where every path begins. The path stage generates one in the slot of each path that ended
/// (kernel `continue_paths`).
namespace path_tracer {

/// A sample of a pixel.
struct CameraSample {
  poly<std::int32_t> pixel;
  poly<std::int32_t> sample;
};

struct CameraRay {
  Point3 origin;
  Direction3 direction;  ///< of unit length
};

/// number * stride modulo the number of pixels. Products below 2^53 are exact, and the quotient by
/// multiplication is at most one off.
inline poly<std::int32_t> strided_pixel(const poly<std::int32_t>& number, int stride, std::int32_t pixels) {
  const poly<double> place = cn::convert<double>(number) * double(stride);
  const poly<double> rounds = cn::convert<double>(cn::convert<std::int32_t>(place * (1.0 / pixels)));
  const poly<double> rest = place - rounds * double(pixels);
  const poly<double> above = cn::select(rest < 0.0, rest + double(pixels), rest);
  return cn::convert<std::int32_t>(cn::select(above >= double(pixels), above - double(pixels), above));
}

/// The pixel and sample of the camera ray with that number.
inline CameraSample camera_sample(const CameraRecord& camera, const CameraRayOrder& order,
                                  const poly<std::int32_t>& number) {
  const std::int32_t pixels = camera.width * camera.height;
  poly<std::int32_t> pixel = number + order.next_pixel;
  poly<std::int32_t> sample = order.next_sample;
  cn::poly_while([&] { return pixel >= pixels; },
                 [&] {
                   pixel -= pixels;
                   sample += 1;
                 });
  if (order.pixel_stride != 1) pixel = strided_pixel(pixel, order.pixel_stride, pixels);
  return {pixel, sample};
}

/// The ray through point (u, v) of the pixel. Uniform numbers make the film's filter a box one pixel wide.
inline CameraRay sample_camera(const CameraRecord& camera, const poly<std::int32_t>& pixel,
                               const poly<double>& u, const poly<double>& v) {
  // PEs cannot divide integers. At half a pixel from the quotient's integers, the truncated product is exact.
  const poly<double> row_position = (cn::convert<double>(pixel) + 0.5) * (1.0 / camera.width);
  const poly<std::int32_t> row = cn::convert<std::int32_t>(row_position);
  const poly<std::int32_t> column = pixel - row * camera.width;
  const poly<double> x = cn::convert<double>(column) + u;
  const poly<double> y = cn::convert<double>(row) + v;
  const vec3<poly<double>> on_film = camera.right * x + camera.down * y;
  if (camera.is_orthographic != 0) {
    const Direction3 direction{camera.direction.x, camera.direction.y, camera.direction.z};
    return {on_film + camera.position, direction};
  }
  const Direction3 through = on_film + camera.direction;
  const Point3 origin{camera.position.x, camera.position.y, camera.position.z};
  return {origin, normalize(through, through)};
}

/// The camera ray of a sample, through a random point of its pixel.
inline CameraRay generate_camera_ray(const CameraRecord& camera, Sampler sampler, std::uint64_t seed,
                                     const CameraSample& at) {
  const UniformPair in_pixel = camera_numbers(sampler, seed, at.pixel, at.sample);
  return sample_camera(camera, at.pixel, in_pixel.u, in_pixel.v);
}

}  // namespace path_tracer
