#include "testbench/passes/checkpoint.hpp"

#include <stdexcept>
#include <string_view>

#include "testbench/files/atomic_file.hpp"
#include "testbench/files/input_file.hpp"
#include "testbench/run/run_settings.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/digest.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

// A file is a line of JSON, the film's bytes, and the SHA-256 of both.
constexpr const char* kFormat = "csx600-checkpoint-1";
constexpr std::size_t kDigestDigits = 64;
constexpr const char* kAllowed = "a checkpoint that `csx600 render --checkpoint` of this build wrote";

const Schema& head_schema() {
  static const Schema schema = {
      {"format", JsonType::text},        {"render", JsonType::text},
      {"passes", JsonType::count},       {"segments", JsonType::count},
      {"cpu_seconds", JsonType::number}, {"simulated_seconds", JsonType::number_or_none},
      {"parts", JsonType::list}};
  return schema;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& found,
                         const std::string& allowed = kAllowed) {
  throw InputError(file.string() + ": found " + found + "; allowed: " + allowed);
}

/// The file's content without the digest behind it, which is checked.
std::string checked_content(const std::filesystem::path& file) {
  std::string bytes = read_input_file(file, kAllowed);
  if (bytes.rfind(R"({"format":"csx600-checkpoint-)", 0) != 0) refuse(file, "no checkpoint");
  if (bytes.size() < kDigestDigits) refuse(file, "a checkpoint that was cut off or changed");
  const std::string digest = bytes.substr(bytes.size() - kDigestDigits);
  bytes.resize(bytes.size() - kDigestDigits);
  if (sha256(bytes) != digest) refuse(file, "a checkpoint that was cut off or changed");
  return bytes;
}

}  // namespace

std::string checkpoint_digest(const Scene& scene, const RenderRequest& request, const std::string& identity,
                              int ranks) {
  RunSettings settings;
  settings.scene = request.scene;
  settings.options = request.options;
  Sha256 digest;
  digest.add(json_text({{"identity", identity},
                        {"settings", all_inputs(settings)},
                        {"chip", request.options.chip.preset},
                        {"native", request.native},
                        {"searches_natively", request.options.searches_natively},
                        {"checks_hazards", request.options.check_hazards},
                        {"keeps_variances", request.options.film_sums == FilmSums::means_and_variances},
                        {"film", {scene.film.width, scene.film.height}},
                        {"film_scale", film_scale(scene)},
                        {"ranks", ranks}}));
  const std::vector<std::uint8_t>& image = request.options.image->bytes;
  digest.add({reinterpret_cast<const char*>(image.data()), image.size()});
  return digest.finish();
}

void write_checkpoint(const std::filesystem::path& file, const PassSums& sums, const std::string& digest) {
  const Json head = {{"format", kFormat},
                     {"render", digest},
                     {"passes", sums.passes},
                     {"segments", sums.segments},
                     {"cpu_seconds", sums.cpu_seconds},
                     {"simulated_seconds", sums.simulated_seconds ? Json(*sums.simulated_seconds) : Json()},
                     {"parts", sums.parts}};
  std::string bytes = json_text(head) + "\n" + sums.film.bytes();
  bytes += sha256(bytes);
  replace_durably(file, bytes);
}

PassSums read_checkpoint(const std::filesystem::path& file, const Scene& scene, FilmSums sums,
                         const std::string& digest) {
  const std::string bytes = checked_content(file);
  const std::size_t end = bytes.find('\n');
  if (end == std::string::npos) refuse(file, "a checkpoint without a film");
  const std::string line = bytes.substr(0, end);
  Json head = parse_json_object(line, file.string(), kAllowed);
  require_schema(head, head_schema(), line, file.string());
  if (head["format"] != kFormat)
    refuse(file, "format '" + head["format"].get<std::string>() + "'", std::string("'") + kFormat + "'");
  if (head["render"] != digest)
    refuse(file, "a checkpoint of another render",
           "one of the same scene, options, number of ranks and build of csx600");
  try {
    PassSums read{Film::from_bytes(scene.film, film_scale(scene), sums, bytes.substr(end + 1))};
    read.passes = head["passes"].get<int>();
    read.segments = head["segments"].get<std::uint64_t>();
    read.cpu_seconds = head["cpu_seconds"].get<double>();
    if (head["simulated_seconds"].is_number())
      read.simulated_seconds = head["simulated_seconds"].get<double>();
    read.parts = std::move(head["parts"]);
    return read;
  } catch (const std::invalid_argument&) {
    refuse(file, "the film of another render");
  }
}

}  // namespace testbench
