#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace testbench {

/// The finished points of a sweep in a file, a line of JSON each, which is written as soon as its point has
/// finished: a sweep that was killed goes on from there. What a kill or a full disk cut off is dropped.
///
/// One process at a time has the file; the first line says which build of the program wrote it, and of
/// the firmware that it ran, as another one's results may differ.
class PointStore {
 public:
  using Json = nlohmann::ordered_json;

  /// Opens or creates DIRECTORY/points.jsonl. Throws InputError when it cannot be written, another sweep has
  /// it, or it is of another build.
  PointStore(const std::filesystem::path& directory, const std::string& build);
  ~PointStore();
  PointStore(const PointStore&) = delete;
  PointStore& operator=(const PointStore&) = delete;

  /// nullptr for a point that has not finished.
  const Json* find(const std::string& id) const;
  /// Throws RunError, with the file as it was, when the disk does not take the whole line.
  void add(const std::string& id, Json result);
  /// Forgets a point that is to be run again. Its line stays in the file; the later one counts.
  void forget(const std::string& id) { points_.erase(id); }

  const std::filesystem::path& path() const { return path_; }

 private:
  void lock();
  void read();
  void append(const std::string& line);
  void take_line(const std::string& line, std::size_t number, const std::string& build);

  std::filesystem::path path_;
  std::string build_;
  int descriptor_ = -1;
  std::map<std::string, Json> points_;
};

/// Names this build of the program, and of the firmwares outside it that it runs: a digest of their files.
std::string build_digest(const std::string& firmware_builds);

}  // namespace testbench
