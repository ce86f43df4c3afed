#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace testbench {

/// The finished runs of a campaign: a file with a line that says which campaign it is, then one for each run,
/// written as soon as it is over.
class FaultStore {
 public:
  using Json = nlohmann::ordered_json;

  /// Opens or makes directory/faults.jsonl. A last line that was cut off is made anew. Throws InputError if
  /// it cannot be written or holds another campaign.
  FaultStore(const std::filesystem::path& directory, const Json& campaign);

  bool has(std::uint64_t number) const { return runs_.count(number) > 0; }
  /// A line as fault_campaign.cpp makes it. Throws RunError if it cannot be written.
  void add(const std::string& line);
  /// By number.
  const std::map<std::uint64_t, Json>& runs() const { return runs_; }

 private:
  void take(const std::string& line, std::size_t number);

  std::filesystem::path path_;
  std::ofstream file_;
  std::map<std::uint64_t, Json> runs_;
};

}  // namespace testbench
