#include "testbench/gltf/gltf_schema.hpp"

namespace testbench {
namespace gltf_rule_words {

using Kind = GltfType::Kind;
using Container = GltfType::Container;

constexpr bool required = true;
constexpr bool optional = false;
constexpr std::size_t many = std::numeric_limits<std::size_t>::max();
constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr GltfType integer(double least, double most = infinity) {
  return {Kind::integer, "", least, most};
}
constexpr GltfType integer_of(const char* choices) {
  return {Kind::integer, choices};
}
constexpr GltfType number(double least = -infinity, double most = infinity) {
  return {Kind::number, "", least, most};
}
constexpr GltfType positive() {
  return {Kind::number, "", 0.0, infinity, true};
}
constexpr GltfType text() {
  return {Kind::text};
}
constexpr GltfType text_of(const char* choices) {
  return {Kind::text, choices};
}
constexpr GltfType boolean() {
  return {Kind::boolean};
}
constexpr GltfType index(const char* array) {
  return {Kind::index, array};
}
constexpr GltfType object(const char* type) {
  return {Kind::object, type};
}
constexpr GltfType array(std::size_t least, std::size_t most, GltfType of) {
  of.is_array_of_maps = of.container == Container::map;
  of.container = Container::array;
  of.least_length = least;
  of.most_length = most;
  return of;
}
constexpr GltfType map(GltfType of) {
  of.container = Container::map;
  return of;
}

// glTF 2.0, section 5 "Properties Reference", and the extensions' JSON schemas. What a static
// picture of triangles does not need (animations) has no rule: it is never looked at. Cameras, textures,
// lights and what they refer to are checked when they are used. Top-level arrays may be empty, which the
// specification does not allow: exporters write such.
constexpr GltfRule kGltfRules[] = {
    {"glTF", "extensionsUsed", optional, array(0, many, text())},
    {"glTF", "extensionsRequired", optional, array(0, many, text())},
    {"glTF", "accessors", optional, array(0, many, object("accessor"))},
    {"glTF", "animations", optional, array(0, many, object("animation"))},
    {"glTF", "asset", required, object("asset")},
    {"glTF", "buffers", optional, array(0, many, object("buffer"))},
    {"glTF", "bufferViews", optional, array(0, many, object("bufferView"))},
    {"glTF", "cameras", optional, array(0, many, object("unused camera"))},
    {"glTF", "images", optional, array(0, many, object("unused image"))},
    {"glTF", "materials", optional, array(0, many, object("material"))},
    {"glTF", "meshes", optional, array(0, many, object("mesh"))},
    {"glTF", "nodes", optional, array(0, many, object("node"))},
    {"glTF", "samplers", optional, array(0, many, object("unused sampler"))},
    {"glTF", "scene", optional, index("scenes")},
    {"glTF", "scenes", optional, array(0, many, object("scene"))},
    {"glTF", "skins", optional, array(0, many, object("skin"))},
    {"glTF", "textures", optional, array(0, many, object("unused texture"))},

    {"accessor", "bufferView", optional, index("bufferViews")},
    {"accessor", "byteOffset", optional, integer(0)},
    {"accessor", "componentType", required, integer_of("5120 5121 5122 5123 5125 5126")},
    {"accessor", "normalized", optional, boolean()},
    {"accessor", "count", required, integer(1)},
    {"accessor", "type", required, text_of("SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4")},
    {"accessor", "sparse", optional, object("accessor.sparse")},
    {"accessor", "name", optional, text()},

    {"accessor.sparse", "count", required, integer(1)},
    {"accessor.sparse", "indices", required, object("accessor.sparse.indices")},
    {"accessor.sparse", "values", required, object("accessor.sparse.values")},
    {"accessor.sparse.indices", "bufferView", required, index("bufferViews")},
    {"accessor.sparse.indices", "byteOffset", optional, integer(0)},
    {"accessor.sparse.indices", "componentType", required, integer_of("5121 5123 5125")},
    {"accessor.sparse.values", "bufferView", required, index("bufferViews")},
    {"accessor.sparse.values", "byteOffset", optional, integer(0)},

    {"asset", "version", required, text()},
    {"asset", "minVersion", optional, text()},

    {"buffer", "uri", optional, text()},
    {"buffer", "byteLength", required, integer(1)},
    {"buffer", "name", optional, text()},

    {"bufferView", "buffer", required, index("buffers")},
    {"bufferView", "byteOffset", optional, integer(0)},
    {"bufferView", "byteLength", required, integer(1)},
    {"bufferView", "byteStride", optional, integer(4, 252)},
    {"bufferView", "target", optional, integer_of("34962 34963")},
    {"bufferView", "name", optional, text()},
    {"bufferView", "extensions", optional, object("bufferView.extensions")},
    {"bufferView.extensions", "EXT_meshopt_compression", optional, object("EXT_meshopt_compression")},

    {"EXT_meshopt_compression", "buffer", required, index("buffers")},
    {"EXT_meshopt_compression", "byteOffset", optional, integer(0)},
    {"EXT_meshopt_compression", "byteLength", required, integer(1)},
    {"EXT_meshopt_compression", "byteStride", required, integer(1, 256)},
    {"EXT_meshopt_compression", "count", required, integer(1)},
    {"EXT_meshopt_compression", "mode", required, text_of("ATTRIBUTES TRIANGLES INDICES")},
    {"EXT_meshopt_compression", "filter", optional, text_of("NONE OCTAHEDRAL QUATERNION EXPONENTIAL")},

    {"camera", "type", required, text_of("perspective orthographic")},
    {"camera", "perspective", optional, object("camera.perspective")},
    {"camera", "orthographic", optional, object("camera.orthographic")},
    {"camera", "name", optional, text()},
    {"camera.perspective", "aspectRatio", optional, positive()},
    {"camera.perspective", "yfov", required, positive()},
    {"camera.perspective", "zfar", optional, positive()},
    {"camera.perspective", "znear", required, positive()},
    {"camera.orthographic", "xmag", required, positive()},
    {"camera.orthographic", "ymag", required, positive()},
    {"camera.orthographic", "zfar", required, positive()},
    {"camera.orthographic", "znear", required, number(0)},

    {"material", "name", optional, text()},
    {"material", "extensions", optional, object("material.extensions")},
    {"material", "pbrMetallicRoughness", optional, object("material.pbrMetallicRoughness")},
    {"material", "normalTexture", optional, object("normalTextureInfo")},
    {"material", "occlusionTexture", optional, object("textureInfo")},
    {"material", "emissiveTexture", optional, object("textureInfo")},
    {"material", "emissiveFactor", optional, array(3, 3, number(0, 1))},
    {"material", "alphaMode", optional, text_of("OPAQUE MASK BLEND")},
    {"material", "alphaCutoff", optional, number(0)},
    {"material", "doubleSided", optional, boolean()},
    {"material.pbrMetallicRoughness", "baseColorFactor", optional, array(4, 4, number(0, 1))},
    {"material.pbrMetallicRoughness", "baseColorTexture", optional, object("textureInfo")},
    {"material.pbrMetallicRoughness", "metallicFactor", optional, number(0, 1)},
    {"material.pbrMetallicRoughness", "roughnessFactor", optional, number(0, 1)},
    {"material.pbrMetallicRoughness", "metallicRoughnessTexture", optional, object("textureInfo")},
    {"textureInfo", "index", required, index("textures")},
    {"textureInfo", "texCoord", optional, integer(0)},
    {"textureInfo", "extensions", optional, object("textureInfo.extensions")},
    {"normalTextureInfo", "index", required, index("textures")},
    {"normalTextureInfo", "texCoord", optional, integer(0)},
    {"normalTextureInfo", "scale", optional, number()},
    {"normalTextureInfo", "extensions", optional, object("textureInfo.extensions")},
    {"textureInfo.extensions", "KHR_texture_transform", optional, object("KHR_texture_transform")},
    {"KHR_texture_transform", "offset", optional, array(2, 2, number())},
    {"KHR_texture_transform", "rotation", optional, number()},
    {"KHR_texture_transform", "scale", optional, array(2, 2, number())},
    {"KHR_texture_transform", "texCoord", optional, integer(0)},
    {"material.extensions", "KHR_materials_emissive_strength", optional,
     object("KHR_materials_emissive_strength")},
    {"material.extensions", "KHR_materials_pbrSpecularGlossiness", optional,
     object("KHR_materials_pbrSpecularGlossiness")},
    {"material.extensions", "KHR_materials_clearcoat", optional, object("KHR_materials_clearcoat")},
    {"material.extensions", "KHR_materials_ior", optional, object("KHR_materials_ior")},
    {"material.extensions", "KHR_materials_sheen", optional, object("KHR_materials_sheen")},
    {"material.extensions", "KHR_materials_specular", optional, object("KHR_materials_specular")},
    {"material.extensions", "KHR_materials_transmission", optional, object("KHR_materials_transmission")},
    {"material.extensions", "KHR_materials_volume", optional, object("KHR_materials_volume")},
    {"KHR_materials_clearcoat", "clearcoatFactor", optional, number(0, 1)},
    {"KHR_materials_clearcoat", "clearcoatRoughnessFactor", optional, number(0, 1)},
    {"KHR_materials_emissive_strength", "emissiveStrength", optional, number(0)},
    {"KHR_materials_ior", "ior", optional, number(0)},
    {"KHR_materials_pbrSpecularGlossiness", "diffuseFactor", optional, array(4, 4, number(0, 1))},
    {"KHR_materials_pbrSpecularGlossiness", "diffuseTexture", optional, object("textureInfo")},
    {"KHR_materials_pbrSpecularGlossiness", "specularFactor", optional, array(3, 3, number(0, 1))},
    {"KHR_materials_pbrSpecularGlossiness", "glossinessFactor", optional, number(0, 1)},
    {"KHR_materials_pbrSpecularGlossiness", "specularGlossinessTexture", optional, object("textureInfo")},

    {"KHR_materials_sheen", "sheenColorFactor", optional, array(3, 3, number(0, 1))},
    {"KHR_materials_sheen", "sheenRoughnessFactor", optional, number(0, 1)},
    {"KHR_materials_specular", "specularFactor", optional, number(0, 1)},
    {"KHR_materials_specular", "specularColorFactor", optional, array(3, 3, number(0))},
    {"KHR_materials_transmission", "transmissionFactor", optional, number(0, 1)},
    {"KHR_materials_transmission", "transmissionTexture", optional, object("textureInfo")},
    {"KHR_materials_volume", "thicknessFactor", optional, number(0)},
    {"KHR_materials_volume", "attenuationDistance", optional, positive()},
    {"KHR_materials_volume", "attenuationColor", optional, array(3, 3, number(0, 1))},

    {"texture", "sampler", optional, index("samplers")},
    {"texture", "source", optional, index("images")},
    {"sampler", "magFilter", optional, integer_of("9728 9729")},
    {"sampler", "minFilter", optional, integer_of("9728 9729 9984 9985 9986 9987")},
    {"sampler", "wrapS", optional, integer_of("33071 33648 10497")},
    {"sampler", "wrapT", optional, integer_of("33071 33648 10497")},
    {"image", "uri", optional, text()},
    {"image", "mimeType", optional, text_of("image/jpeg image/png")},
    {"image", "bufferView", optional, index("bufferViews")},

    {"node.KHR_lights_punctual", "light", required, integer(0)},
    {"KHR_lights_punctual.light", "type", required, text_of("directional point spot")},
    {"KHR_lights_punctual.light", "name", optional, text()},
    {"KHR_lights_punctual.light", "color", optional, array(3, 3, number(0))},
    {"KHR_lights_punctual.light", "intensity", optional, number(0, 1e30)},
    {"KHR_lights_punctual.light", "range", optional, positive()},
    {"KHR_lights_punctual.light", "spot", optional, object("KHR_lights_punctual.light.spot")},
    {"KHR_lights_punctual.light.spot", "innerConeAngle", optional, number(0, 1.5707963267948966)},
    {"KHR_lights_punctual.light.spot", "outerConeAngle", optional, number(0, 1.5707963267948966)},

    {"mesh", "primitives", required, array(1, many, object("mesh.primitive"))},
    {"mesh", "weights", optional, array(1, many, number())},
    {"mesh", "name", optional, text()},
    {"mesh.primitive", "attributes", required, map(index("accessors"))},
    {"mesh.primitive", "indices", optional, index("accessors")},
    {"mesh.primitive", "material", optional, index("materials")},
    {"mesh.primitive", "mode", optional, integer(0, 6)},
    {"mesh.primitive", "targets", optional, array(1, many, map(index("accessors")))},
    {"mesh.primitive", "extensions", optional, object("mesh.primitive.extensions")},
    {"mesh.primitive.extensions", "KHR_draco_mesh_compression", optional,
     object("KHR_draco_mesh_compression")},
    {"KHR_draco_mesh_compression", "bufferView", required, index("bufferViews")},
    {"KHR_draco_mesh_compression", "attributes", required, map(integer(0, 4294967295.0))},

    {"node", "camera", optional, index("cameras")},
    {"node", "children", optional, array(1, many, index("nodes"))},
    {"node", "skin", optional, index("skins")},
    {"node", "matrix", optional, array(16, 16, number())},
    {"node", "mesh", optional, index("meshes")},
    {"node", "rotation", optional, array(4, 4, number(-1, 1))},
    {"node", "scale", optional, array(3, 3, number())},
    {"node", "translation", optional, array(3, 3, number())},
    {"node", "weights", optional, array(1, many, number())},
    {"node", "name", optional, text()},
    {"node", "extensions", optional, object("node.extensions")},
    {"node.extensions", "EXT_mesh_gpu_instancing", optional, object("EXT_mesh_gpu_instancing")},
    {"EXT_mesh_gpu_instancing", "attributes", required, map(index("accessors"))},

    {"scene", "nodes", optional, array(1, many, index("nodes"))},
    {"scene", "name", optional, text()},

    {"skin", "inverseBindMatrices", optional, index("accessors")},
    {"skin", "skeleton", optional, index("nodes")},
    {"skin", "joints", required, array(1, many, index("nodes"))},
    {"skin", "name", optional, text()},
};

}  // namespace gltf_rule_words

GltfRules gltf_rules() {
  return {gltf_rule_words::kGltfRules, std::size(gltf_rule_words::kGltfRules)};
}

}  // namespace testbench
