#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "testbench/gltf/gltf_compression.hpp"
#include "testbench/gltf/gltf_document.hpp"

namespace testbench {

/// The component types of an accessor (glTF 2.0, section 3.6.2.2).
enum class GltfComponent { i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126 };

/// What an accessor may be for a certain use.
struct GltfForm {
  std::initializer_list<const char*> types;             ///< "VEC3"
  std::initializer_list<GltfComponent> normalized;      ///< component types, when they are normalized
  std::initializer_list<GltfComponent> not_normalized;  ///< and when they are not
};

/// The elements of one accessor, dense, sparse or both, as numbers; normalized integers as fractions. Throws
/// InputError, which names `where` in the file, for one that reaches beyond its buffer view or has another
/// form.
GltfNumbers read_gltf_accessor(GltfDocument& document, std::size_t index, const GltfForm& form,
                               const std::string& where);

/// The same of unsigned integers below `limit`.
std::vector<std::uint32_t> read_gltf_indices(GltfDocument& document, std::size_t accessor, std::size_t limit,
                                             const std::string& where);

/// Turns integers into fractions if the accessor says normalized (glTF 2.0, section 3.6.2.2).
void normalize_gltf_numbers(const nlohmann::json& accessor, GltfNumbers& numbers);

/// Throws InputError if the accessor has another form than `form`.
void require_gltf_form(const GltfDocument& document, const nlohmann::json& accessor, const GltfForm& form,
                       const std::string& where);

}  // namespace testbench
