#pragma once

#include "firmware/path_tracer/records/tails.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

path_tracer::MaterialRecord material_record(const Material& material);

/// The colour of varnish's reflection; all 1 for a grey one.
path_tracer::VarnishTintRecord varnish_tint_record(const Material& material);
bool has_varnish_tint(const Material& material);

/// The colour of what passes, where it is not the base colour.
path_tracer::TransmissionTintRecord transmission_tint_record(const Material& material);
bool has_transmission_tint(const Material& material);

}  // namespace testbench
