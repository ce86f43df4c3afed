#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace model {

/// Takes a text piece by piece. Must not throw: a sink that cannot go on keeps its error for its owner.
using TextSink = std::function<void(std::string_view)>;

/// A value change dump (IEEE 1364, section 18) as a stream, time unit 1 ps. SystemC's own writer compares
/// every signal at every time step and cannot pause, tell a full disk or write a time before initial values;
/// here only changes cost time (a run of 0.10 s took 0.42 s with it).
///
/// The same calls give the same bytes: the file has no date.
class VcdWriter {
 public:
  struct Signal {
    std::string path;  ///< scopes and name, separated by dots
    int width;         ///< bits, at most 64
  };

  /// Writes the definitions. Signals of a scope follow each other.
  VcdWriter(TextSink sink, const std::vector<Signal>& signals);

  /// Recording begins, or goes on after pause(); `values` of all signals.
  void record(std::uint64_t picoseconds, const std::vector<std::uint64_t>& values);
  void time(std::uint64_t picoseconds);
  void change(std::size_t signal, std::uint64_t value);
  /// All values are unknown from here on.
  void pause(std::uint64_t picoseconds);
  /// Hands over what is still in the buffer.
  void flush();

 private:
  struct Code {
    std::array<char, 4> text{};
    std::size_t length = 0;
    int width = 0;
  };

  void define(const std::vector<Signal>& signals);
  void put(std::string_view text);
  /// Returns where the next line is to be written; end_line() takes it into the buffer.
  char* begin_line();
  void end_line(const char* end) { size_ = std::size_t(end - buffer_.data()); }

  TextSink sink_;
  std::vector<char> buffer_;
  std::size_t size_ = 0;
  std::vector<Code> codes_;
  bool recorded_ = false;
};

}  // namespace model
