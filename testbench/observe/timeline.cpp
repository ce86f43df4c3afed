#include "testbench/observe/timeline.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPicosecondsPerMicrosecond = 1e6;
constexpr int kProcess = 1;  // the format's process ID; stands for the chip

/// Microseconds as the format wants them. Viewers take the whole nanoseconds of us * 1000.0; a product that
/// is rounded below a whole number would let an event begin before its forerunner ends, so the number is then
/// written as the next larger double.
double microseconds(std::uint64_t picoseconds) {
  const double number = double(picoseconds) / kPicosecondsPerMicrosecond;
  const auto read = static_cast<std::uint64_t>(number * 1000.0);
  return read < picoseconds / 1000 ? std::nextafter(number, std::numeric_limits<double>::infinity()) : number;
}

void add_label(Json& arguments, const cn::Label& label) {
  if (label.stage == nullptr) return;
  arguments["stage"] = label.stage;
  arguments["block"] = label.block;
}

std::string text_of(const cn::Label& label) {
  return std::string(label.stage) + " " + std::to_string(label.block);
}

bool is_wait(model::CycleCause cause) {
  using model::CycleCause;
  return cause == CycleCause::wait_load || cause == CycleCause::wait_save ||
         cause == CycleCause::wait_pio_queue || cause == CycleCause::wait_host ||
         cause == CycleCause::data_cache;
}

}  // namespace

Timeline::Timeline(const std::filesystem::path& file, const model::Csx600& chip, int array)
    : chip_(chip), control_unit_(chip.array(array).control_unit), file_(file) {
  buffer_ = R"({"displayTimeUnit":"ns","otherData":)" +
            Json{{"chip", chip.config().preset}, {"clock_hz", chip.config().chip.clock_hz}}.dump() +
            ",\"traceEvents\":[\n";
  name_tracks();
}

void Timeline::name_tracks() {
  write({{"name", "process_name"}, {"ph", "M"}, {"pid", kProcess}, {"args", {{"name", "csx600"}}}});
  const std::pair<Track, const char*> tracks[] = {{Track::kernels, "kernels"},
                                                  {Track::waits, "control unit waits"},
                                                  {Track::loads, "PIO loads (mono to poly)"},
                                                  {Track::saves, "PIO saves (poly to mono)"},
                                                  {Track::host, "host transfers"}};
  for (const auto& [track, name] : tracks) {
    const Json place = {{"ph", "M"}, {"pid", kProcess}, {"tid", int(track)}};
    Json named = place;
    named["name"] = "thread_name";
    named["args"] = {{"name", name}};
    write(named);
    Json sorted = place;
    sorted["name"] = "thread_sort_index";
    sorted["args"] = {{"sort_index", int(track)}};
    write(sorted);
  }
}

void Timeline::spent(model::CycleCause cause, model::Cycles start, model::Cycles finish, int semaphore) {
  if (!is_wait(cause)) return;
  Json arguments;
  if (semaphore >= 0) arguments["semaphore"] = control_unit_.semaphore_name({semaphore});
  add(Track::waits, model::cycle_cause_name(cause), "wait", start, finish, std::move(arguments));
}

void Timeline::ran_kernel(const char* name, model::Cycles start, model::Cycles finish, int enabled_pes) {
  Json arguments = {{"pes", enabled_pes}};
  add_label(arguments, label_);
  add(Track::kernels, name, "kernel", start, finish, std::move(arguments));
}

void Timeline::finished(const model::PioEvent& event) {
  const bool load = event.direction == cn::Direction::mono_to_poly;
  Json arguments = {{"request", event.id}, {"bytes", event.bytes}, {"pes", event.pes}};
  arguments["enqueued_cycle"] = event.enqueued;
  add_label(arguments, event.label);
  const std::string name = event.label.stage != nullptr ? text_of(event.label) : load ? "load" : "save";
  add(load ? Track::loads : Track::saves, name, load ? "load" : "save", event.started, event.finished,
      std::move(arguments));
}

void Timeline::ended_transfer(bool upload, std::uint64_t bytes, model::Cycles start, model::Cycles finish) {
  add(Track::host, upload ? "upload" : "download", "host", start, finish, {{"bytes", bytes}});
}

void Timeline::add(Track track, const std::string& name, const char* category, model::Cycles start,
                   model::Cycles finish, Json arguments) {
  const auto first = chip_.clock.time_at(start).value();
  const auto last = chip_.clock.time_at(finish).value();
  arguments["start_cycle"] = start;
  arguments["cycles"] = finish - start;
  write({{"name", name},
         {"cat", category},
         {"ph", "X"},
         {"pid", kProcess},
         {"tid", int(track)},
         {"ts", microseconds(first)},
         {"dur", microseconds(last - first)},
         {"args", std::move(arguments)}});
}

void Timeline::write(const Json& event) {
  if (!std::exchange(first_, false)) buffer_ += ",\n";
  buffer_ += event.dump();
  if (buffer_.size() < kWriteBufferBytes) return;
  file_.write(buffer_);
  buffer_.clear();
}

void Timeline::finish() {
  buffer_ += "\n]}\n";
  file_.write(buffer_);
  file_.finish();
}

}  // namespace testbench
