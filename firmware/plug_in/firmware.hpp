#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/cn/machine.hpp"
#include "firmware/plug_in/counter.hpp"
#include "firmware/plug_in/mono_buffer.hpp"
#include "firmware/plug_in/option.hpp"

namespace plug_in {

/// Thrown by prepare() for options that do not fit each other; one line that names option, value and what is
/// allowed.
class OptionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Thrown by check() for a wrong result; one line with what was found and what is right.
class CheckFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a run does, for rates: 4096 "transforms".
struct Work {
  double amount = 0;
  std::string unit = {};
};

/// A firmware that `csx600 run` loads. Its options, buffers and counters are members that list themselves
/// here. The program gives options their values and calls prepare(); places the buffers in mono memory and
/// uploads; calls run() on the chip; downloads; calls check().
class Firmware {
 public:
  Firmware(std::string name, std::string meaning) : name_(std::move(name)), meaning_(std::move(meaning)) {}
  virtual ~Firmware() = default;
  Firmware(const Firmware&) = delete;
  Firmware& operator=(const Firmware&) = delete;

  /// Gives buffers their sizes, and those to upload their contents. Throws OptionError.
  virtual void prepare(int num_pes) = 0;
  /// The firmware's body, on the chip. Throws cn::MachineFault, cn::PolyMemoryOverflow.
  virtual void run(cn::Machine& machine) = 0;
  /// Looks at the buffers downloaded. Throws CheckFailed.
  virtual void check() const = 0;
  virtual Work work() const { return {}; }

  const std::string& name() const { return name_; }
  const std::string& meaning() const { return meaning_; }
  const std::vector<OptionBase*>& options() const { return options_; }
  const std::vector<MonoBufferBase*>& buffers() const { return buffers_; }
  const std::vector<const Counter*>& counters() const { return counters_; }
  void add(OptionBase& option) { options_.push_back(&option); }
  void add(MonoBufferBase& buffer) { buffers_.push_back(&buffer); }
  void add(const Counter& counter) { counters_.push_back(&counter); }

 private:
  std::string name_;
  std::string meaning_;
  std::vector<OptionBase*> options_;
  std::vector<MonoBufferBase*> buffers_;
  std::vector<const Counter*> counters_;
};

/// The author of a firmware defines this function. csx600_add_firmware() compiles it, and all that it calls,
/// once for each x86-64 level.
std::unique_ptr<Firmware> make_firmware();

}  // namespace plug_in
