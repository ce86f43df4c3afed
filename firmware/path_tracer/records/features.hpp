#pragma once

/// What a scene needs of the path tracer. The firmware is built for its scene: the host derives the features
/// before the run, and what is absent costs no instruction, no byte of a transfer, no SRAM and no random
/// number.
namespace path_tracer {

/// Ways in which surfaces of a scene scatter light beside diffuse reflection.
struct Lobes {
  bool glossy = false;       ///< reflection by a rough surface (microfacets)
  bool mirror = false;       ///< reflection by a smooth one
  bool glass = false;        ///< reflection and refraction by a smooth surface
  bool rough_glass = false;  ///< the same by a rough one
  bool coat = false;         ///< a clear layer above
  bool sheen = false;        ///< fibres above
  bool absorption = false;   ///< light fades within the volume that the surface bounds

  bool any() const { return glossy || mirror || glass || rough_glass || coat || sheen || absorption; }
  bool transmits() const { return glass || rough_glass; }
};

struct Features {
  Lobes lobes;
  bool lights = true;        ///< triangles that emit, to aim shadow rays at
  bool environment = false;  ///< light that arrives from outside
  /// Shadow rays and hits of lights are weighed against each other.
  bool multiple_importance = false;

  /// Whether surfaces are diffuse, and light comes from triangles and arrives by shadow rays or by hits.
  bool plain() const { return !lobes.any() && !environment && !multiple_importance; }
};

}  // namespace path_tracer
