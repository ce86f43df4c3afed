#pragma once

#include "firmware/path_tracer/records/features.hpp"
#include "firmware/path_tracer/records/records.hpp"

/// Records that follow others where the scene has use for them. A record and its tail are transferred as one.
namespace path_tracer {

/// Behind a HitRecord: how the ray arrived.
struct ArrivalRecord {
  vec3<double> direction{};  ///< of the ray, unit length
  double distance = 0;
};

/// Behind a SurfaceRecord: a material that is not only diffuse (materials/material.hpp).
struct MaterialRecord {
  double metallic = 0;
  double roughness = 1;  ///< the square root of GGX's width
  double f0 = 0;         ///< of what is not metal: reflectance at normal incidence
  double f90 = 0;        ///< the same at grazing incidence
  double transmission = 0;
  double ior = 1.5;       ///< index of refraction behind the front
  std::int32_t thin = 0;  ///< 1: transmits without refraction
  std::int32_t unused = 0;
};
struct AbsorptionRecord {
  vec3<double> coefficient{};  ///< per unit of length
};
struct CoatRecord {
  double strength = 0;
  double roughness = 0;
};
struct SheenRecord {
  vec3<double> colour{};
  double roughness = 0;
};

/// Behind a SurfaceRecord: the normal of shading, before it is normalised, which is an affine function of the
/// position: at_origin + x along_x + y along_y + z along_z.
struct NormalRecord {
  vec3<double> at_origin{};
  vec3<double> along_x{};
  vec3<double> along_y{};
  vec3<double> along_z{};
};

/// Behind a SurfaceRecord: how likely shadow rays find it.
struct AimRecord {
  double inverse_pdf = 0;  ///< LightRecord::inverse_pdf of the triangle's light; infinity if it is none
};

/// Behind a PathRecord and a ScatterRecord: how likely the segment's direction was.
struct DirectionRecord {
  double pdf = 0;  ///< by solid angle; infinity where no shadow ray competes with the segment
};

/// Places of the tails from the start of their records, in bytes, and sizes of the records with tails.
struct RecordSizes {
  int hit = sizeof(HitRecord);
  int surface = sizeof(SurfaceRecord);
  int scatter = sizeof(ScatterRecord);
  int path = sizeof(PathRecord);

  bool path_has_tail() const { return path > int{sizeof(PathRecord)}; }
  bool hit_has_tail() const { return hit > int{sizeof(HitRecord)}; }

  static constexpr int kNone = 0;
  // In a SurfaceRecord; kNone if the scene has none of it.
  int material = kNone;
  int absorption = kNone;
  int coat = kNone;
  int sheen = kNone;
  int normal = kNone;
  int aim = kNone;

  explicit RecordSizes(const Features& features) {
    if (features.plain()) return;
    hit += int{sizeof(ArrivalRecord)};
    scatter += int{sizeof(DirectionRecord)};
    path += int{sizeof(DirectionRecord)};
    const auto append = [this](bool present, std::size_t bytes) {
      if (!present) return kNone;
      const int place = surface;
      surface += static_cast<int>(bytes);
      return place;
    };
    material = append(features.lobes.specular(), sizeof(MaterialRecord));
    absorption = append(features.lobes.absorption, sizeof(AbsorptionRecord));
    coat = append(features.lobes.coat, sizeof(CoatRecord));
    sheen = append(features.lobes.sheen, sizeof(SheenRecord));
    normal = append(features.normals, sizeof(NormalRecord));
    aim = append(features.multiple_importance, sizeof(AimRecord));
  }
};

}  // namespace path_tracer
