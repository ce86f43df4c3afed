#include "testbench/sweep/point_store.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>

#include "testbench/files/input_file.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/digest.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

constexpr const char* kFormat = "csx600-sweep-points-2";

constexpr const char* kAllowed = "a file that `csx600 sweep` wrote";

const Schema& head_schema() {
  static const Schema schema = {{"format", JsonType::text}, {"build", JsonType::text}};
  return schema;
}

const Schema& point_schema() {
  static const Schema schema = {
      {"id", JsonType::text}, {"inputs.*", JsonType::scalar, false}, {"status", JsonType::text}};
  return schema;
}

const Schema& done_schema() {
  static const Schema schema = {{"how", JsonType::text},
                                {"audited", JsonType::flag},
                                {"simulator_cpu_seconds", JsonType::number},
                                {"statistics", JsonType::object}};
  return schema;
}

const Schema& failed_schema() {
  static const Schema schema = {{"error", JsonType::text}};
  return schema;
}

/// Throws InputError for a point that lacks what sweep_table.hpp reads.
void require_point(const PointStore::Json& json, const std::string& line, const std::string& path,
                   std::size_t number) {
  require_schema(json, point_schema(), line, path, number);
  const std::string status = json["status"];
  if (status == "failed") return require_schema(json, failed_schema(), line, path, number);
  const std::string place = path + ":" + std::to_string(number);
  if (status != "done")
    throw InputError(place + ": status: found '" + status + "'; allowed: 'done', 'failed'");
  require_schema(json, done_schema(), line, path, number);
  require_point_statistics(json["statistics"], place + ": statistics");
}

void make_directory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error || !std::filesystem::is_directory(directory))
    throw InputError(directory.string() + ": output directory: found that it cannot be made (" +
                     (error ? error.message() : std::string("not a directory")) +
                     "); allowed: a directory that can be written to");
}

}  // namespace

PointStore::PointStore(const std::filesystem::path& directory, const std::string& build)
    : path_(directory / "points.jsonl"), build_(build) {
  make_directory(directory);
  descriptor_ = open(path_.c_str(), O_CREAT | O_RDWR | O_APPEND | O_NONBLOCK | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    throw InputError(path_.string() + ": output file: found that it cannot be opened (" +
                     std::strerror(errno) + "); allowed: a file that can be written to");
  try {
    lock();
    read();
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

PointStore::~PointStore() {
  close(descriptor_);
}

/// The runs of a sweep that was killed hold the file a moment longer.
void PointStore::lock() {
  constexpr int kTries = 40;
  for (int tries = 1; flock(descriptor_, LOCK_EX | LOCK_NB) != 0; ++tries) {
    if (tries == kTries)
      throw InputError(path_.string() + ": found a sweep that is writing to it; allowed: one at a time");
    usleep(50'000);
  }
}

void PointStore::read() {
  const std::string text = read_input_file(path_, kAllowed);
  const std::size_t whole = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
  std::istringstream lines(text.substr(0, whole));
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) take_line(line, ++number, build_);
  if (whole < text.size() && ftruncate(descriptor_, off_t(whole)) != 0)
    throw RunError(path_.string() + ": cannot be shortened: " + std::strerror(errno));
  if (whole == 0) append(json_text({{"format", kFormat}, {"build", build_}}));
}

void PointStore::take_line(const std::string& line, std::size_t number, const std::string& build) {
  const std::string place = path_.string() + ":" + std::to_string(number) + ": ";
  Json json = parse_json_object(line, path_.string(), kAllowed, number);
  if (number == 1) {
    require_schema(json, head_schema(), line, path_);
    const std::string format = json["format"];
    if (format != kFormat)
      throw InputError(place + "format: found '" + format + "'; allowed: '" + kFormat +
                       "', or another directory (-o)");
    if (json["build"] != build)
      throw InputError(place +
                       "build: found results of another build of csx600 or of the firmware; allowed: this "
                       "build's, or another directory (-o)");
    return;
  }
  require_point(json, line, path_, number);
  const std::string id = json["id"];
  points_[id] = std::move(json);
}

void PointStore::append(const std::string& line) {
  const off_t before = lseek(descriptor_, 0, SEEK_END);
  const std::string bytes = line + "\n";
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = write(descriptor_, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    written += std::size_t(count);
  }
  if (written == bytes.size() && fdatasync(descriptor_) == 0) return;
  const std::string reason = std::strerror(errno);
  if (ftruncate(descriptor_, before) != 0) {
    // The next start drops the piece of a line.
  }
  throw RunError(path_.string() + ": cannot be written: " + reason);
}

const PointStore::Json* PointStore::find(const std::string& id) const {
  const auto found = points_.find(id);
  return found == points_.end() ? nullptr : &found->second;
}

void PointStore::add(const std::string& id, Json result) {
  Json line = {{"id", id}};
  line.update(result);
  append(json_text(line));
  points_[id] = std::move(line);
}

std::string build_digest(const std::string& firmware_builds) {
  const std::string program = sha256(read_input_file("/proc/self/exe", "the program's own file"));
  return (firmware_builds.empty() ? program : sha256(program + firmware_builds)).substr(0, 32);
}

}  // namespace testbench
