#include "testbench/faults/fault_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "model/faults/fault.hpp"

namespace testbench {
namespace {

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

double share(const FaultRow& row) {
  return row.runs > 0 ? double(row.vulnerable()) / row.runs : 0.0;
}

std::string left_aligned(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

std::string right_aligned(const std::string& text, std::size_t width) {
  return std::string(width - std::min(width, text.size()), ' ') + text;
}

}  // namespace

std::pair<double, double> wilson_interval(int hits, int runs) {
  if (runs == 0) return {0, 1};
  constexpr double kZ = 1.959963984540054;  // 97.5 % of a normal distribution lie below
  const double n = runs;
  const double p = hits / n;
  const double centre = p + kZ * kZ / (2 * n);
  const double half = kZ * std::sqrt(p * (1 - p) / n + kZ * kZ / (4 * n * n));
  const double scale = 1 + kZ * kZ / n;
  return {std::max(0.0, (centre - half) / scale), std::min(1.0, (centre + half) / scale)};
}

int FaultRow::vulnerable() const {
  int sum = 0;
  for (std::size_t i = 0; i < by_outcome.size(); ++i)
    if (kFaultOutcomes[i].is_vulnerable) sum += by_outcome[i];
  return sum;
}

std::vector<FaultRow> fault_rows(const FaultStore& store) {
  std::vector<FaultRow> rows;
  for (const model::FaultKindInfo& kind : model::kFaultKinds) {
    FaultRow row;
    row.kind = kind.name;
    for (const auto& [run, json] : store.runs()) {
      if (json["kind"] != kind.name) continue;
      ++row.runs;
      for (std::size_t i = 0; i < kFaultOutcomes.size(); ++i)
        row.by_outcome[i] += json["outcome"] == kFaultOutcomes[i].name;
    }
    if (row.runs > 0) rows.push_back(std::move(row));
  }
  return rows;
}

std::string fault_table(const std::vector<FaultRow>& rows) {
  constexpr std::size_t kKindWidth = 14;
  std::string text = left_aligned("fault", kKindWidth) + "  runs";
  for (const FaultOutcomeInfo& outcome : kFaultOutcomes) text += std::string("  ") + outcome.name;
  text += "  not masked  95 %\n";
  for (const FaultRow& row : rows) {
    text += left_aligned(row.kind, kKindWidth) + right_aligned(std::to_string(row.runs), 6);
    for (std::size_t i = 0; i < kFaultOutcomes.size(); ++i)
      text +=
          right_aligned(std::to_string(row.by_outcome[i]), std::string(kFaultOutcomes[i].name).size() + 2);
    const auto [low, high] = wilson_interval(row.vulnerable(), row.runs);
    text += right_aligned(number("%.1f %%", 100 * share(row)), 12) + number("  %.1f", 100 * low) +
            number(" to %.1f %%", 100 * high) + "\n";
  }
  return text;
}

std::string fault_csv(const std::vector<FaultRow>& rows) {
  std::string text = "kind,runs";
  for (const FaultOutcomeInfo& outcome : kFaultOutcomes) text += std::string(",") + outcome.name;
  text += ",vulnerability,low,high\n";
  for (const FaultRow& row : rows) {
    const auto [low, high] = wilson_interval(row.vulnerable(), row.runs);
    text += row.kind + "," + std::to_string(row.runs);
    for (const int count : row.by_outcome) text += "," + std::to_string(count);
    text +=
        "," + number("%.17g", share(row)) + "," + number("%.17g", low) + "," + number("%.17g", high) + "\n";
  }
  return text;
}

}  // namespace testbench
