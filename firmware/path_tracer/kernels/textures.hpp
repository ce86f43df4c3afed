#pragma once

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/kernels/places.hpp"
#include "firmware/path_tracer/materials/material.hpp"
#include "firmware/path_tracer/records/texel_value.hpp"

/// Textures: which texels a hit needs, and what they show. Testbench and tests have the same in plain C++
/// (testbench/texture/sample.hpp).
namespace path_tracer {

namespace texture_detail {

/// Rounds to the next lower integer. @param a of a magnitude below 2^51
inline poly<double> floor(const poly<double>& a) {
  constexpr double kNoFraction = 0x1.8p52;  // doubles of this size are integers
  const poly<double> nearest = (a + kNoFraction) - kNoFraction;
  return cn::select(nearest > a, nearest - 1.0, nearest);
}

struct TexelPlace {
  poly<double> texel;  ///< the left or upper one
  poly<double> share;  ///< of its neighbour, in [0, 1]
};

/// Wraps a place along an axis into the image. The image that repeats and turns round has, beyond its middle,
/// the same texels from right to left. Where it turns round, and where an edge goes on for ever, a filter
/// sees the outermost texel twice, so that it alone counts.
/// @param place of the left texel's centre, plus the share of the right one
inline TexelPlace wrap(const poly<double>& place, const poly<double>& size, const poly<std::int32_t>& wrap) {
  const mask mirrors = wrap == poly<std::int32_t>(std::int32_t(TextureWrap::mirrored_repeat));
  const mask clamps = wrap == poly<std::int32_t>(std::int32_t(TextureWrap::clamp_to_edge));
  const poly<double> period = cn::select(mirrors, size + size, size);
  const poly<double> rest = place - floor(place / period) * period;
  const poly<double> not_below =
      cn::select(rest < 0.0, rest + period, rest);  // where the quotient is rounded
  const poly<double> repeated = cn::select(not_below >= period, not_below - period, not_below);
  const poly<double> last = size - 1.0;
  const poly<double> mirrored = cn::select(repeated > size - 0.5, (size + last) - repeated, repeated);
  const poly<double> wrapped = cn::select(clamps, place, cn::select(mirrors, mirrored, repeated));
  // Whatever the place is, even no number, the texel is one of the image's.
  const poly<double> inside =
      cn::max(poly<double>(0.0), cn::min(cn::select(mirrors | clamps, last, size), wrapped));
  const poly<double> texel = cn::min(floor(inside), last);
  return {texel, inside - texel};
}

inline poly<double> code_of(const poly<std::uint32_t>& footprint, int texel) {
  return cn::convert<double>((footprint >> (8 * texel)) & poly<std::uint32_t>(0xffu));
}

inline poly<double> mix(const poly<double>& a, const poly<double>& b, const poly<double>& share_of_b) {
  return a + (b - a) * share_of_b;
}

struct Shares {
  poly<double> right;
  poly<double> lower;
};

/// Filters what `value` makes of the codes of four texels.
template <class Value>
poly<double> filter(const poly<std::uint32_t>& footprint, const Shares& shares, const Value& value) {
  const poly<double> upper = mix(value(code_of(footprint, 0)), value(code_of(footprint, 1)), shares.right);
  const poly<double> lower = mix(value(code_of(footprint, 2)), value(code_of(footprint, 3)), shares.right);
  return mix(upper, lower, shares.lower);
}

}  // namespace texture_detail

/// Finds the texels around the hit.
inline void look_up(const LookUpArguments& arguments) {
  using namespace texture_detail;
  const PolyPointer<TextureRecord>& texture = arguments.texture;
  const Point3 position = arguments.hit.get(&HitRecord::position);
  const poly<double> x =
      texture.get(&TextureRecord::x_at_origin) + dot(texture.get(&TextureRecord::x_along), position);
  const poly<double> y =
      texture.get(&TextureRecord::y_at_origin) + dot(texture.get(&TextureRecord::y_along), position);
  const poly<double> width = cn::convert<double>(texture.get(&TextureRecord::width));
  const poly<double> height = cn::convert<double>(texture.get(&TextureRecord::height));
  const mask is_linear = texture.get(&TextureRecord::is_linear) != 0;
  // Centres of texels lie at halves.
  const TexelPlace column =
      wrap(cn::select(is_linear, x - 0.5, floor(x)), width, texture.get(&TextureRecord::wrap_x));
  const TexelPlace row =
      wrap(cn::select(is_linear, y - 0.5, floor(y)), height, texture.get(&TextureRecord::wrap_y));
  const poly<std::int32_t> texel = cn::convert<std::int32_t>(row.texel * width + column.texel);
  const poly<MonoAddress> footprints = texture.get(&TextureRecord::footprints);
  arguments.look_up.field(&TextureLookUp::place)
      .write(place_of(MonoAddress{0}, texel, std::size_t(arguments.footprint_bytes)) + footprints);
  arguments.look_up.set(&TextureLookUp::right_share, column.share);
  arguments.look_up.set(&TextureLookUp::lower_share, row.share);
  cn::keep(footprints != poly<MonoAddress>(MonoAddress{0}), *arguments.needs);
}

/// What the textures at a hit multiply.
class TexturesAtHit {
 public:
  /// @param look_ups RecordSizes::look_ups
  TexturesAtHit(const PolyPointer<SurfaceRecord>& surface, const RecordSizes& sizes,
                const PolyPointer<TextureLookUp>& look_ups)
      : surface_(surface), sizes_(sizes), look_ups_(look_ups) {}

  /// The factor of a slot with one channel; 1 where the triangle has no such texture.
  poly<double> channel(TextureSlot slot) const { return channel(slot, &ChannelFootprint::channel); }
  /// The factor of roughness where it is looked up with metallic.
  poly<double> roughness_with_metallic() const {
    return channel(TextureSlot::metallic, &ChannelFootprint::roughness);
  }

  /// The factor of a slot that is_colour().
  Rgb colour(TextureSlot slot) const { return three_channels(slot, linear_of_srgb<poly<double>>); }
  /// The three channels of another slot, in [0, 1]; 1 where the triangle has no such texture.
  Rgb linear(TextureSlot slot) const { return three_channels(slot, value_of_code<poly<double>>); }

 private:
  template <class Value>
  Rgb three_channels(TextureSlot slot, const Value& value) const {
    const poly<double> one = 1.0;
    if (!sizes_.has_texture(slot)) return {one, one, one};
    const auto footprint = tail<ColourFootprint>(look_up_of(slot));
    const texture_detail::Shares of_texels = shares(slot);
    const auto filtered = [&](std::uint32_t ColourFootprint::*channel) {
      return texture_detail::filter(footprint.get(channel), of_texels, value);
    };
    const Rgb shown{filtered(&ColourFootprint::red), filtered(&ColourFootprint::green),
                    filtered(&ColourFootprint::blue)};
    return cn::select(has_texture(slot), shown, Rgb{one, one, one});
  }
  poly<double> channel(TextureSlot slot, TexelFootprint ChannelFootprint::*part) const {
    if (!sizes_.has_texture(slot)) return 1.0;
    const auto footprint = tail<ChannelFootprint>(look_up_of(slot)).get(part);
    const auto keep_code = [](const poly<double>& code) { return code; };
    const poly<double> value = value_of_code(texture_detail::filter(footprint, shares(slot), keep_code));
    return cn::select(has_texture(slot), value, poly<double>(1.0));
  }
  PolyPointer<TextureLookUp> look_up_of(TextureSlot slot) const {
    return tail<TextureLookUp>(look_ups_, sizes_.look_up[int(slot)]);
  }
  texture_detail::Shares shares(TextureSlot slot) const {
    return {look_up_of(slot).get(&TextureLookUp::right_share),
            look_up_of(slot).get(&TextureLookUp::lower_share)};
  }
  mask has_texture(TextureSlot slot) const {
    const auto record = tail<TextureRecord>(surface_, sizes_.texture[int(slot)]);
    return record.get(&TextureRecord::footprints) != poly<MonoAddress>(MonoAddress{0});
  }

  PolyPointer<SurfaceRecord> surface_;
  const RecordSizes& sizes_;
  PolyPointer<TextureLookUp> look_ups_;
};

/// The radiance that the surface emits from its front.
inline Rgb emission_at_hit(const PolyPointer<SurfaceRecord>& surface, const RecordSizes& sizes,
                           const PolyPointer<TextureLookUp>& look_ups) {
  const Rgb emission = surface.get(&SurfaceRecord::emission);
  if (!sizes.has_texture(TextureSlot::emission)) return emission;
  return emission * TexturesAtHit(surface, sizes, look_ups).colour(TextureSlot::emission);
}

}  // namespace path_tracer
