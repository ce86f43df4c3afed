#include "model/waves/vcd_writer.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <utility>

namespace model {
namespace {

constexpr std::size_t kBufferBytes = 64 * 1024;
constexpr std::size_t kLongestLine = 128;

constexpr char kFirstCode = '!';
constexpr std::size_t kCodes = '~' - '!' + 1;

std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char letter : path) {
    if (letter == '.') {
      parts.emplace_back();
    } else {
      parts.back() += letter;
    }
  }
  return parts;
}

char* put_bits(char* out, std::uint64_t value) {
  for (int bit = 63 - __builtin_clzll(value | 1); bit >= 0; --bit)
    *out++ = static_cast<char>('0' + ((value >> bit) & 1));
  return out;
}

}  // namespace

VcdWriter::VcdWriter(TextSink sink, const std::vector<Signal>& signals)
    : sink_(std::move(sink)), buffer_(kBufferBytes) {
  for (const Signal& signal : signals) {
    Code code;  // a short name of printable characters
    code.width = signal.width;
    std::size_t number = codes_.size();
    do {
      code.text[code.length++] = static_cast<char>(kFirstCode + number % kCodes);
      number /= kCodes;
    } while (number > 0);
    codes_.push_back(code);
  }
  define(signals);
}

void VcdWriter::define(const std::vector<Signal>& signals) {
  std::string text = "$version csx600 $end\n$timescale 1 ps $end\n";
  std::vector<std::string> open;  // scopes that are not closed yet
  const auto leave_to = [&](std::size_t depth) {
    for (; open.size() > depth; open.pop_back()) text += "$upscope $end\n";
  };
  for (std::size_t i = 0; i < signals.size(); ++i) {
    std::vector<std::string> scopes = parts_of(signals[i].path);
    const std::string name = scopes.back();
    scopes.pop_back();
    std::size_t common = 0;
    while (common < open.size() && common < scopes.size() && open[common] == scopes[common]) ++common;
    leave_to(common);
    for (; common < scopes.size(); ++common) {
      text += "$scope module " + scopes[common] + " $end\n";
      open.push_back(scopes[common]);
    }
    const int width = signals[i].width;
    const std::string range = width == 1 ? "" : " [" + std::to_string(width - 1) + ":0]";
    text.append("$var wire ").append(std::to_string(width)).append(" ");
    text.append(codes_[i].text.data(), codes_[i].length).append(" ");
    text.append(name).append(range).append(" $end\n");
  }
  leave_to(0);
  text += "$enddefinitions $end\n";
  put(text);
}

void VcdWriter::record(std::uint64_t picoseconds, const std::vector<std::uint64_t>& values) {
  time(picoseconds);
  put(std::exchange(recorded_, true) ? "$dumpon\n" : "$dumpvars\n");
  for (std::size_t i = 0; i < values.size(); ++i) change(i, values[i]);
  put("$end\n");
}

void VcdWriter::pause(std::uint64_t picoseconds) {
  time(picoseconds);
  put("$dumpoff\n");
  for (const Code& code : codes_)
    put((code.width == 1 ? "x" : "bx ") + std::string(code.text.data(), code.length) + "\n");
  put("$end\n");
}

void VcdWriter::time(std::uint64_t picoseconds) {
  char* out = begin_line();
  *out++ = '#';
  out = std::to_chars(out, buffer_.data() + kBufferBytes, picoseconds).ptr;
  *out++ = '\n';
  end_line(out);
}

void VcdWriter::change(std::size_t signal, std::uint64_t value) {
  const Code& code = codes_[signal];
  char* out = begin_line();
  if (code.width == 1) {
    *out++ = static_cast<char>('0' + value);
  } else {
    *out++ = 'b';
    out = put_bits(out, value);
    *out++ = ' ';
  }
  std::memcpy(out, code.text.data(), code.text.size());
  out += code.length;
  *out++ = '\n';
  end_line(out);
}

char* VcdWriter::begin_line() {
  if (size_ + kLongestLine > kBufferBytes) flush();
  return buffer_.data() + size_;
}

void VcdWriter::put(std::string_view text) {
  while (!text.empty()) {
    const std::string_view piece = text.substr(0, kLongestLine);
    end_line(std::copy(piece.begin(), piece.end(), begin_line()));
    text.remove_prefix(piece.size());
  }
}

void VcdWriter::flush() {
  sink_({buffer_.data(), size_});
  size_ = 0;
}

}  // namespace model
