#include "testbench/faults/fault_store.hpp"

#include <sstream>

#include "testbench/files/atomic_file.hpp"
#include "testbench/files/input_file.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr const char* kAllowed = "a file of `csx600 inject`";

const Schema& run_schema() {
  static const Schema schema = {{"number", JsonType::count},
                                {"kind", JsonType::text},
                                {"fault", JsonType::text},
                                {"outcome", JsonType::text},
                                {"differing_pixels", JsonType::count},
                                {"largest_difference", JsonType::count},
                                {"extra_cycles", JsonType::number},
                                {"message", JsonType::text}};
  return schema;
}

}  // namespace

FaultStore::FaultStore(const std::filesystem::path& directory, const Json& campaign)
    : path_(directory / "faults.jsonl") {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  require_writable(path_);
  const std::string head = json_text(campaign);
  std::string text = std::filesystem::exists(path_) ? read_input_file(path_, kAllowed) : "";
  text.resize(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  if (text.empty()) text = head + "\n";
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  if (line != head)
    throw InputError(path_.string() +
                     ":1: found another campaign (scene, chip, firmware, kinds, seed or build differ); "
                     "allowed: this one, or another directory (-o)");
  for (std::size_t number = 2; std::getline(lines, line); ++number) take(line, number);
  write_bytes_atomically(path_, text);
  file_.open(path_, std::ios::app);
}

void FaultStore::take(const std::string& line, std::size_t number) {
  Json json = parse_json_object(line, path_.string(), kAllowed, number);
  require_schema(json, run_schema(), line, path_.string(), number);
  const std::uint64_t run = json["number"];
  runs_[run] = std::move(json);
}

void FaultStore::add(const std::string& line) {
  file_ << line << '\n' << std::flush;
  if (!file_) throw RunError(path_.string() + ": cannot be written");
  Json json = Json::parse(line);
  const std::uint64_t run = json["number"];
  runs_[run] = std::move(json);
}

}  // namespace testbench
