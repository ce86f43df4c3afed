#include "model/vcd_writer.hpp"

#include <array>
#include <charconv>
#include <utility>

namespace model {
namespace {

constexpr std::size_t kBufferBytes = 64 * 1024;
constexpr std::size_t kLongestLine = 128;

constexpr char kFirstCode = '!';
constexpr std::size_t kCodes = '~' - '!' + 1;

/// Short names of printable characters.
std::string code_of(std::size_t number) {
  std::string code;
  do {
    code += static_cast<char>(kFirstCode + number % kCodes);
    number /= kCodes;
  } while (number > 0);
  return code;
}

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

void append_bits(std::string& text, std::uint64_t value) {
  std::array<char, 64> bits;
  auto first = bits.size();
  do {
    bits[--first] = static_cast<char>('0' + (value & 1));
    value >>= 1;
  } while (value > 0);
  text.append(&bits[first], bits.size() - first);
}

}  // namespace

VcdWriter::VcdWriter(TextSink sink, const std::vector<Signal>& signals) : sink_(std::move(sink)) {
  buffer_.reserve(kBufferBytes);
  for (const Signal& signal : signals) {
    codes_.push_back(code_of(codes_.size()));
    widths_.push_back(signal.width);
  }
  define(signals);
}

void VcdWriter::define(const std::vector<Signal>& signals) {
  buffer_ += "$version csx600 $end\n$timescale 1 ps $end\n";
  std::vector<std::string> open;  // scopes
  const auto leave_to = [&](std::size_t depth) {
    for (; open.size() > depth; open.pop_back()) buffer_ += "$upscope $end\n";
  };
  for (std::size_t i = 0; i < signals.size(); ++i) {
    std::vector<std::string> scopes = parts_of(signals[i].path);
    const std::string name = scopes.back();
    scopes.pop_back();
    std::size_t common = 0;
    while (common < open.size() && common < scopes.size() && open[common] == scopes[common]) ++common;
    leave_to(common);
    for (; common < scopes.size(); ++common) {
      buffer_ += "$scope module " + scopes[common] + " $end\n";
      open.push_back(scopes[common]);
    }
    const int width = signals[i].width;
    const std::string range = width == 1 ? "" : " [" + std::to_string(width - 1) + ":0]";
    buffer_ += "$var wire " + std::to_string(width) + " " + codes_[i] + " " + name + range + " $end\n";
  }
  leave_to(0);
  buffer_ += "$enddefinitions $end\n";
}

void VcdWriter::record(std::uint64_t picoseconds, const std::vector<std::uint64_t>& values) {
  time(picoseconds);
  buffer_ += std::exchange(recorded_, true) ? "$dumpon\n" : "$dumpvars\n";
  for (std::size_t i = 0; i < values.size(); ++i) change(i, values[i]);
  buffer_ += "$end\n";
}

void VcdWriter::pause(std::uint64_t picoseconds) {
  time(picoseconds);
  buffer_ += "$dumpoff\n";
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    room();
    buffer_ += (widths_[i] == 1 ? "x" : "bx ") + codes_[i] + "\n";
  }
  buffer_ += "$end\n";
}

void VcdWriter::time(std::uint64_t picoseconds) {
  room();
  std::array<char, 24> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), picoseconds).ptr;
  buffer_ += '#';
  buffer_.append(digits.data(), end);
  buffer_ += '\n';
}

void VcdWriter::change(std::size_t signal, std::uint64_t value) {
  room();
  if (widths_[signal] == 1) {
    buffer_ += static_cast<char>('0' + value);
  } else {
    buffer_ += 'b';
    append_bits(buffer_, value);
    buffer_ += ' ';
  }
  buffer_ += codes_[signal];
  buffer_ += '\n';
}

void VcdWriter::room() {
  if (buffer_.size() + kLongestLine > kBufferBytes) flush();
}

void VcdWriter::flush() {
  sink_(buffer_);
  buffer_.clear();
}

}  // namespace model
