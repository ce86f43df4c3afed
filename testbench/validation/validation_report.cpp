#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "testbench/files/csv.hpp"
#include "testbench/validation/validation.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAimPercent = 15;

template <class... Arguments>
std::string formatted(const char* format, const Arguments&... arguments) {
  char line[256];
  std::snprintf(line, sizeof(line), format, arguments...);
  return line;
}

bool is_off(const Figure& figure) {
  return std::abs(figure.error_percent()) > kAimPercent;
}

std::string published_text(const Figure& figure) {
  if (figure.kind == Published::at_least) return formatted(">= %.3g", figure.published_low);
  if (figure.kind == Published::at_most) return formatted("< %.3g", figure.published_high);
  if (figure.published_low == figure.published_high) return formatted("%.3g", figure.published_low);
  return formatted("%.3g to %.3g", figure.published_low, figure.published_high);
}

const char* kind_name(Published kind) {
  constexpr const char* kNames[] = {"value", "at least", "at most"};
  return kNames[std::size_t(kind)];
}

std::string figures_text(const std::vector<Figure>& figures) {
  std::string text = formatted("  %-38s %8s  %-12s %8s  %-16s %-14s %s\n", "what", "model", "published",
                               "error", "unit", "chip", "source");
  for (const Figure& figure : figures)
    text += formatted("  %-38s %8.3g  %-12s %+7.1f%%%c %-16s %-14s ", figure.what.c_str(), figure.model,
                      published_text(figure).c_str(), figure.error_percent(), is_off(figure) ? '!' : ' ',
                      figure.unit.c_str(), figure.chip.c_str()) +
            figure.source + '\n';
  for (const Figure& figure : figures)
    if (is_off(figure) && !figure.note.empty()) text += "  ! " + figure.what + ": " + figure.note + '\n';
  return text;
}

std::string shares_text(const std::vector<CycleShares>& all) {
  std::string text;
  for (const CycleShares& shares : all) {
    text += formatted("  %-14s %-14s", shares.run.c_str(), shares.chip.c_str());
    for (const auto& [cause, percent] : shares.percent)
      if (percent >= 0.1) text += formatted("  %s %.1f %%", cause.c_str(), percent);
    text += '\n';
  }
  return text;
}

std::string transfers_text(const std::vector<TransferPoint>& transfers) {
  std::string text =
      formatted("  %4s %10s  %-18s %8s %8s\n", "PEs", "bytes/PE", "offset in packet", "load", "save");
  for (const TransferPoint& point : transfers)
    text +=
        formatted("  %4d %10d  %-18d %8.3f %8.3f\n", point.pes, point.bytes_per_pe, point.packet_offset_bytes,
                  point.load_bytes_per_second * 1e-9, point.save_bytes_per_second * 1e-9);
  return text;
}

}  // namespace

std::string validation_text(const Validation& validation) {
  return "Figures of the CSX600 known from elsewhere; nothing was fitted to them (! off by more than 15 "
         "%)\n" +
         figures_text(validation.figures) + "\nWhere the cycles went\n" + shares_text(validation.shares) +
         "\nProgrammed I/O by itself, GB/s (chip csx600; pieces lie apart; the port's peak is 3.2)\n" +
         transfers_text(validation.transfers);
}

std::string validation_csv(const Validation& validation) {
  std::string text =
      "what,unit,chip,model,published_low,published_high,published_kind,error_percent,source\n";
  for (const Figure& figure : validation.figures)
    text += csv_quoted(figure.what) + ',' + csv_quoted(figure.unit) + ',' + figure.chip + ',' +
            formatted("%.9g,%.9g,%.9g,", figure.model, figure.published_low, figure.published_high) +
            kind_name(figure.kind) + ',' + formatted("%.3f,", figure.error_percent()) +
            csv_quoted(figure.source) + '\n';
  return text;
}

Json to_json(const Validation& validation) {
  Json json;
  json["format"] = "csx600-validate-1";
  json["figures"] = Json::array();
  for (const Figure& figure : validation.figures)
    json["figures"].push_back({{"what", figure.what},
                               {"unit", figure.unit},
                               {"chip_preset", figure.chip},
                               {"model", figure.model},
                               {"published_low", figure.published_low},
                               {"published_high", figure.published_high},
                               {"published_kind", kind_name(figure.kind)},
                               {"error_percent", figure.error_percent()},
                               {"source", figure.source},
                               {"note", figure.note}});
  json["runs"] = Json::array();
  for (const CycleShares& shares : validation.shares) {
    Json percent = Json::object();
    for (const auto& [cause, of_cause] : shares.percent) percent[cause] = of_cause;
    json["runs"].push_back(
        {{"run", shares.run}, {"chip_preset", shares.chip}, {"percent_of_cycles", percent}});
  }
  json["transfers"] = Json::array();
  for (const TransferPoint& point : validation.transfers)
    json["transfers"].push_back({{"pes", point.pes},
                                 {"bytes_per_pe", point.bytes_per_pe},
                                 {"packet_offset_bytes", point.packet_offset_bytes},
                                 {"load_bytes_per_second", point.load_bytes_per_second},
                                 {"save_bytes_per_second", point.save_bytes_per_second}});
  return json;
}

}  // namespace testbench
