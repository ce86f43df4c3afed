#include "testbench/gltf/gltf_document.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>

#include "testbench/files/input_file.hpp"
#include "testbench/gltf/gltf_compression.hpp"
#include "testbench/gltf/gltf_schema.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/nesting.hpp"

namespace testbench {
namespace {

constexpr const char* kGltfFile = "a .gltf or .glb file";

/// Without names that stand twice in an object: which of the two a reader takes is chance.
nlohmann::json parse_gltf_json(const std::string& text, const std::string& file) {
  require_shallow_json(text, file);
  std::vector<std::set<std::string>> names;
  std::string repeated;
  const auto look = [&](int, nlohmann::json::parse_event_t event, nlohmann::json& value) {
    if (event == nlohmann::json::parse_event_t::object_start) names.emplace_back();
    if (event == nlohmann::json::parse_event_t::object_end) names.pop_back();
    if (event == nlohmann::json::parse_event_t::key && !names.back().insert(value.get<std::string>()).second)
      repeated = value.get<std::string>();
    return true;
  };
  nlohmann::json root;
  try {
    root = nlohmann::json::parse(text, look);
  } catch (const nlohmann::json::exception& thrown) {
    fail_in_gltf(file, "", "'" + first_line(thrown.what()) + "'", "a valid glTF 2.0 file");
  }
  if (!repeated.empty()) fail_in_gltf(file, "", "the name '" + repeated + "' twice in an object", "it once");
  if (!root.is_object()) fail_in_gltf(file, "", json_in_message(root), "a JSON object");
  return root;
}

std::uint32_t word_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + offset, sizeof(word));
  return word;
}

/// The numbers before and behind the point of "2.0"; both -1 for another text.
std::pair<int, int> version_of(const std::string& text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.size() != 3 || !is_digit(text[0]) || text[1] != '.' || !is_digit(text[2])) return {-1, -1};
  return {text[0] - '0', text[2] - '0'};
}

std::string decode_base64(std::string text) {
  while (text.size() % 4 != 0) text += '=';
  if (text.size() > std::size_t(std::numeric_limits<int>::max())) return "";
  std::size_t padding = 0;
  while (padding < 2 && padding < text.size() && text[text.size() - 1 - padding] == '=') ++padding;
  std::string bytes(text.size() / 4 * 3, '\0');
  const int length =
      EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                      reinterpret_cast<const unsigned char*>(text.data()), static_cast<int>(text.size()));
  if (length < int(padding)) return "";
  bytes.resize(std::size_t(length) - padding);
  return bytes;
}

bool is_data_uri(const std::string& uri) {
  return uri.compare(0, 5, "data:") == 0;
}

/// RFC 3986, section 2.1; std::nullopt for a % without two hexadecimal digits behind it.
std::optional<std::string> decode_percent(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i];
      continue;
    }
    const std::string digits = text.substr(i + 1, 2);
    if (digits.size() < 2 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos)
      return std::nullopt;
    result += static_cast<char>(std::stoi(digits, nullptr, 16));
    i += 2;
  }
  return result;
}

}  // namespace

GltfDocument::GltfDocument(const std::filesystem::path& file, const FileReach& reach)
    : path_(file), file_(file.string()), reach_(reach) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(file, status)) fail("", "no file that can be read", kGltfFile);
  root_ = parse_gltf_json(json_text(read_input_file(file, kGltfFile)), file_);
  require_version();
  check_gltf(file_, root_, root_, "glTF", "");
  require_supported();
  remember_images();
}

void GltfDocument::remember_images() const {
  const nlohmann::json* const images = find_gltf(root_, "images");
  if (images == nullptr) return;
  for (const nlohmann::json& image : *images) {
    const nlohmann::json* const uri = find_gltf(image, "uri");
    if (uri == nullptr) continue;
    const std::optional<std::string> name = decode_percent(uri->get<std::string>());
    if (name && !is_data_uri(*name)) reach_.remember(path_.parent_path() / *name);
  }
}

/// The JSON of a file: all of a .gltf file, the first chunk of a .glb (glTF 2.0, section 4). Which of
/// them it is, its first four bytes say.
std::string GltfDocument::json_text(std::string bytes) {
  if (bytes.compare(0, 4, "glTF") != 0) return bytes;
  constexpr std::size_t kHeader = 12;
  if (bytes.size() < kHeader || word_at(bytes, 8) != bytes.size())
    fail("", "a binary file of " + std::to_string(bytes.size()) + " bytes",
         "the length that its header tells, a file that is not cut off");
  if (word_at(bytes, 4) != 2)
    fail("", "version " + std::to_string(word_at(bytes, 4)) + " of the binary form", "version 2");
  std::string json;
  std::size_t chunk = 0;
  for (std::size_t at = kHeader; at < bytes.size(); ++chunk) {
    const std::size_t left = bytes.size() - at;
    if (left < 8 || word_at(bytes, at) > left - 8)
      fail("", "chunk " + std::to_string(chunk) + " cut off", "a whole one");
    const std::string content = bytes.substr(at + 8, word_at(bytes, at));
    const std::string type = bytes.substr(at + 4, 4);
    at += 8 + content.size();
    if ((chunk == 0) != (type == "JSON"))
      fail("", chunk == 0 ? "another first chunk" : "a second JSON chunk", "JSON first, and once");
    if (chunk == 0) json = content;
    if (chunk == 1 && type == std::string("BIN\0", 4)) {
      binary_chunk_ = content;
      has_binary_chunk_ = true;
    }
  }
  return json;
}

/// Comes before all other checks, because other versions have other rules.
void GltfDocument::require_version() const {
  const nlohmann::json* const asset = find_gltf(root_, "asset");
  if (asset == nullptr || !asset->is_object())
    fail("/asset", asset == nullptr ? "none" : json_in_message(*asset), "an object");
  check_gltf(file_, root_, *asset, "asset", "/asset");
  const nlohmann::json& version = asset->at("version");
  if (version_of(version.get<std::string>()).first != 2)
    fail("/asset/version", json_in_message(version), "2.0");
  if (const nlohmann::json* least = find_gltf(*asset, "minVersion"))
    if (version_of(least->get<std::string>()) != std::pair(2, 0))
      fail("/asset/minVersion", json_in_message(*least), "2.0");
}

void GltfDocument::require_supported() const {
  const std::vector<std::string> supported = supported_gltf_extensions();
  std::string names;
  for (const std::string& name : supported) names += (names.empty() ? "" : ", ") + name;
  for (const nlohmann::json& name : array("extensionsRequired"))
    if (std::find(supported.begin(), supported.end(), name.get<std::string>()) == supported.end())
      fail("/extensionsRequired", name.get<std::string>() + ", which this program does not support", names);
}

const nlohmann::json& GltfDocument::array(const char* name) const {
  static const nlohmann::json none = nlohmann::json::array();
  const nlohmann::json* const found = find_gltf(root_, name);
  return found == nullptr ? none : *found;
}

const nlohmann::json& GltfDocument::element(const char* array_name, std::size_t index) const {
  return array(array_name).at(index);
}

bool GltfDocument::uses(const std::string& extension) const {
  const nlohmann::json& used = array("extensionsUsed");
  return std::find(used.begin(), used.end(), extension) != used.end();
}

GltfBytes GltfDocument::range(std::size_t index, std::size_t offset, std::size_t length,
                              const std::string& pointer) {
  const std::string& bytes = buffer(index);
  if (offset > bytes.size() || length > bytes.size() - offset)
    fail(pointer, std::to_string(length) + " bytes from " + std::to_string(offset) + ", beyond the end",
         "bytes within the buffer's " + std::to_string(bytes.size()));
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()) + offset, length};
}

GltfBytes GltfDocument::view(std::size_t index) {
  const nlohmann::json& view = element("bufferViews", index);
  const std::string pointer = "/bufferViews/" + std::to_string(index);
  const nlohmann::json* const packed = find_gltf(view, "extensions", "EXT_meshopt_compression");
  if (packed == nullptr)
    return range(view.at("buffer").get<std::size_t>(), size_or(view, "byteOffset", 0),
                 view.at("byteLength").get<std::size_t>(), pointer);
  const auto [entry, is_new] = decompressed_.try_emplace(index);
  if (is_new) {
    const std::string place = pointer + "/extensions/EXT_meshopt_compression";
    entry->second =
        decode_meshopt(*this,
                       range(packed->at("buffer").get<std::size_t>(), size_or(*packed, "byteOffset", 0),
                             packed->at("byteLength").get<std::size_t>(), place),
                       *packed, place);
    if (entry->second.size() < view.at("byteLength").get<std::size_t>())
      fail(pointer + "/byteLength", json_in_message(view["byteLength"]),
           std::to_string(entry->second.size()) + ", what the compressed data holds");
  }
  return {entry->second.data(), entry->second.size()};
}

const std::string& GltfDocument::buffer(std::size_t index) {
  const auto [entry, is_new] = buffers_.try_emplace(index);
  if (!is_new) return entry->second;
  const std::string pointer = "/buffers/" + std::to_string(index);
  const nlohmann::json& source = element("buffers", index);
  std::string bytes = buffer_bytes(source, index, pointer);
  const auto length = source.at("byteLength").get<std::size_t>();
  if (bytes.size() < length)
    fail(pointer, std::to_string(bytes.size()) + " bytes, cut off",
         "the " + std::to_string(length) + " bytes of its byteLength");
  bytes.resize(length);
  return entry->second = std::move(bytes);
}

std::string GltfDocument::buffer_bytes(const nlohmann::json& source, std::size_t index,
                                       const std::string& pointer) {
  const nlohmann::json* const uri = find_gltf(source, "uri");
  if (uri == nullptr) {
    if (index == 0 && has_binary_chunk_) return std::move(binary_chunk_);
    fail(pointer, "no uri", "one, or a .glb file's own binary chunk");
  }
  return uri_bytes(*uri, pointer, "buffer");
}

/// The bytes of a file or of a data URI.
std::string GltfDocument::uri_bytes(const nlohmann::json& uri, const std::string& pointer,
                                    const char* kind) const {
  const std::string text = uri.get<std::string>();
  if (!is_data_uri(text)) {
    const std::filesystem::path file = path_.parent_path() / file_of_uri(text, pointer + "/uri");
    reach_.require(file, file_ + ": " + pointer + "/uri");
    return read_input_file(file, "the " + std::string(kind) + " that " + file_ + " names");
  }
  const std::size_t start = text.find(";base64,");
  std::string bytes = start == std::string::npos ? "" : decode_base64(text.substr(start + 8));
  if (bytes.empty()) fail(pointer + "/uri", json_in_message(uri), "a file, or data:...;base64,...");
  return bytes;
}

std::string GltfDocument::image_name(std::size_t index) const {
  const nlohmann::json& source = element("images", index);
  const std::string pointer = "/images/" + std::to_string(index);
  check(source, "image", pointer);
  const nlohmann::json* const uri = find_gltf(source, "uri");
  if ((uri == nullptr) == !source.contains("bufferView"))
    fail(pointer, uri == nullptr ? "neither uri nor bufferView" : "uri and bufferView", "one of them");
  if (uri == nullptr || is_data_uri(uri->get<std::string>())) return file_ + ": " + pointer;
  const std::filesystem::path file =
      path_.parent_path() / file_of_uri(uri->get<std::string>(), pointer + "/uri");
  return file.lexically_normal().string();
}

std::string GltfDocument::image_bytes(std::size_t index) {
  const nlohmann::json& source = element("images", index);
  if (const nlohmann::json* const uri = find_gltf(source, "uri"))
    return uri_bytes(*uri, "/images/" + std::to_string(index), "image");
  const GltfBytes bytes = view(source.at("bufferView").get<std::size_t>());
  return {reinterpret_cast<const char*>(bytes.data), bytes.size};
}

std::string GltfDocument::file_of_uri(const std::string& uri, const std::string& pointer) const {
  const std::optional<std::string> name = decode_percent(uri);
  const bool has_scheme = uri.find(':') != std::string::npos && uri.find(':') < uri.find('/');
  if (!name || name->empty() || has_scheme || name->find('\0') != std::string::npos)
    fail(pointer, json_in_message(uri), "a file relative to this one, or data:...;base64,...");
  return *name;
}

std::string GltfDocument::named(const char* array_name, const char* kind, std::size_t index) const {
  const nlohmann::json* const name = find_gltf(element(array_name, index), "name");
  return std::string(kind) + " " + std::to_string(index) +
         (name == nullptr ? "" : " '" + name->get<std::string>() + "'");
}

void GltfDocument::check(const nlohmann::json& value, const char* object, const std::string& pointer) const {
  check_gltf(file_, root_, value, object, pointer);
}

void GltfDocument::fail(const std::string& pointer, const std::string& found,
                        const std::string& allowed) const {
  fail_in_gltf(file_, pointer, found, allowed);
}

void GltfDocument::note(const std::string& text, const std::string& pointer, std::size_t count) {
  notes_.add(text, file_ + (pointer.empty() ? "" : ": " + pointer), count);
}

}  // namespace testbench
