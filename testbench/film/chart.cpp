#include "testbench/film/chart.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>

#include "testbench/files/atomic_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/message_text.hpp"

namespace testbench {
namespace {

/// A text in gnuplot's single quotes, between which only the quote itself is special.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

std::string plot_of(const LogChart& chart) {
  std::ostringstream script;
  script.precision(17);
  script << "set title " << quoted(printable(chart.title)) << " noenhanced\nset xlabel "
         << quoted(chart.x_label) << " noenhanced\nset ylabel " << quoted(chart.y_label)
         << " noenhanced\nset logscale xy\nset grid\nset key outside right top noenhanced\n";
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const ChartSeries& series = chart.series[i];
    script << "$series" << i << " << EOD\n";
    for (std::size_t k = 0; k < series.x.size(); ++k)
      if (series.x[k] > 0 && series.y[k] > 0) script << series.x[k] << " " << series.y[k] << "\n";
    script << "EOD\n";
  }
  for (std::size_t i = 0; i < chart.series.size(); ++i)
    script << (i == 0 ? "plot " : ", ") << "$series" << i << " with linespoints linewidth 2 title "
           << quoted(chart.series[i].label);
  script << "\n";
  return script.str();
}

/// A text in gnuplot's double quotes, between which "\n" begins a line.
std::string quoted_lines(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return result + "\"";
}

std::string plot_of(const BarChart& chart) {
  std::ostringstream script;
  script.precision(17);
  script << "set title " << quoted(printable(chart.title)) << " noenhanced\nset ylabel "
         << quoted(chart.y_label)
         << " noenhanced\nset yrange [0:]\nset offsets 0.5,0.5,0,0\nset grid ytics\nunset key\n"
            "set bmargin 4\nset format y '%.0f'\nset boxwidth 0.6\nset style fill solid 0.6\nset xtics "
            "noenhanced\n$bars << EOD\n";
  for (std::size_t i = 0; i < chart.bars.size(); ++i)
    script << i << " " << chart.bars[i].value << " " << quoted_lines(chart.bars[i].label) << "\n";
  script << "EOD\nplot $bars using 1:2:xticlabels(3) with boxes, "
            "'' using 1:2:(sprintf('%.0f', $2)) with labels offset 0,0.7 noenhanced\n";
  return script.str();
}

/// Whether the file ends as its format does. gnuplot ignores failed writes, so a full disk leaves a file that
/// is cut short.
bool is_whole(const std::filesystem::path& path, bool is_svg) {
  // The last chunk of a PNG is empty: its type and checksum (ISO/IEC 15948, "IEND").
  const std::string_view end = is_svg ? std::string_view("</svg>") : std::string_view("IEND\xae\x42\x60\x82");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  std::string text = bytes.str();
  if (is_svg) text.erase(text.find_last_not_of(" \r\n") + 1);
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// @param plot what gnuplot draws
void draw(const std::filesystem::path& path, const std::string& plot) {
  const bool is_svg = path.extension() == ".svg";
  const std::string terminal = is_svg ? "svg size 960,640 background 'white'" : "pngcairo size 960,640";
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::FILE* const gnuplot = popen("gnuplot", "w");
    if (gnuplot == nullptr) throw RunError(path.string() + ": cannot start gnuplot");
    const std::string script =
        "set terminal " + terminal + "\nset output " + quoted(temporary.string()) + "\n" + plot;
    std::fputs(script.c_str(), gnuplot);
    if (pclose(gnuplot) != 0) throw RunError(path.string() + ": gnuplot failed");
    if (!is_whole(temporary, is_svg))
      throw RunError(path.string() + ": cannot be written: the file is cut short; is the disk full?");
  });
}

}  // namespace

bool can_draw_charts() {
  const char* const path = std::getenv("PATH");
  std::istringstream directories(path ? path : "");
  for (std::string directory; std::getline(directories, directory, ':');)
    if (access((directory + "/gnuplot").c_str(), X_OK) == 0) return true;
  return false;
}

void write_chart(const std::filesystem::path& path, const LogChart& chart) {
  draw(path, plot_of(chart));
}
void write_chart(const std::filesystem::path& path, const BarChart& chart) {
  draw(path, plot_of(chart));
}

}  // namespace testbench
