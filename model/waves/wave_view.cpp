#include "model/waves/wave_view.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <string_view>

namespace model {
namespace {

// Bits of GTKWave's trace flags (TraceEntFlagBits in its analyzer.h).
constexpr unsigned kDecimal = 1u << 2;
constexpr unsigned kBinary = 1u << 3;
constexpr unsigned kRightJustified = 1u << 5;
constexpr unsigned kBlank = 1u << 9;
constexpr unsigned kFileFilter = 1u << 13;
constexpr unsigned kAnalogStep = 1u << 15;
constexpr unsigned kAnalogStretch = 1u << 17;
constexpr unsigned kGroupBegin = 1u << 23;
constexpr unsigned kGroupEnd = 1u << 24;

constexpr int kPlotRows = 2;  // a plotted signal is as high as this many rows

constexpr int kWindowWidth = 1500;
constexpr int kWindowHeight = 900;
constexpr int kSignalsWidth = 300;
constexpr int kWavePixels =
    kWindowWidth - kSignalsWidth - 60;  // less the frame and the closed tree of scopes

/// GTKWave's zoom: minus the binary logarithm of the time in 200 pixels.
double zoom(std::uint64_t span_picoseconds) {
  return -std::log2(double(span_picoseconds) * 200.0 / kWavePixels);
}

std::string_view outermost(std::string_view scope) {
  return scope.substr(0, scope.find('.'));
}

std::string_view group_title(std::string_view scope) {
  if (scope == "control") return "control unit";
  if (scope == "pe_array") return "PE array";
  if (scope == "pio") return "programmed I/O";
  if (scope == "ddr") return "DDR";
  if (scope == "on_chip_sram") return "on-chip SRAM";
  if (scope == "search_unit") return "search unit";
  if (scope == "clear_connect") return "ClearConnect";
  if (scope == "host_link") return "host link";
  return scope;
}

/// Computing is green, loads are yellow, saves are violet: GTKWave's colours 4, 3 and 7; 0 is its default.
/// (Its blue is hard to see on black.)
int colour(WaveTopic topic) {
  switch (topic) {
    case WaveTopic::compute:
      return 4;
    case WaveTopic::load:
      return 3;
    case WaveTopic::save:
      return 7;
    case WaveTopic::other:
      break;
  }
  return 0;
}

unsigned flags_of(WaveForm form) {
  switch (form) {
    case WaveForm::bit:
      return kRightJustified | kBinary;
    case WaveForm::plot:
      return kRightJustified | kDecimal | kAnalogStep;
    case WaveForm::number:
      break;
  }
  return kRightJustified | kDecimal;
}

/// The name that the viewer shows. It leaves out the first scope, which the group's title says.
std::string short_name(const WaveInstance& signal) {
  std::string name = signal.path.substr(signal.path.find('.') + 1);
  std::replace(name.begin(), name.end(), '.', ' ');
  return name;
}

std::string name_in_view(const std::string& chip, const WaveInstance& signal) {
  const std::string name = wave_name_in_file(chip, signal);
  return signal.info->width == 1 ? name : name + "[" + std::to_string(signal.info->width - 1) + ":0]";
}

void write_signal(std::ostream& out, const WaveInstance& signal, const ViewOptions& options) {
  const WaveSignalInfo& info = *signal.info;
  const auto filter = std::find_if(options.filter_files.begin(), options.filter_files.end(),
                                   [&](const auto& entry) { return entry.first == info.id; });
  const bool filtered = filter != options.filter_files.end();
  out << "@" << std::hex << (flags_of(info.form) | (filtered ? kFileFilter : 0u)) << std::dec << "\n";
  out << "[color] " << colour(info.topic) << "\n";
  if (filtered) out << "^" << filter - options.filter_files.begin() + 1 << " " << filter->second << "\n";
  out << "+{" << short_name(signal) << "} " << name_in_view(options.chip, signal) << "\n";
  if (info.form != WaveForm::plot) return;
  out << "@" << std::hex << kAnalogStretch << std::dec << "\n";
  for (int row = 1; row < kPlotRows; ++row) out << "-\n";
}

void write_group_line(std::ostream& out, unsigned flag, std::string_view title) {
  out << "@" << std::hex << (flag | kBlank) << std::dec << "\n-" << title << "\n";
}

void check_name(const std::string& file) {
  if (file.empty() || file.front() == '/')
    throw std::invalid_argument("wave view: found the file name '" + file +
                                "'; allowed: a name relative to the view's directory");
}

}  // namespace

void write_wave_view(std::ostream& out, const ViewOptions& options) {
  check_name(options.view_file);
  check_name(options.wave_file);
  for (const auto& filter : options.filter_files) check_name(filter.second);
  if (options.span_picoseconds == 0)
    throw std::invalid_argument("wave view: found a span of 0; allowed: 1 ps or more");

  out << "[dumpfile] \"" << options.wave_file << "\"\n[savefile] \"" << options.view_file << "\"\n";
  out << "[timestart] " << options.first_picoseconds << "\n";
  out << "[size] " << kWindowWidth << " " << kWindowHeight << "\n";
  out << "*" << zoom(options.span_picoseconds) << " -1\n";
  out << "[sst_width] 0\n[signals_width] " << kSignalsWidth << "\n[sst_expanded] 0\n";

  std::string_view group;
  for (const WaveInstance& signal : options.signals) {
    const std::string_view scope = outermost(signal.info->scope);
    if (scope != group) {
      if (!group.empty()) write_group_line(out, kGroupEnd, group_title(group));
      group = scope;
      write_group_line(out, kGroupBegin, group_title(group));
    }
    write_signal(out, signal, options);
  }
  if (!group.empty()) write_group_line(out, kGroupEnd, group_title(group));
}

void write_value_filter(std::ostream& out, const std::vector<ValueName>& names) {
  for (const ValueName& name : names) out << name.value << " " << name.name << "\n";
}

}  // namespace model
