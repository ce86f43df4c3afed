#pragma once

#include "firmware/cn/language/kernel.hpp"
#include "firmware/cn/language/shortcut.hpp"
#include "firmware/path_tracer/materials/lobe_use.hpp"
#include "firmware/path_tracer/materials/prepare_bsdf.hpp"

namespace path_tracer {

namespace bsdf_detail {

/// Where the material has the lobe of this row of kLobeTable, which the program has.
inline mask has_lobe(const Bsdf& bsdf, bool Lobes::*lobe, const mask& front) {
  const Lobes& lobes = bsdf.config.lobes;
  const Material& material = bsdf.material;
  const SpecularBase& base = bsdf.terms.specular;
  const mask all(cn::mask_from_bits(0xff));
  const auto transmits = [&] { return base.transmissive > 0.0; };
  const auto thin = [&] { return lobes.thin_glass ? material.thin : mask(cn::mask_from_bits(0)); };
  if (lobe == &Lobes::diffuse) {
    if (!lobes.specular()) return all;
    const BaseShares shares = base_shares(lobes, material);
    return shares.opaque > 0.0;
  }
  if (lobe == &Lobes::glossy) return (base.f90 > 0.0) & (base.alpha > 0.0);
  if (lobe == &Lobes::mirror) return (base.f90 > 0.0) & (base.alpha == 0.0);
  if (lobe == &Lobes::glass) return transmits() & (base.alpha == 0.0);
  if (lobe == &Lobes::rough_glass) return transmits() & (base.alpha > 0.0);
  if (lobe == &Lobes::thin_glass) return transmits() & thin();
  if (lobe == &Lobes::coat) return material.coat > 0.0;
  if (lobe == &Lobes::sheen) return largest_channel(material.sheen_color) > 0.0;
  return transmits() & !thin() & !front;  // absorption, on the way out
}

/// Where a PE asks for a part that is skipped unless some do: the conditions of unless_absent().
inline mask asks_for(const Bsdf& bsdf, LobePart part) {
  if (part == LobePart::facets) return bsdf.terms.specular.is_present(bsdf.config.lobes);
  if (part == LobePart::coat) return bsdf.material.coat > 0.0;
  return largest_channel(bsdf.material.sheen_color) > 0.0;
}

}  // namespace bsdf_detail

/// Notes which PEs use which lobes; nothing is charged.
/// @param scatters PEs at a hit that reflects or transmits
inline void observe_lobes(const Bsdf& bsdf, const mask& front, const mask& scatters, LobeUse& use) {
  const Lobes& lobes = bsdf.config.lobes;
  cn::without_charging([&] {
    for (std::size_t i = 0; i < kLobeTable.size(); ++i)
      if (lobes.*kLobeTable[i].member && kLobeTable[i].part != LobePart::none)
        cn::keep(scatters & bsdf_detail::has_lobe(bsdf, kLobeTable[i].member, front), use.wanted[i]);
    const auto ask = [&](LobePart part) {
      cn::keep(bsdf_detail::asks_for(bsdf, part), use.asked[std::size_t(part)]);
    };
    if (lobes.specular()) ask(LobePart::facets);
    if (lobes.coat) ask(LobePart::coat);
    if (lobes.sheen) ask(LobePart::sheen);
  });
}

}  // namespace path_tracer
