#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace test_support {

/// Reads a value change dump as a viewer does. Throws std::runtime_error for any other file.
class VcdReader {
 public:
  struct Change {
    std::uint64_t time;
    std::uint64_t value;
  };
  struct Signal {
    int width = 0;
    std::vector<Change> changes;  ///< the first is the initial value
  };

  /// The value of a signal while recording pauses.
  static constexpr std::uint64_t kUnknown = ~std::uint64_t{0};

  explicit VcdReader(std::istream& in) {
    read_definitions(in);
    read_changes(in);
  }
  static VcdReader of_file(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error("cannot read " + file);
    return VcdReader(in);
  }

  const std::string& timescale() const { return timescale_; }
  std::uint64_t first_time() const { return first_time_; }
  std::uint64_t last_time() const { return last_time_; }
  /// The signal with a dotted name that begins with the outermost scope.
  const std::map<std::string, Signal>& signals() const { return signals_; }
  const Signal& signal(const std::string& path) const {
    const auto found = signals_.find(path);
    return found != signals_.end() ? found->second : signals_.at("csx600." + path);
  }

  std::uint64_t value_at(const std::string& path, std::uint64_t time) const {
    const std::vector<Change>& changes = signal(path).changes;
    std::uint64_t value = changes.front().value;
    for (const Change& change : changes)
      if (change.time <= time) value = change.value;
    return value;
  }
  /// Total time for which the signal has the value, between the first and the last time of the file.
  std::uint64_t time_at_value(const std::string& path, std::uint64_t value) const {
    const std::vector<Change>& changes = signal(path).changes;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const std::uint64_t end = i + 1 < changes.size() ? changes[i + 1].time : last_time_;
      if (changes[i].value == value) sum += end - changes[i].time;
    }
    return sum;
  }

 private:
  void read_definitions(std::istream& in) {
    std::vector<std::string> scopes;
    for (std::string word; in >> word && word != "$enddefinitions";) {
      if (word == "$timescale") {
        for (std::string part; in >> part && part != "$end";)
          timescale_ += (timescale_.empty() ? "" : " ") + part;
      } else if (word == "$scope") {
        std::string kind, name;
        in >> kind >> name;
        scopes.push_back(name);
      } else if (word == "$upscope") {
        scopes.pop_back();
      } else if (word == "$var") {
        read_variable(in, scopes);
      }
    }
    if (!in || signals_.empty()) throw std::runtime_error("no definitions");
  }

  void read_variable(std::istream& in, const std::vector<std::string>& scopes) {
    std::string kind, code, name;
    int width = 0;
    in >> kind >> width >> code >> name;
    std::string path;
    for (const std::string& scope : scopes) path += scope + ".";
    Signal& signal = signals_[path + name];
    if (signal.width != 0) throw std::runtime_error("defined twice: " + path + name);
    signal.width = width;
    by_code_[code] = &signal;
  }

  void read_changes(std::istream& in) {
    bool timed = false;
    for (std::string word; in >> word;) {
      if (word == "$comment") {
        while (in >> word && word != "$end") {
        }
      } else if (word[0] == '#') {
        const std::uint64_t time = std::stoull(word.substr(1));
        if (timed && time < last_time_) throw std::runtime_error("time goes back at " + word);
        if (!timed) first_time_ = time;
        timed = true;
        last_time_ = time;
      } else if (word[0] == 'b') {
        std::string code;
        in >> code;
        add(code, word.substr(1));
      } else if (word[0] == '0' || word[0] == '1' || word[0] == 'x') {
        add(word.substr(1), word.substr(0, 1));
      } else if (word[0] != '$') {
        throw std::runtime_error("unknown: " + word);
      }
    }
    if (!timed) throw std::runtime_error("no time stamp");
  }

  void add(const std::string& code, const std::string& bits) {
    if (bits.find_first_not_of('x') == std::string::npos) {
      by_code_.at(code)->changes.push_back({last_time_, kUnknown});
      return;
    }
    std::size_t used = 0;
    const std::uint64_t value = std::stoull(bits, &used, 2);
    if (used != bits.size()) throw std::runtime_error("not a number: " + bits);
    by_code_.at(code)->changes.push_back({last_time_, value});
  }

  std::string timescale_;
  std::map<std::string, Signal> signals_;
  std::map<std::string, Signal*> by_code_;
  std::uint64_t first_time_ = 0;
  std::uint64_t last_time_ = 0;
};

}  // namespace test_support
